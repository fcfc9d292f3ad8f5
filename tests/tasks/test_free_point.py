"""A link that is led while it is free: no rows while it supports, and no jump when it lets go."""

import numpy as np
import pytest

from sot.control.contact import Contact
from sot.control.pose import Pose
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks import FreePoint


@pytest.fixture
def standing():
    robot = Robot.load("hrp2")
    tick, contact = Tick(robot), Contact(robot.surface("right_foot"))
    tick.contacts = [contact]
    tick.update(0.0, robot.rest, np.zeros(robot.nv))
    return robot, tick, contact


def led(tick, acceleration):
    frame = tick.frame("right_foot")
    pose = Pose(frame.position.copy(), frame.rotation.copy(), np.zeros(6), acceleration)
    return lambda t: pose


def test_it_has_no_rows_while_it_supports(standing):
    robot, tick, contact = standing
    task = FreePoint(robot, "right_foot", led(tick, np.zeros(6)))
    assert task.rows(tick).A.shape == (0, robot.nv)
    contact.mode = "off"
    assert task.rows(tick).A.shape == (6, robot.nv)


def test_it_begins_with_what_the_contact_demanded(standing):
    robot, tick, contact = standing
    acceleration = np.array([0.0, 0.0, 3.0, 0.0, 0.0, 0.0])
    task = FreePoint(robot, "right_foot", led(tick, acceleration))
    task.rows(tick)
    demanded = contact.acceleration(tick)
    contact.mode = "off"
    assert task.rows(tick).lower == pytest.approx(demanded - tick.frame("right_foot").drift, abs=1e-9)
    tick.update(0.05, robot.rest, np.zeros(robot.nv))
    assert task.rows(tick).lower == pytest.approx(acceleration - tick.frame("right_foot").drift, abs=1e-9)


def test_a_point_without_a_footing_is_always_led(standing):
    robot, tick, _ = standing
    frame = tick.frame("left_hand")
    pose = Pose(frame.position.copy(), frame.rotation.copy(), np.zeros(6), np.zeros(6))
    assert FreePoint(robot, "left_hand", lambda t: pose).rows(tick).A.shape == (6, robot.nv)
