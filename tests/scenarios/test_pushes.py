"""Pushes in closed loop: a robot that stands is pushed off its feet, and catches itself."""

import numpy as np
import pytest

from scenarios import stacks
from sim.loop import Run, run
from sim.push import Push
from sim.reporting import figures
from sim.world import World
from solvers import Cascade
from sot.behaviours.stepping import SteppingSchedule
from sot.control.controller import Controller
from sot.control.schedule import Schedule
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from tests.sim.runs import still_motion

RATE = 200.0


@pytest.fixture(scope="module")
def motion() -> Motion:
    return still_motion(Robot.load("hrp2"), 2.4)


def pushed(motion: Motion, impulse: tuple[float, float], schedule: Schedule) -> Run:
    """The shipped stack, pushed at the chest with an impulse [N s]."""
    robot, force = motion.robot, (10.0 * impulse[0], 10.0 * impulse[1], 0.0)
    controller = Controller(robot, stacks.stepping_stack(robot, motion), Cascade(), 1.0 / RATE, schedule)
    return run(controller, World(robot, 1.0 / RATE, pushes=[Push(0.2, force)]), motion)


@pytest.mark.parametrize("impulse", [(26.0, 4.0), pytest.param((-18.0, 3.0), marks=pytest.mark.slow)])
def test_a_push_beyond_what_the_feet_can_hold_is_caught_by_a_step(motion, impulse):
    robot = motion.robot
    assert pushed(motion, impulse, SteppingSchedule(robot, motion.phases)).fell_at_s is not None
    caught = pushed(motion, impulse, stacks.stepping_schedule(robot, motion))
    assert caught.fell_at_s is None, caught.reason
    log = caught.log.trimmed()
    assert figures.contacts(log, motion)["switches"] >= 2
    upright = figures.Points.of(robot, log.q[-1:], ["chest"]).rotations["chest"][0, 2, 2]
    assert upright > np.cos(0.1)


def test_a_push_that_the_feet_can_hold_makes_no_step(motion):
    done = pushed(motion, (8.0, 0.0), stacks.stepping_schedule(motion.robot, motion))
    assert done.fell_at_s is None
    assert figures.contacts(done.log.trimmed(), motion)["switches"] == 0
