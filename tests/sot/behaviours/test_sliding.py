"""A schedule that has contacts slide as the phases of a motion say."""

import pytest

from sot.behaviours.sliding import SlidingSchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.slides import Slide, phases_with_slides
from sot.robots.robot import Robot, shipped_robot_names


@pytest.mark.parametrize("name", shipped_robot_names())
def test_contacts_slide_and_stand_again_with_the_phases(name):
    robot = Robot.load(name)
    phases = phases_with_slides(planted_phases(robot, 20.0), [Slide("left_foot", 3.0, 8.0, (0.05, 0.0, 0.0))], robot)
    stack, schedule = Stack([Contact(robot.surface(foot)) for foot in robot.feet], [], {}), SlidingSchedule(phases)
    seen = []
    for t in (1.0, 2.99, 3.0, 7.99, 8.0, 8.1):
        schedule.apply(t, stack)
        seen.append(stack.contact("left_foot").mode)
        assert stack.contact("right_foot").mode == "fixed" and stack.contact("right_foot").load == 1.0
    assert seen == ["fixed", "fixed", "sliding", "sliding", "fixed", "fixed"]
    assert stack.contact("left_foot").load == 1.0
