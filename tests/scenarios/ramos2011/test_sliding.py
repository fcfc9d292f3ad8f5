"""Feet that really slide on MuJoCo's floor, lightly loaded, while the other one carries."""

import pytest

from scenarios import stacks
from scenarios.inputs import clips
from scenarios.ramos2011 import sliding
from sim.loop import run
from sim.reporting import figures
from sim.reporting.slides import slide_figures
from sim.world import World
from solvers import Cascade
from sot.control.controller import Controller
from sot.motion import plan, read, recognise
from sot.motion.feet.slides import SLIDE_FORWARD, SLIDE_SPEED, slide_duration
from sot.robots.robot import Robot, shipped_robot_names


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name == "hrp2")) for name in shipped_robot_names()]
)
def test_each_foot_slides_ahead_in_its_turn(name):
    robot = Robot.load(name)
    motion = sliding.motion(robot, 100.0)
    assert [phase.sliding for phase in motion.phases] == [(), ("right_foot",), (), ("left_foot",), ()]
    for phase in motion.phases[1::2]:
        foot = motion.track(phase.sliding[0])
        rows = slice(round(100.0 * phase.start), round(100.0 * phase.end))
        way = foot.position[rows][-1] - foot.position[rows][0]
        assert way == pytest.approx([sliding.SLIDE_WAY[0], 0.0, 0.0], abs=2e-3)
        assert abs(foot.position[rows, 2]).max() < 1e-3
        (standing,) = phase.feet
        assert abs(motion.track(standing).velocity[rows]).max() < 5e-3
    assert slide_duration(sliding.SLIDE_WAY, robot) > sliding.SLIDE_WAY[0] / SLIDE_SPEED


@pytest.mark.slow
@pytest.mark.parametrize("rate", [200.0, 1000.0])
def test_slides_lightly_loaded_where_it_should(rate, monkeypatch):
    monkeypatch.setattr(sliding, "FEET_IN_ORDER", sliding.FEET_IN_ORDER[:1])
    robot = Robot.load("hrp2")
    motion = sliding.motion(robot, rate)
    stack, schedule = sliding.stack(robot, motion), sliding.schedule(robot, motion)
    done = run(Controller(robot, stack, Cascade(), 1.0 / rate, schedule), World(robot, 1.0 / rate), motion)
    assert done.fell_at_s is None, done.reason
    log = done.log.trimmed()
    assert figures.solver(log)["infeasible_ticks"] == 0
    assert figures.contacts(log, motion)["slip_max_m"] < 0.002
    (slide,) = slide_figures(log, motion)
    assert slide["foot"] == sliding.FEET_IN_ORDER[0]
    assert slide["moved_m"] > 0.08
    assert slide["contact"] > 0.9
    # At 200 Hz the log has one physics step in five, too few for a mean over 50 ms.
    assert 0.02 < slide["load_min"] < slide["load_max"] < (0.15 if rate == 1000.0 else 0.2)
    assert slide["zmp_inside"] > 0.999 and slide["zmp_min_margin_m"] > 0.02


@pytest.mark.slow
def test_a_dance_slides_where_its_dancer_stands_on_one_foot_most():
    robot = Robot.load("hrp2")
    motion = plan(recognise(read(clips.find_clip("groove"))), robot, rate=500.0, slide=SLIDE_FORWARD).motion
    stack, schedule = stacks.sliding_stack(robot, motion), stacks.sliding_schedule(robot, motion)
    done = run(Controller(robot, stack, Cascade(), 0.002, schedule), World(robot, 0.002), motion)
    assert done.fell_at_s is None, done.reason
    log = done.log.trimmed()
    assert figures.solver(log)["infeasible_ticks"] == 0
    (slide,) = slide_figures(log, motion)
    assert slide["moved_m"] > 0.08
    assert slide["contact"] > 0.9
    assert 0.02 < slide["load_min"] < slide["load_max"] < 0.15
    assert slide["zmp_inside"] > 0.995 and slide["zmp_min_margin_m"] > 0.0
