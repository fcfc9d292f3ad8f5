"""A hand that presses a lever's bar."""

import numpy as np
import pytest

from scenarios.humanoidbench.door import DoorScene
from sot.motion.carrying import pass_door as plan
from sot.motion.carrying.door_layout import DoorLayout, along_and_out
from sot.robots.robot import Robot

ANGLE, LEVER = np.zeros(4), np.array([0.0, 0.3, 0.6, 0.9])
LEVEL_TURN = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
"""Of the left hand: its palm faces down, its fingers point to the lever's axis."""


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def door(robot: Robot) -> DoorLayout:
    return DoorScene.of(robot, 1).layout()


def test_all_that_can_touch_at_a_hand_counts(robot: Robot) -> None:
    palm = robot.surface("left_palm")
    corners = plan._corners(robot, palm) @ LEVEL_TURN.T
    assert len(corners) == 12  # of palm, end and hook
    assert corners[:, 1].min() == pytest.approx(-0.072)  # the end sticks out beyond the palm's edge at 35 mm
    assert corners[:, 2].min() == pytest.approx(0.0, abs=1e-9)


def test_a_level_hand_rests_on_the_sloping_bar_where_it_is_to_be_pressed(robot: Robot, door: DoorLayout) -> None:
    corners = np.tile(plan._corners(robot, robot.surface("left_palm")) @ LEVEL_TURN.T, (4, 1, 1))
    place, touch = plan._on_bar(door, ANGLE, LEVER, corners)
    along, out = along_and_out(LEVER)
    height = np.einsum("tnj,tj->tn", place[:, None] + corners - door.lever, out) - door.bar
    np.testing.assert_allclose(height.min(axis=1), 0.0, atol=1e-9)  # nothing within the bar, something on it
    deepest = (place + touch - door.lever)[-1]
    assert deepest @ out[-1] == pytest.approx(door.bar, abs=1e-3)
    assert deepest @ along[-1] == pytest.approx(door.press, abs=1e-3)
    assert touch[-1, 1] < -0.06  # it is the hand's end that touches then, not the palm


def test_a_hand_without_extent_is_where_the_bar_is_pressed(door: DoorLayout) -> None:
    place, touch = plan._on_bar(door, ANGLE, LEVER, np.zeros((4, 1, 3)))
    np.testing.assert_allclose(place, [door.on_lever(b)[0] for b in LEVER.tolist()], atol=1e-12)
    np.testing.assert_allclose(touch, 0.0, atol=1e-12)
