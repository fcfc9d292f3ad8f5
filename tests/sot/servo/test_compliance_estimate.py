"""Estimated compliance of feet against the one that made the readings."""

import numpy as np
import pinocchio as pin
import pytest

from sot.gravity import GRAVITY
from sot.hardware.compliance import bush_position
from sot.hardware.readings import Readings
from sot.robots.robot import Robot
from sot.servo.compliance_estimate import ComplianceEstimate

SOFT = np.array([1 / 1500.0, 1 / 2500.0])


def estimate(sway, noise=0.0, ticks=400):
    """Compliance found on a robot that sways on its bushes; the moments about them sway by `sway` m g l."""
    robot, rng = Robot.load("hrp2"), np.random.default_rng(2)
    bushes = {foot: bush_position(robot, foot) for foot in robot.feet}
    found = ComplianceEstimate(robot, 0.8, bushes)
    weight, q, data = robot.mass * GRAVITY, robot.rest.copy(), robot.model.createData()
    compliance = np.zeros(3)
    for k in range(ticks):
        phase = 0.05 * k
        moment = sway * weight * 0.8 * np.array([np.sin(phase), np.cos(0.7 * phase)])
        tilt = -SOFT * moment + [0.004, -0.002]  # and a floor that is not level
        turn = pin.exp3(np.append(tilt, 0.0))
        q[:7] = pin.SE3ToXYZQUAT(pin.SE3(turn, np.zeros(3)) * pin.XYZQUATToSE3(robot.rest[:7]))
        pin.framesForwardKinematics(robot.model, data, q)
        imu = pin.Quaternion(data.oMf[robot.point("waist")].rotation)
        force = np.array([0.0, 0.0, 0.5 * weight])
        wrenches = {}
        for foot in robot.feet:
            own = data.oMf[robot.point(foot)].rotation.T @ np.append(moment, 0.0) + np.cross(bushes[foot], force)
            wrenches[foot] = np.concatenate([force, own]) + noise * rng.normal(size=6)
        compliance = found(Readings(0.0, q[7:], 0.0 * q[7:], imu.coeffs(), *np.zeros((2, 3)), wrenches))
    return compliance


def test_it_tends_to_what_the_feet_have():
    np.testing.assert_allclose(estimate(0.2)[:2], SOFT, rtol=0.03)
    np.testing.assert_allclose(estimate(0.2, noise=2.0)[:2], SOFT, rtol=0.1)


def test_a_robot_that_hardly_moves_leaves_it_in_doubt_and_never_too_soft():
    found = estimate(0.005)
    assert (found[:2] < 0.2 * SOFT).all() and (found >= 0.0).all() and found[2] == 0.0


@pytest.mark.parametrize("ticks", [1, 2])
def test_it_starts_rigid(ticks):
    np.testing.assert_allclose(estimate(0.2, ticks=ticks)[:2], 0.0, atol=0.3 * SOFT.min())
