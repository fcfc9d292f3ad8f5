"""Steps in closed loop: the robot walks two steps of a motion made for the test."""

from pathlib import Path

import numpy as np
import pytest

from scenarios import stacks
from scenarios.replay import Replay, replay
from sim.log import FOOT_OFF
from sim.loop import run
from sim.reporting import figures
from sim.world import World
from solvers import Cascade
from sot.control.controller import Controller
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from tests.sot.behaviours.stepping import stepping_motion

WALK = Path(__file__).parents[2] / "../shared/mocap/bandai_walk.bvh"
RATE = 500.0
JUMP = 10.0
"""Most that any joint's torque may change from one tick to the next around a switch, at that rate [N m]."""


@pytest.fixture(scope="module")
def motion() -> Motion:
    return stepping_motion(Robot.load("hrp2"), rate=RATE)


@pytest.fixture(scope="module")
def stepped(motion):
    robot = motion.robot
    stack, schedule = stacks.stepping_stack(robot, motion), stacks.stepping_schedule(robot, motion)
    done = run(Controller(robot, stack, Cascade(), 1.0 / RATE, schedule), World(robot, 1.0 / RATE), motion)
    assert done.fell_at_s is None, done.reason
    return done.log.trimmed()


def test_each_foot_steps_and_lands_where_it_should(motion, stepped):
    assert figures.contacts(stepped, motion)["switches"] == 4
    last = motion.phases[-1].feet
    places = figures.Points.of(motion.robot, stepped.q[-1:]).positions
    for foot in motion.robot.feet:
        np.testing.assert_allclose(places[foot][0], last[foot].translation, atol=3e-3)
        assert (stepped.foot_mode[:, motion.robot.feet.index(foot)] == FOOT_OFF).sum() > 0.5 * RATE


def test_in_balance_and_without_slip(motion, stepped):
    assert figures.zmp(stepped, motion)["inside"] > 0.98
    contacts = figures.contacts(stepped, motion)
    assert contacts["slip_max_m"] < 0.003
    assert contacts["sole_tilt_max_deg"] < 1.0
    assert figures.tracking(stepped, motion)["com_rms_m"] < 0.003
    assert figures.solver(stepped)["infeasible_ticks"] == 0


def test_no_joint_torque_jumps_at_a_switch(motion, stepped):
    assert figures.contacts(stepped, motion)["torque_step_max_nm"] < JUMP


@pytest.mark.slow
@pytest.mark.skipif(not WALK.is_file(), reason="the clip is not here")
def test_no_joint_torque_steps_by_more_than_a_tenth_of_its_limit_while_walking(tmp_path):
    report = replay(Replay(str(WALK), feet="auto", duration=4.0), tmp_path, lambda what, share: None)
    assert not report["fell"] and report["contacts"]["switches"] > 8
    assert report["contacts"]["torque_step_max_nm"] < 0.1 * Robot.load("hrp2").effort.max()
