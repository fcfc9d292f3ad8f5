"""References can be replaced at any time: from then on a task asks for what a new one with that reference would."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control import Pose, Tick
from sot.errors import InputError
from sot.motion import Motion
from sot.robots import Robot
from tasks import AngularMomentum, Balance, CenterOfMass, FootSliding, OperationalPoint, Posture, SwingFoot
from tests.sot.stances import standing_stack
from tests.sot.states import standing_state

ROBOT = Robot.load("hrp2")
MOTION = Motion.standing(ROBOT, 1.0, 100.0)


def moving(size):
    return lambda t: (np.full(size, 0.1 + t), np.full(size, 0.2), np.full(size, 0.3))


def path(t):
    return Pose(np.array([0.2, 0.1, 1.0 + t]), np.eye(3), np.full(6, 0.1), np.full(6, 0.2))


def plan(t):
    return np.array([0.01, 0.0, 0.7]), np.zeros(3), np.zeros(3), np.array([0.01, 0.0])


HAND = pin.SE3(np.eye(3), np.array([0.3, -0.2, 0.9]))
TASKS = {
    "a point by a path": (lambda r: OperationalPoint(ROBOT, "right_hand", r), [HAND, path]),
    "a point by a target": (lambda r: OperationalPoint(ROBOT, "right_hand", r, axes="xyz"), [path, [0.3, 0.1, 1.0]]),
    "the centre of mass": (CenterOfMass, [np.array([0.0, 0.0, 0.7]), moving(3)]),
    "joints": (lambda r: Posture(ROBOT, r, "right_arm"), [moving(ROBOT.na), np.full(ROBOT.na, 0.2)]),
    "balance": (Balance, [MOTION.balance, plan]),
    "momentum": (AngularMomentum, [None, lambda t: (np.ones(3), np.zeros(3))]),
    "a sliding foot": (lambda r: FootSliding(ROBOT, "left_foot", r), [MOTION.pose("left_foot"), path]),
}


def asked(task):
    stack = standing_stack(ROBOT)
    stack.contact("left_foot").mode = "sliding" if isinstance(task, FootSliding) else "fixed"
    tick = Tick(ROBOT)
    tick.contacts = stack.contacts
    rows = task.rows(tick.update(0.3, *standing_state(ROBOT, np.random.default_rng(0))))
    return rows.lower.copy()


@pytest.mark.parametrize(("make", "references"), TASKS.values(), ids=TASKS.keys())
def test_a_new_reference_is_followed_from_then_on(make, references):
    first, second = references
    task, other = make(first), make(second)
    before = asked(task)
    task.reference = second
    np.testing.assert_array_equal(asked(task), asked(other))
    assert np.abs(asked(task) - before).max() > 1e-3
    task.reference = other.reference  # what is read can be set
    np.testing.assert_array_equal(asked(task), asked(other))


def test_a_swing_foot_follows_a_new_path():
    task, tick = SwingFoot(ROBOT, "left_foot", MOTION), Tick(ROBOT)
    contact = standing_stack(ROBOT).contact("left_foot")
    contact.mode, tick.contacts = "off", [contact]
    before = task.rows(tick).lower.copy()
    task.reference = path
    assert task.reference is path
    assert np.abs(task.rows(tick).lower - before).max() > 1.0


WRONG = {
    "a position for an orientation": (OperationalPoint(ROBOT, "head", HAND, axes="RPY"), [0.0, 0.0, 1.0], "no orient"),
    "two numbers for a place": (CenterOfMass(np.zeros(3)), [0.0, 1.0], "CenterOfMass: give 3 finite numbers"),
    "a posture of some joints": (Posture(ROBOT, np.zeros(ROBOT.na)), np.zeros(5), "Posture: give 30 finite numbers"),
    "a place that is no number": (OperationalPoint(ROBOT, "head", HAND, axes="xyz"), [0.0, np.nan, 1.0], "3 finite"),
}


@pytest.mark.parametrize(("task", "reference", "message"), WRONG.values(), ids=WRONG.keys())
def test_what_is_no_reference_says_so_and_changes_nothing(task, reference, message):
    before = task.reference
    with pytest.raises(InputError, match=message):
        task.reference = reference
    assert task.reference is before
