"""Edits as tasks: they outrank the posture of what they move, come and go in time, and do not meet."""

import numpy as np
import pytest

from scenarios import stacks
from sot.control.schedule import Schedule
from sot.control.tick import Tick
from sot.errors import InputError
from sot.motion.edit import Edit
from sot.robots.robot import Robot
from tasks import OperationalPoint, Posture
from tasks.editing import edit
from tests.sim.runs import still_motion


@pytest.fixture(scope="module")
def motion():
    return still_motion(Robot.load("hrp2"), 4.0)


def order(stack):
    return [name for name, _ in stack.levels]


def test_an_edit_has_a_level_of_its_own_above_the_posture_while_it_lasts(motion):
    stack, schedule = stacks.planted_stack(motion.robot, motion), Schedule()
    lines = edit(stack, schedule, motion, [Edit("right_hand", "z", by=0.1, start=1.0, end=3.0)])
    assert lines == ["edit 1: right_hand z, 1 to 3 s: outranks 'posture', which stays as a guide"]
    before = order(stack)
    schedule.apply(0.5, stack)
    assert order(stack) == before
    schedule.apply(2.0, stack)
    assert order(stack) == ["balance", "waist", "right_hand edited", "posture", "forces"]
    schedule.apply(3.3, stack)
    assert order(stack) == before


def test_it_comes_before_the_first_level_that_it_interferes_with(motion):
    """The waist has a task of its own in the shipped stack; a leg's posture may be in another level than an arm's."""
    robot = motion.robot
    for one, outranked in (
        (Edit("waist", "yaw", by=0.1, start=1.0, end=3.0), "waist"),
        (Edit("waist", "z", by=0.1, start=1.0, end=3.0), "legs"),
        (Edit("left_hand", "x", by=0.1, start=1.0, end=3.0), "rest"),
        (Edit("LARM3", by=0.1, start=1.0, end=3.0), "rest"),
        (Edit("RLEG3", by=0.1, start=1.0, end=3.0), "legs"),
        (Edit("right_hand", "x", by=0.1, start=1.0, end=3.0), "hand"),
        (Edit("right_hand", "z", by=0.1, start=1.0, end=3.0), "rest"),
    ):
        stack = stacks.planted_stack(robot, motion)
        stack.remove("Posture")
        stack.add(Posture(robot, motion.joints, "legs"), "legs", before="forces")
        stack.add(OperationalPoint(robot, "right_hand", motion.pose("right_hand"), "xy"), "hand", before="forces")
        upper = [joint for joint in robot.joints if "LEG" not in joint]
        stack.add(Posture(robot, motion.joints, upper), "rest", before="forces")
        assert f"outranks '{outranked}'" in edit(stack, Schedule(), motion, [one])[0]


def test_without_a_posture_it_comes_before_what_decides_on_the_forces(motion):
    stack = stacks.planted_stack(motion.robot, motion)
    stack.remove("Posture")
    (line,) = edit(stack, Schedule(), motion, [Edit("right_hand", "z", by=0.1, start=1.0, end=3.0)])
    assert "outranks 'forces'" in line


def test_edits_of_one_point_share_a_level_and_a_reference(motion):
    stack, schedule = stacks.planted_stack(motion.robot, motion), Schedule()
    edits = [
        Edit("right_hand", "z", by=0.1, start=1.0, end=3.0),
        Edit("right_hand", "yaw", by=0.2, start=1.5, end=3.5),
        Edit("RARM1", by=0.2, start=1.5, end=3.5),
    ]
    assert len(edit(stack, schedule, motion, edits)) == 3
    for t in np.arange(0.0, 2.5, 0.01):
        schedule.apply(t, stack)
    levels = dict(stack.levels)
    assert [task.name for task in levels["right_hand edited"]] == ["edit 1", "edit 2"]
    assert [task.labels for task in levels["right_hand edited"]] == [["z"], ["yaw"]]
    assert list(levels)[2:5] == ["right_hand edited", "RARM1 edited", "posture"]


def test_two_edits_of_the_same_thing_at_the_same_time_are_refused(motion):
    first = Edit("right_hand", "z", by=0.1, start=1.0, end=2.0)
    target = Edit("right_hand", target=(0.4, -0.3, 1.0), start=1.5, end=3.0, source="mine.toml: edit 2")
    with pytest.raises(InputError, match=r"mine.toml: edit 2: changes right_hand .* from 1.5 to 2 s, as edit 1"):
        edit(stacks.planted_stack(motion.robot, motion), Schedule(), motion, [first, target])
    later = Edit("right_hand", target=(0.4, -0.3, 1.0), start=2.0, end=3.0)
    turned = Edit("right_hand", "yaw", by=0.1, start=1.0, end=2.0)
    assert len(edit(stacks.planted_stack(motion.robot, motion), Schedule(), motion, [first, later, turned])) == 3


def test_a_limb_does_an_edit_alone_guided_by_what_was_planned_for_it(motion):
    robot, stack, schedule = motion.robot, stacks.planted_stack(motion.robot, motion), Schedule()
    edits = [
        Edit("right_hand", "z", by=0.1, start=1.0, end=3.0, limb_only=True),
        Edit("RARM5", by=0.2, start=1.5, end=3.5),
    ]
    lines = edit(stack, schedule, motion, edits)
    assert lines[0] == "edit 1: right_hand z, 1 to 3 s, by its limb alone: outranks 'posture', which stays as a guide"
    for t in np.arange(0.0, 2.5, 0.01):
        schedule.apply(t, stack)
    hand, guide = dict(stack.levels)["right_hand edited"]
    arm = {robot.joints[k] for k in robot.groups["right_arm"]}
    assert set(guide.labels) == arm - {"RARM5"} and guide.feedforward
    columns = np.flatnonzero(np.abs(hand.rows(Tick(robot)).A).sum(axis=0))
    assert {robot.joints[k - 6] for k in columns} <= arm
    schedule.apply(3.3, stack)
    assert "right_hand edited" not in order(stack)


def test_what_is_on_no_limb_has_none_that_does_it_alone(motion):
    with pytest.raises(InputError, match="waist is on no limb"):
        one = Edit("waist", "z", by=0.1, start=1.0, end=3.0, limb_only=True)
        edit(stacks.planted_stack(motion.robot, motion), Schedule(), motion, [one])
    with pytest.raises(InputError, match="only points have a limb"):
        Edit("RARM5", by=0.1, start=1.0, end=3.0, limb_only=True)
