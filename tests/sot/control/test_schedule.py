"""Changes in time: when they happen, in which order, and that contacts come and go without a jump in torque."""

import numpy as np
import pytest

from solvers import Cascade, Status
from sot.control.contact import SLIDING_LOAD_RAMP, Contact
from sot.control.controller import Controller
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.errors import InputError
from sot.robots.robot import Robot, shipped_robot_names
from tasks import CenterOfMass
from tests.sot.stances import leaning, standing_stack

PERIOD = 0.001


def task(name):
    return CenterOfMass(np.zeros(3), name=name)


def feet():
    robot = Robot.load("hrp2")
    return Stack([Contact(robot.surface(foot)) for foot in robot.feet], [], {"first": [task("a")]})


def test_events_happen_once_in_order_of_time():
    stack, schedule = feet(), Schedule()
    schedule.remove(0.3, "b", ramp=0.0).add(0.1, task("b"), "second").move(0.2, "b", "first")
    assert schedule.apply(0.05, stack) == []
    assert schedule.apply(0.1, stack) == ["add b to second"]
    assert [level for level, _ in stack.levels] == ["first", "second"]
    assert schedule.apply(0.15, stack) == []
    assert schedule.apply(0.35, stack) == ["move b to first", "remove b"]
    assert [task.name for task in stack.tasks] == ["a"]
    assert schedule.apply(1.0, stack) == []


def test_events_of_one_time_happen_in_the_order_they_were_given():
    stack, schedule, seen = feet(), Schedule(), []
    for k in range(5):
        schedule.at(0.1, str(k), lambda stack, k=k: seen.append(k))
    schedule.apply(0.1, stack)
    assert seen == [0, 1, 2, 3, 4]


def test_an_event_given_late_happens_at_once_and_none_twice():
    stack, schedule, seen = feet(), Schedule(), []
    schedule.at(0.1, "first", lambda stack: seen.append("first"))
    schedule.apply(0.5, stack)
    schedule.at(0.0, "late", lambda stack: seen.append("late"))
    schedule.apply(0.5, stack)
    assert seen == ["first", "late"]


def test_an_event_may_add_others():
    stack, schedule, seen = feet(), Schedule(), []

    def change(stack):
        seen.append("first")
        schedule.at(0.05, "second", lambda stack: seen.append("second"))
        schedule.at(0.9, "third", lambda stack: seen.append("third"))

    schedule.at(0.1, "first", change)
    assert schedule.apply(0.1, stack) == ["first", "second"]
    schedule.apply(1.0, stack)
    assert seen == ["first", "second", "third"]


def test_an_event_that_cannot_happen_says_so():
    with pytest.raises(InputError, match="no task 'z'"):
        Schedule().remove(0.1, "z").apply(0.2, feet())
    with pytest.raises(InputError, match="no contact 'tail'"):
        Schedule().mode(0.1, "tail", "off").apply(0.2, feet())


@pytest.mark.parametrize("ramp", [0.04, 0.2])
@pytest.mark.parametrize("mode", ["off", "sliding"])
def test_a_contact_gives_its_load_away_before_it_is_broken_and_takes_it_after_it_is_made(mode, ramp):
    stack, schedule = feet(), Schedule()
    schedule.mode(0.5, "left_foot", mode, ramp).mode(1.0, "left_foot", "fixed", ramp)
    contact = stack.contact("left_foot")
    times = np.arange(0.0, 1.5, PERIOD)
    loads, modes = [], []
    for t in times:
        schedule.apply(t, stack)
        loads.append(contact.load)
        modes.append(contact.mode)
    loads = np.array(loads)
    up, down, begun = times < 0.5 - ramp - 1e-9, (times > 0.5 - 1e-9) & (times < 1.0 - 1e-9), times > 1.0 - 1e-9
    assert np.all(loads[up] == 1.0) and np.all(loads[times > 1.0 + ramp] == 1.0)
    np.testing.assert_allclose(loads[down], SLIDING_LOAD_RAMP if mode == "sliding" else 0.0, atol=1e-9)
    assert np.abs(np.diff(loads)).max() <= PERIOD / ramp + 1e-9  # as smooth as the ticks are
    halfway = 0.5 * (1.0 + loads[down][0])
    assert loads[np.searchsorted(times, 0.5 - ramp / 2)] == pytest.approx(halfway, abs=PERIOD / ramp)
    assert [m == mode for m in modes] == list(down)
    assert all(m == "fixed" for m, after in zip(modes, begun, strict=True) if after)
    assert stack.contact("right_foot").load == 1.0


def test_without_a_ramp_a_contact_changes_at_once():
    stack, schedule = feet(), Schedule().mode(0.5, "left_foot", "off", ramp=0.0).mode(0.7, "left_foot", "fixed", 0.0)
    schedule.apply(0.5, stack)
    assert (stack.contact("left_foot").mode, stack.contact("left_foot").load) == ("off", 0.0)
    schedule.apply(0.7, stack)
    assert (stack.contact("left_foot").mode, stack.contact("left_foot").load) == ("fixed", 1.0)


def torques(robot, share, schedule, mode="fixed"):
    """Torques over 0.14 s at rest with the CoM at a share of the way to the right foot, and the left foot's loads."""
    q, v = leaning(robot, share), np.zeros(robot.nv)
    stack = standing_stack(robot, at=q)
    stack.contact("left_foot").mode = mode
    controller = Controller(robot, stack, Cascade(), PERIOD, schedule)
    commands = [controller(k * PERIOD, q, v) for k in range(140)]
    assert max(command.status for command in commands) <= Status.SECOND_SOLVER
    return np.array([command.torque for command in commands]), np.array([c.wrenches[0][2] for c in commands])


@pytest.mark.parametrize("name", shipped_robot_names())
@pytest.mark.parametrize("share", [0.8, 1.0])
def test_torques_do_not_jump_when_a_foot_is_taken_off_the_floor_or_set_on_it(name, share):
    """The CoM is over the right foot; the left one still carries what costs least."""
    robot = Robot.load(name)
    for schedule, first in (
        (Schedule().mode(0.09, "left_foot", "off"), "fixed"),
        (Schedule().mode(0.03, "left_foot", "fixed"), "off"),
    ):
        torque, load = torques(robot, share, schedule, first)
        assert abs(load[0] - load[-1]) > 60.0 and min(load[0], load[-1]) < 1e-6
        change = np.abs(torque[-1] - torque[0]).max()
        largest_step = np.abs(np.diff(torque, axis=0)).max()
        assert change > 10.0, "nothing changed that could have jumped"
        assert largest_step < 5.0  # N m a tick, against the whole change at once
        assert largest_step < 0.2 * change
