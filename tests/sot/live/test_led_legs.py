"""Legs that go with the pelvis: the feet stay, and legs that were led beyond their reach come back."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.pose import Pose
from sot.live.led_legs import LedLegs
from sot.live.reference import LiveReference
from sot.live.state import pinocchio_state
from sot.motion.body.coordinates import from_configuration, to_configuration
from sot.motion.body.limits import Limits
from sot.motion.feet.contacts import planted_phases
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def foot_error(robot, y):
    """Largest distance of a foot from its place [m]."""
    (phase,) = planted_phases(robot, 1.0)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, to_configuration(y[None])[0])
    return max(
        np.linalg.norm(data.oMf[robot.point(foot)].translation - pose.translation) for foot, pose in phase.feet.items()
    )


def test_legs_come_back_from_a_pelvis_out_of_reach(robot):
    (phase,) = planted_phases(robot, 1.0)
    rest = from_configuration(robot.rest[None])[0]
    legs, still = LedLegs(robot, phase, rest), np.zeros(robot.nv)
    for shift in (*np.linspace(0.0, 1.0, 40), *np.linspace(1.0, 0.0, 40)):
        y = rest.copy()
        y[:6] += shift * np.array([0.1, 0.05, 0.15, -0.2, 0.3, 0.9])
        y, _, _ = legs(y, still, still)
        joints = y[6:]
        assert (joints >= robot.lower - 1e-9).all() and (joints <= robot.upper + 1e-9).all()
    assert foot_error(robot, y) < 1e-3


def test_legs_accelerations_are_linear_in_those_of_the_base(robot):
    (phase,) = planted_phases(robot, 1.0)
    rest, chance = from_configuration(robot.rest[None])[0], np.random.default_rng(1)
    legs = LedLegs(robot, phase, rest)
    dy = np.zeros(robot.nv)
    dy[:6] = 0.3 * chance.normal(size=6)
    y, dy, _ = legs(rest, dy, np.zeros(robot.nv))
    A, b = legs.accelerations(y, dy)
    for _ in range(4):
        ddy = np.zeros(robot.nv)
        ddy[:6] = 0.3 * chance.normal(size=6)
        np.testing.assert_allclose(A @ ddy[:6] + b, legs(y, dy, ddy)[2][legs.columns], atol=1e-3)


@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0, 0.0, 0.0, 0.0), (0.2, 0.3, 0.2, 1.0, 0.5, 1.0)])
def test_a_target_out_of_reach_takes_the_pelvis_no_farther_than_the_legs(robot, direction):
    limits = Limits.of(robot)
    reference = LiveReference(robot, limits)
    legs = 6 + np.array(robot.groups["legs"])
    target, velocity = reference.rest.copy(), np.zeros(robot.nv)
    for k in range(160):
        velocity[:6] = (-0.2 if k < 60 else 0.8) * np.array(direction)
        target += 0.01 * velocity
        reference.advance(target, velocity)
        y, dy, _ = reference.joints(reference.horizon)
        assert (y[legs - 6] < robot.upper[legs - 6]).all() and (y[legs - 6] > robot.lower[legs - 6]).all()
        assert (np.abs(dy[legs - 6]) < robot.velocity[legs - 6]).all()
        assert foot_error(robot, reference.now) < 1e-3
    assert np.linalg.norm(reference.now[:6] - reference.rest[:6]) > 0.03


def test_legs_that_are_led_have_their_feet_where_and_as_fast_as_they_are_led(robot):
    (phase,) = planted_phases(robot, 1.0)
    rest = from_configuration(robot.rest[None])[0]
    legs, data = LedLegs(robot, phase, rest), robot.model.createData()
    still = Pose(np.zeros(3), np.eye(3), np.zeros(6), np.zeros(6))
    places = {foot: pose.translation.copy() for foot, pose in phase.feet.items()}
    velocity, acceleration = np.array([0.3, 0.02, 0.2, 0.0, 0.0, 0.1]), np.array([1.0, 0.2, -0.5, 0.0, 0.0, 0.3])
    for k in range(30):
        led = {foot: still._replace(position=place) for foot, place in places.items()}
        up = places["left_foot"] + 0.002 * k * np.array([1.0, 0.0, 1.0])
        led["left_foot"] = Pose(up, np.eye(3), velocity, acceleration)
        legs.lead(led)
        y, dy, ddy = legs(rest, np.zeros(robot.nv), np.zeros(robot.nv))
    assert [legs.columns[k] - 6 in robot.groups["right_leg"] for k in range(len(legs.columns))] == legs.stand.tolist()
    q, v, a = pinocchio_state(y, dy, ddy)
    pin.forwardKinematics(robot.model, data, q, v, a)
    for foot, pose in led.items():
        frame = robot.point(foot)
        place = pin.updateFramePlacement(robot.model, data, frame)
        moves = pin.getFrameVelocity(robot.model, data, frame, pin.LOCAL_WORLD_ALIGNED).vector
        speeds_up = pin.getFrameClassicalAcceleration(robot.model, data, frame, pin.LOCAL_WORLD_ALIGNED).vector
        np.testing.assert_allclose(place.translation, pose.position, atol=1e-3)
        np.testing.assert_allclose(moves, pose.velocity, atol=1e-2)
        np.testing.assert_allclose(speeds_up, pose.acceleration, atol=0.1)
