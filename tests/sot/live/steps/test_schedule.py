"""Contacts that are led through steps which nobody knew when the schedule was made."""

from types import SimpleNamespace

from scenarios.live.live_stack import live_stack
from sot.live.reference import LiveReference
from sot.live.steps.footing import SteppingFooting
from sot.live.steps.schedule import LiveSteppingSchedule
from sot.motion.body.limits import Limits
from sot.robots.robot import Robot


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
