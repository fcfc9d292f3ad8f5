"""Legs that go with the pelvis: the feet stay, and legs that were led beyond their reach come back."""

import numpy as np
import pinocchio as pin
import pytest

from sot.live.planted_legs import PlantedLegs
from sot.live.reference import LiveReference
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
    legs, still = PlantedLegs(robot, phase, rest), np.zeros(robot.nv)
    for shift in (*np.linspace(0.0, 1.0, 40), *np.linspace(1.0, 0.0, 40)):
        y = rest.copy()
        y[:6] += shift * np.array([0.1, 0.05, 0.15, -0.2, 0.3, 0.9])
        y, _, _ = legs(y, still, still)
        joints = y[6:]
        assert (joints >= robot.lower - 1e-9).all() and (joints <= robot.upper + 1e-9).all()
    assert foot_error(robot, y) < 1e-3


def test_a_person_who_jumps_does_not_take_the_pelvis_beyond_the_legs(robot):
    reference = LiveReference(robot, Limits.of(robot))
    target, velocity = reference.rest.copy(), np.zeros(robot.nv)
    for k in range(160):
        target[2] += -0.002 if k < 60 else 0.008
        velocity[2] = -0.2 if k < 60 else 0.8
        reference.advance(target, velocity)
        assert reference.now[2] < reference._legs.greatest_height(reference.now) + 0.003
    assert reference.now[2] > reference.rest[2]
    assert foot_error(robot, reference.now) < 2e-3
