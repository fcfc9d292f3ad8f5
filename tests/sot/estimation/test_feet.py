"""Where the sole of a compliant foot is, by the force above it."""

import numpy as np
import pinocchio as pin
import pytest

from sot.estimation.feet import Bush
from sot.hardware.compliance import FootCompliance, bush_position
from sot.robots.robot import Robot


def test_a_sole_turns_about_its_bush_by_the_moment_above_it_and_comes_to_rest_there():
    robot, compliance = Robot.load("hrp2"), FootCompliance(2000.0, 3000.0, 2e5)
    foot, relaxation = robot.feet[0], compliance.relaxation_time(robot)
    bush, at = Bush(robot, foot, compliance), bush_position(robot, foot)
    rng = np.random.default_rng(2)
    wrench = np.concatenate([rng.uniform(-40, 40, 2), [300.0], rng.uniform(-20, 20, 3)])
    moment = wrench[3:] - np.cross(at, wrench[:3])
    at_rest = np.array([moment[0] / 2000.0, moment[1] / 3000.0, 300.0 / 2e5])
    pose = pin.SE3.Random()
    for passed, share in ((relaxation, 1.0 - np.exp(-1.0)), (100.0 * relaxation, 1.0)):
        position, rotation = pose.translation.copy(), pose.rotation.copy()
        bush.lower(position, rotation, wrench, passed)
        roll, pitch, height = share * at_rest
        about = pin.SE3(np.eye(3), at)
        turned = pin.SE3(pin.rpy.rpyToMatrix(roll, 0.0, 0.0) @ pin.rpy.rpyToMatrix(0.0, pitch, 0.0), np.zeros(3))
        sole = pose * pin.SE3(np.eye(3), np.array([0.0, 0.0, height])) * about * turned * about.inverse()
        assert bush.deflection == pytest.approx(share * at_rest, rel=1e-9)
        np.testing.assert_allclose(position, sole.translation, atol=1e-12)
        np.testing.assert_allclose(rotation, sole.rotation, atol=1e-12)
