"""The stack: order, changes, and errors that leave it as it was."""

import numpy as np
import pytest

from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.errors import InputError
from sot.robots.robot import Robot
from tasks import CenterOfMass, JointBounds, Posture, TorqueBounds


@pytest.fixture
def robot():
    return Robot.load("hrp2")


@pytest.fixture
def stack(robot):
    return Stack(
        contacts=[Contact(robot.surface(foot)) for foot in robot.feet],
        hard=[TorqueBounds(robot)],
        levels={"first": [task("a"), task("b")], "empty": [], "second": [task("c")]},
    )


def task(name):
    return CenterOfMass(np.zeros(3), name=name)


def order(stack):
    return [(level, [task.name for task in tasks]) for level, tasks in stack.levels]


def test_levels_keep_their_order_and_empty_ones_do_not_count(stack):
    assert order(stack) == [("first", ["a", "b"]), ("second", ["c"])]
    assert [task.name for task in stack.tasks] == ["a", "b", "c"]


def test_add(stack):
    stack.add(task("d"), "empty")
    stack.add(task("e"), "last")
    stack.add(task("f"), "between", before="second")
    assert order(stack) == [
        ("first", ["a", "b"]),
        ("empty", ["d"]),
        ("between", ["f"]),
        ("second", ["c"]),
        ("last", ["e"]),
    ]


def test_remove_gives_the_task_back_and_keeps_the_level(stack):
    removed = stack.remove("c")
    assert removed.name == "c"
    assert order(stack) == [("first", ["a", "b"])]
    stack.add(removed, "second")
    stack.add(task("d"), "third")
    assert order(stack) == [("first", ["a", "b"]), ("second", ["c"]), ("third", ["d"])]


def test_move(stack):
    stack.move("a", "second")
    assert order(stack) == [("first", ["b"]), ("second", ["c", "a"])]
    stack.move("c", "top", before="first")
    assert order(stack) == [("top", ["c"]), ("first", ["b"]), ("second", ["a"])]


def test_a_change_does_not_touch_what_the_stack_was_made_from(robot):
    levels, contacts = {"first": [task("a")]}, [Contact(robot.surface("left_foot"))]
    stack = Stack(contacts, [], levels)
    stack.remove("a")
    stack.contacts.clear()
    assert len(levels["first"]) == len(contacts) == 1


def test_a_contact_by_its_point(stack):
    assert stack.contact("right_foot") is stack.contacts[1]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda stack: stack.add(task("a"), "second"), "has a task 'a' already"),
        (lambda stack: stack.add(task("TorqueBounds"), "second"), "has a task 'TorqueBounds' already"),
        (
            lambda stack: stack.add(task("d"), "new", before="nowhere"),
            "no level 'nowhere': it has first, empty, second",
        ),
        (lambda stack: stack.remove("z"), "no task 'z': it has a, b, c"),
        (lambda stack: stack.move("z", "new"), "no task 'z'"),
        (lambda stack: stack.move("a", "new", before="nowhere"), "no level 'nowhere'"),
        (lambda stack: stack.contact("left_hand"), "no contact 'left_hand': there are left_foot, right_foot"),
    ],
)
def test_errors_say_what_there_is_and_change_nothing(stack, change, message):
    before = dict(stack._levels)
    with pytest.raises(InputError, match=message):
        change(stack)
    assert stack._levels == before
    assert order(stack) == [("first", ["a", "b"]), ("second", ["c"])]


def test_names_are_unique_from_the_start(robot):
    with pytest.raises(InputError, match="two entries named 'a'"):
        Stack([], [], {"first": [task("a")], "second": [task("a")]})
    with pytest.raises(InputError, match="two entries named 'JointBounds'"):
        Stack([], [JointBounds(robot), JointBounds(robot)], {})
    with pytest.raises(InputError, match="two entries named 'left_foot'"):
        Stack([Contact(robot.surface("left_foot"))] * 2, [], {})
    Stack([], [], {"first": [Posture(robot, robot.rest[7:], "arms"), Posture(robot, robot.rest[7:], "legs")]})


def test_before_it_runs_changes_are_made_at_once(stack):
    new = task("new")
    stack.add(new, "first")
    stack.move("a", "second")
    assert order(stack) == [("first", ["b", "new"]), ("second", ["c", "a"])]
    assert new.weight == 1.0 and not stack.transition_shares


def test_while_it_runs_changes_are_eased(stack):
    new, gone = task("new"), stack.task("c")
    stack.advance(1.0)
    stack.add(new, "top", before="first", ramp=0.2)
    assert stack.remove("c", ramp=0.2) is gone
    assert stack.level_of(new) == "second" and new.weight < 0.1  # rising from below all levels
    assert stack.level_of(gone) == "second" and stack.transition_shares == {"new": 0.0, "c": 0.0}
    seen = []
    for t in np.arange(1.0, 1.22, 0.01):
        stack.advance(t)
        if not seen or seen[-1] != stack.level_of(new):
            seen.append(stack.level_of(new))
    assert seen == ["second", "first", "top"] and new.weight == 1.0
    assert stack.level_of(gone) is None and gone.weight == 1.0 and not stack.transition_shares


def test_while_it_runs_a_ramp_of_nothing_is_at_once(stack):
    stack.advance(1.0)
    stack.add(task("new"), "top", before="first", ramp=0.0)
    stack.remove("a", ramp=0.0)
    assert order(stack) == [("top", ["new"]), ("first", ["b"]), ("second", ["c"])]


def test_settled_it_is_where_it_was_led_to(stack):
    stack.advance(1.0)
    new = task("new")
    stack.add(new, "top", before="first")
    stack.remove("a")
    stack.settle()
    assert order(stack) == [("top", ["new"]), ("first", ["b"]), ("second", ["c"])]
    assert new.weight == 1.0 and stack.time is None and not stack.transition_shares
    stack.remove("b")
    assert order(stack) == [("top", ["new"]), ("second", ["c"])]
