"""Tasks on their way through a stack: what the robot is asked for changes without a jump."""

import numpy as np
import pytest

from solvers import Cascade
from sot.control.controller import Controller
from sot.control.schedule import Schedule
from sot.errors import InputError
from sot.robots.robot import Robot
from tasks import Posture
from tests.sot.stances import standing_stack

PERIOD = 0.002
TASK_RAMP = 0.2
ON = "arm"


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def arm(robot):
    """An arm that wants to be elsewhere by half a radian: 50 rad/s² off what the posture asks for."""
    return Posture(robot, robot.rest[7:] + 0.5, "right_arm", name=ON)


def accelerations(robot, schedule, stack, seconds):
    controller = Controller(robot, stack, Cascade(), PERIOD, schedule)
    q, v = robot.rest, np.zeros(robot.nv)
    return np.array([controller(k * PERIOD, q, v).acceleration for k in range(round(seconds / PERIOD))])


CHANGES = {
    "into a level of its own": lambda schedule, task: schedule.add(0.1, task, "own", before="posture", ramp=TASK_RAMP),
    "into a level of its own far up": lambda schedule, task: schedule.add(
        0.1, task, "own", before="head", ramp=TASK_RAMP
    ),
    "into a level of others": lambda schedule, task: schedule.add(0.1, task, "posture", ramp=TASK_RAMP),
    "up through levels": lambda schedule, task: schedule.add(0.0, task, "low", before="forces", ramp=0.0).move(
        0.1, ON, "trunk", ramp=TASK_RAMP
    ),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES.keys())
def test_no_jump(robot, change):
    """The same state all the time, so that only the stack changes the answer."""
    there = accelerations(robot, change(Schedule(), arm(robot)), standing_stack(robot), 0.4)
    changed = np.abs(there[-1] - there[0]).max()
    assert changed > 10.0
    assert np.abs(np.diff(there, axis=0)).max() < 0.2 * changed


def test_out_is_the_way_in_backwards(robot):
    coming = Schedule().add(0.1, arm(robot), "own", before="posture", ramp=TASK_RAMP)
    going = (
        Schedule().add(0.0, arm(robot), "own", before="posture", ramp=0.0).remove(0.1 + TASK_RAMP, ON, ramp=TASK_RAMP)
    )
    there = accelerations(robot, coming, standing_stack(robot), 0.4)
    back = accelerations(robot, going, standing_stack(robot), 0.4)
    # Ticks begin a period later, seen from the other end.
    np.testing.assert_allclose(back[::-1][:-1], there[1:], atol=0.01 * np.abs(there).max())


def test_a_task_arrives_with_its_own_weight_and_passes_where_it_says(robot):
    stack, task = standing_stack(robot), arm(robot)
    task.weight = 2.0
    schedule = Schedule().add(1.0, task, "own", before="head", ramp=TASK_RAMP).move(2.0, ON, "posture", ramp=TASK_RAMP)
    seen = []
    for t in np.arange(0.9, 2.5, 0.01):
        schedule.apply(t, stack)
        level = stack.level_of(task)
        if not seen or seen[-1] != level:
            seen.append(level)
        assert (ON in stack.transition_shares) == (1.0 - 1e-9 <= t < 1.199 or 2.0 - 1e-9 <= t < 2.199)
    assert seen == [None, "forces", "posture", "head", "own", "head", "posture"]
    assert task.weight == 2.0
    assert stack.level_names.index("own") == stack.level_names.index("head") - 1


def test_a_change_ends_the_one_before(robot):
    stack, task = standing_stack(robot), arm(robot)
    schedule = Schedule().add(1.0, task, "own", before="posture", ramp=1.0).remove(1.6, ON, ramp=0.2)
    for t in np.arange(0.9, 1.7, 0.01):
        schedule.apply(t, stack)
    assert stack.level_of(task) is None
    assert task.weight == 1.0
    assert not stack.transition_shares


def test_what_cannot_be_changed_says_so_at_once(robot):
    stack = standing_stack(robot)
    with pytest.raises(InputError, match="no level 'nowhere'"):
        Schedule().add(0.1, arm(robot), "own", before="nowhere").apply(0.2, stack)
    with pytest.raises(InputError, match="a task 'Balance' already"):
        Schedule().add(0.1, Posture(robot, robot.rest[7:], name="Balance"), "own").apply(0.2, stack)


def test_a_task_added_in_a_loop_comes_as_with_a_schedule(robot):
    """The same acceleration at every tick, by `Stack.add` between two ticks."""
    scheduled = accelerations(
        robot, Schedule().add(0.1, arm(robot), "own", before="posture"), standing_stack(robot), 0.4
    )
    stack = standing_stack(robot)
    controller, task = Controller(robot, stack, Cascade(), PERIOD), arm(robot)
    live = []
    for k in range(len(scheduled)):
        if k == round(0.1 / PERIOD) + 1:
            stack.add(task, "own", before="posture")  # since the tick before, at 0.1 s
        live.append(controller(k * PERIOD, robot.rest, np.zeros(robot.nv)).acceleration)
    np.testing.assert_allclose(live, scheduled, atol=1e-6)
