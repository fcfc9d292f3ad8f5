import numpy as np
import pinocchio as pin
import pytest

from sot.motion.kinematics import Kinematics
from sot.robot import Robot

STEP = 1e-6


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def residuals(kinematics, robot, y):
    kinematics.at(y)
    turn = pin.rpy.rpyToMatrix(0.3, -0.4, 0.5)
    return {
        "com": kinematics.com(),
        "position": kinematics.position(robot.point("left_foot"), np.ones(3)),
        "orientation": kinematics.orientation(robot.point("head"), turn),
        "direction": kinematics.direction(robot.point("waist"), robot.point("left_wrist"), np.array([0.0, 0.0, 1.0])),
    }


@pytest.mark.parametrize("columns", [range(36), range(6, 20), [3, 7, 30]])
@pytest.mark.parametrize("name", ["com", "position", "orientation", "direction"])
def test_jacobians_against_finite_differences(robot, columns, name):
    rng = np.random.default_rng(0)
    kinematics = Kinematics(robot, list(columns))
    y = np.concatenate([rng.uniform(-0.5, 0.5, 6), rng.uniform(robot.lower, robot.upper)])
    J = kinematics.in_coordinates(residuals(kinematics, robot, y)[name][1].copy())
    difference = np.empty_like(J)
    for i, column in enumerate(columns):
        dy = np.zeros(robot.nv)
        dy[column] = STEP
        before, after = (residuals(kinematics, robot, y + sign * dy)[name][0] for sign in (-1, 1))
        difference[:, i] = (after - before) / (2 * STEP)
    np.testing.assert_allclose(J, difference, atol=1e-6)


def test_orientation_error_is_the_angle_of_the_paper(robot):
    kinematics = Kinematics(robot, [6])
    y = np.zeros(robot.nv)
    y[3:6] = 0.2, -0.3, 1.0
    kinematics.at(y)
    error, _ = kinematics.orientation(robot.point("waist"), np.eye(3))
    R = pin.rpy.rpyToMatrix(y[3:6])
    sine = 0.5 * np.sqrt((R[0, 1] - R[1, 0]) ** 2 + (R[0, 2] - R[2, 0]) ** 2 + (R[1, 2] - R[2, 1]) ** 2)
    assert np.linalg.norm(error) == pytest.approx(np.arctan2(sine, 0.5 * (np.trace(R) - 1.0)))
