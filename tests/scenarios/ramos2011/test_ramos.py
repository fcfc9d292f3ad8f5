"""Ramos 2011, VI: which part is danced, what is edited and measured, and the whole study on the shipped clip."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

from scenarios import cli
from scenarios.inputs.clips import find_clip
from scenarios.ramos2011 import ramos
from scenarios.ramos2011.ramos_edits import merged_spans, oscillating_part, oscillation_amplitude, spans_without_slides
from scenarios.ramos2011.ramos_figures import geometric_figures, required_torque
from scenarios.ramos2011.ramos_pictures import PAPER_HZ, PAPER_SPANS, swinging_knee
from scenarios.replay import Replay
from scenarios.studies import run_scenario
from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.motion import read, recognise
from sot.motion.human.oscillation import Oscillation, find_oscillations
from sot.robots.robot import Robot
from tests.sim.runs import still_motion


def test_a_short_clip_is_danced_whole_and_what_is_asked_for_is_danced():
    human = recognise(read(find_clip("groove")))
    assert ramos.clip_part(human, 0.0, None) == (0.0, human.duration)
    assert ramos.clip_part(human, 2.0, None) == (2.0, human.duration - 2.0)
    assert ramos.clip_part(human, 0.0, 5.0) == (0.0, 5.0)


def test_of_a_long_clip_the_part_is_danced_in_which_the_knees_swing_most():
    human = recognise(read(find_clip("groove"))).slice(0.0, 1.0)
    count = round(90.0 * human.rate)
    times = np.arange(count) / human.rate
    swings = np.where((times > 55.0) & (times < 65.0), 0.3 * np.sin(2.0 * np.pi * 2.0 * times), 0.0)
    points = {name: np.tile(place[:1], (count, 1, 1))[:, 0] for name, place in human.points.items()}
    hip, knee = points["right_hip"], points["right_knee"]
    shank = np.column_stack([-np.sin(swings), np.zeros(count), -np.cos(swings)]) * 0.4
    points["right_ankle"] = knee + shank
    points["right_hip"] = np.column_stack([knee[:, :2], hip[:, 2]])
    frames = {name: np.tile(frame[:1], (count, 1, 1)) for name, frame in human.frames.items()}
    long = replace(human, points=points, frames=frames)
    start, duration = ramos.clip_part(long, 0.0, None)
    assert duration == ramos.MAX_DURATION
    assert start <= 55.0 and start + duration >= 65.0


def test_the_amplitude_is_that_of_the_swing_whatever_else_moves():
    times = np.arange(0.0, 20.0, 0.01)
    inside = (times > 5.0) & (times < 15.0)
    angle = 0.5 * np.sin(2.0 * np.pi * 0.2 * times) + np.where(inside, 0.1 * np.sin(2.0 * np.pi * 2.0 * times), 0.0)
    assert oscillation_amplitude(times, angle, Oscillation(6.0, 14.0, 2.0, 0.1, 0.0)) == pytest.approx(0.1, rel=0.03)
    assert np.abs(oscillating_part(angle, 100.0, 2.0)[(times > 17.0) & (times < 19.0)]).max() < 0.01


def test_spans_are_widened_and_those_that_are_near_are_one():
    planned = SimpleNamespace(motion=SimpleNamespace(duration=6.1))
    assert merged_spans([(5.0, 6.0), (1.0, 2.0), (2.5, 3.0)], planned) == [(0.7, 3.3), (4.7, 6.1)]
    assert merged_spans([], planned) == []


def test_nothing_else_is_edited_while_a_foot_slides():
    assert spans_without_slides([(1.0, 9.0), (3.0, 4.0)], [(4.0, 6.0)]) == [(1.0, 3.5), (6.5, 9.0)]
    assert spans_without_slides([(1.0, 2.0)], []) == [(1.0, 2.0)]


def test_the_made_up_knee_swings_where_and_as_fast_as_the_paper_s():
    times = np.arange(0.0, 40.0, 0.02)
    found = find_oscillations(times, swinging_knee(times))
    assert len(found) == len(PAPER_SPANS)
    for one, (start, end) in zip(found, PAPER_SPANS, strict=True):
        assert (one.start, one.end) == pytest.approx((start, end), abs=0.2)
        assert one.frequency == pytest.approx(PAPER_HZ, abs=0.1)


def test_a_motion_that_leans_too_far_is_none_for_a_robot():
    motion = still_motion(Robot.load("hrp2"), 1.0)
    stands = geometric_figures(motion)
    assert stands["zmp_outside"] == 0.0 and stands["zmp_outside_p95_m"] == 0.0
    assert 0.0 < stands["torque_max"] < 1.0 and stands["velocity_max"] == 0.0
    leans = geometric_figures(replace(motion, zmp=motion.zmp + np.array([0.3, 0.0])))
    assert leans["zmp_outside"] == 1.0 and leans["zmp_outside_p95_m"] > 0.1


def test_torques_and_the_feet_s_wrenches_are_all_that_moves_the_robot():
    """With the torques, what is left of the equation of motion are wrenches of the feet that hold the weight."""
    robot = Robot.load("hrp2")
    tick, rng = Tick(robot), np.random.default_rng(0)
    q = pin.integrate(robot.model, robot.rest, 0.1 * rng.standard_normal(robot.nv))
    tick.update(0.0, q, 0.3 * rng.standard_normal(robot.nv))
    acceleration = rng.standard_normal(robot.nv)
    left = tick.M @ acceleration + tick.h - np.append(np.zeros(6), required_torque(tick, acceleration))
    J = np.vstack([tick.frame(foot).jacobian for foot in robot.feet])
    wrenches, *_ = np.linalg.lstsq(J.T, left, rcond=None)
    np.testing.assert_allclose(J.T @ wrenches, left, atol=1e-6)
    tick.update(0.0, robot.rest, np.zeros(robot.nv))
    forces = tick.h - np.append(np.zeros(6), required_torque(tick, np.zeros(robot.nv)))
    assert forces[2] == pytest.approx(robot.mass * GRAVITY, rel=1e-6)


@pytest.mark.slow
def test_the_shipped_clip_is_copied_made_stable_and_edited(tmp_path):
    report, show = run_scenario(
        "ramos", "groove", Replay("", rate=250.0, feet="scenario"), tmp_path, lambda what, share: None
    )
    assert show is ramos.show
    assert not report["fell"]
    pictures = {f"{name}.svg" for name in ("thumbnails", "curves", "scalogram", "schedule")}
    assert {path.name for path in tmp_path.iterdir()} == {"run.rrd", "report.json", "posture", "final", *pictures}
    assert all(knee["final_share"] > max(knee["posture_share"], 0.9) for knee in report["knees"])
    assert report["hand"]["final_head_min_m"] > 0.02
    (slide,) = report["slides"]
    assert slide["way_m"] > 0.08 and slide["zmp_inside"] > 0.99


def test_is_a_scenario_of_a_clip(capsys):
    assert cli.main(["list", "scenarios"]) == cli.DONE
    assert "ramos" in capsys.readouterr().out
