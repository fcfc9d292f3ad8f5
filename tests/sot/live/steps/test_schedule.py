"""Contacts that are led through steps which nobody knew when the schedule was made."""

from types import SimpleNamespace

import numpy as np
import pytest

from scenarios.live.live_stack import live_stack
from sot.control.tick import Tick
from sot.live.reference import LiveReference
from sot.live.steps.footing import SteppingFooting
from sot.live.steps.schedule import LiveSteppingSchedule
from sot.motion.body.limits import Limits
from sot.robots.robot import Robot


@pytest.mark.parametrize("velocity, is_disturbed", [(0.02, False), (0.4, True)])
def test_the_footing_is_told_what_stands_and_whether_the_robot_is_off_its_plan(velocity, is_disturbed):
    robot = Robot.load("hrp2")
    footing = SteppingFooting(robot)
    reference = LiveReference(robot, Limits.of(robot), footing=footing)
    stack = live_stack(robot, reference, {foot: footing.swing_path(foot) for foot in robot.feet})
    schedule, tick, v = LiveSteppingSchedule(robot, reference, footing), Tick(robot), np.zeros(robot.nv)
    v[0], tick.contacts = velocity, stack.contacts
    for k in range(3):
        schedule.observe(tick.update(0.002 * k, robot.rest, v))
    assert footing.aloft == set() and footing.is_disturbed == is_disturbed
    stack.contact("left_foot").mode = "off"
    schedule.observe(tick.update(0.1, robot.rest, v))
    assert footing.aloft == {"left_foot"}


def test_a_step_that_is_begun_lifts_and_lands_its_foot():
    robot = Robot.load("hrp2")
    footing = SteppingFooting(robot)
    reference = LiveReference(robot, Limits.of(robot), footing=footing)
    stack = live_stack(robot, reference, {foot: footing.swing_path(foot) for foot in robot.feet})
    schedule = LiveSteppingSchedule(robot, reference, footing)
    modes = {}
    for k in range(200):
        t = 0.01 * k
        if k == 50:
            for tell in footing.begun:
                tell("left_foot", 0.6, 1.0)
        schedule.apply(t, stack)
        modes[k] = SimpleNamespace(**{foot: stack.contact(foot).mode for foot in robot.feet})
    assert {mode.right_foot for mode in modes.values()} == {"fixed"}
    assert [k for k, mode in modes.items() if mode.left_foot == "off"] == list(range(60, 100))
