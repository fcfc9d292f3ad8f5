"""A foot is led while it swings only, and looks for the floor when it is late."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.control.contact import Contact
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks import SwingFoot
from tests.sot.behaviours.stepping import FIRST, SWING, stepping_motion

FOOT = "right_foot"


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def motion(robot):
    return stepping_motion(robot, rate=200.0)


def swung(robot, motion, t: float, mode: str) -> tuple[SwingFoot, np.ndarray]:
    """The task and its wanted accelerations on a robot that is where the motion is at a time."""
    task, tick = SwingFoot(robot, FOOT, motion), Tick(robot)
    contact = Contact(robot.surface(FOOT))
    contact.mode = mode
    tick.contacts = [contact]
    now = motion.sample(t)
    tick.update(t, now.q, now.v)
    rows = task.rows(tick)
    return task, rows.lower + (tick.frame(FOOT).drift if len(rows.lower) else np.zeros(0))


def test_a_foot_that_stands_is_not_asked_for_anything(robot, motion):
    task, wanted = swung(robot, motion, FIRST + 0.3, "fixed")
    assert wanted.shape == (0,)
    assert task.error.shape == (0,)


def test_on_its_path_a_foot_is_asked_for_the_paths_acceleration(robot, motion):
    t = FIRST + 0.3
    task, wanted = swung(robot, motion, t, "off")
    np.testing.assert_allclose(task.error, 0.0, atol=1e-9)
    np.testing.assert_allclose(wanted, motion.pose(FOOT)(t).acceleration, atol=1e-6)


def test_a_late_foot_is_lowered_steadily_and_without_a_kick(robot, motion):
    lands = FIRST + SWING
    depths = []
    for late in np.arange(0.0, 0.12, 0.005):
        task, _ = swung(robot, motion, lands + late, "off")
        depths.append(-task.error[2])
    speed = np.diff(depths) / 0.005
    assert depths[0] == pytest.approx(0.0, abs=1e-5)  # rounding of the path
    assert speed[0] < 0.02
    np.testing.assert_allclose(speed[8:], 0.1, rtol=0.02)
    assert np.abs(np.diff(speed)).max() < 0.02


def test_a_path_that_ends_above_the_floor_is_led_onto_it(robot, motion):
    down = pin.SE3(np.eye(3), np.array([0.0, 0.0, -0.6e-3]))
    phases = [
        replace(phase, feet={foot: down * pose for foot, pose in phase.feet.items()}) if phase.start > FIRST else phase
        for phase in motion.phases
    ]
    lower = replace(motion, phases=tuple(phases))
    for share, missing in ((0.0, 0.0), (0.5, -0.3e-3), (1.0, -0.6e-3)):
        task, _ = swung(robot, lower, FIRST + share * SWING, "off")
        assert task.error[2] == pytest.approx(missing, abs=2e-5)


def test_a_foot_leaves_with_what_its_contact_asked_for_and_is_led_over_to_its_path(robot, motion):
    """Off its path: a foot that stood beside its place is not pulled there at once."""
    task, tick, contact = SwingFoot(robot, FOOT, motion), Tick(robot), Contact(robot.surface(FOOT))
    tick.contacts = [contact]
    there = motion.sample(FIRST + 0.05)
    velocity = there.v + 0.01

    def wanted(mode: str, t: float) -> np.ndarray:
        contact.mode = mode
        tick.update(t, there.q, velocity)
        rows = task.rows(tick)
        return rows.lower + tick.frame(FOOT).drift if mode == "off" else np.zeros(0)

    wanted("fixed", FIRST - 0.001)
    stood = contact.acceleration(tick)
    np.testing.assert_allclose(wanted("off", FIRST), stood)
    plain, shares = SwingFoot(robot, FOOT, motion), []  # never saw it stand
    for t in FIRST + np.arange(0.0, 0.05, 0.002):
        led, path = wanted("off", t), plain.rows(tick).lower + tick.frame(FOOT).drift
        lead = led - path
        shares.append(lead @ (stood - path) / ((stood - path) @ (stood - path)))
        np.testing.assert_allclose(lead, shares[-1] * (stood - path), atol=1e-9)
    assert shares[0] == pytest.approx(1.0) and np.abs(shares[20:]).max() < 1e-12
    assert np.all(np.diff(shares[:20]) < 0.0) and -np.diff(shares).min() < 0.25
