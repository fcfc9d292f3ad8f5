import numpy as np
import pinocchio as pin
import pytest

from sot.motion.body.coordinates import to_configuration
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.robots.robot import Robot

STEP = 1e-6


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def postures(robot):
    rng = np.random.default_rng(0)
    return np.hstack([rng.uniform(-0.5, 0.5, (3, 6)), rng.uniform(robot.lower, robot.upper, (3, robot.na))])


def residual(name, robot, y, columns):
    kinematics = Kinematics(JointTree(robot), y, columns)
    if name == "com":
        return kinematics.com()
    if name == "position":
        return kinematics.position_residual(robot.point("left_foot"), np.ones(3))
    if name == "offset position":
        return kinematics.position_residual(robot.point("right_wrist"), np.ones(3), offset=np.array([0.1, -0.2, 0.3]))
    if name == "orientation":
        return kinematics.orientation_residual(robot.point("head"), pin.rpy.rpyToMatrix(0.3, -0.4, 0.5))
    return kinematics.direction_residual(robot.point("waist"), robot.point("left_wrist"), np.array([0.0, 0.0, 1.0]))


def test_poses_are_those_of_pinocchio(robot, postures):
    kinematics, data = Kinematics(JointTree(robot), postures), robot.model.createData()
    com, _ = kinematics.com()
    for k, q in enumerate(to_configuration(postures)):
        pin.framesForwardKinematics(robot.model, data, q)
        for frame in robot.points.values():
            rotation, position = kinematics.frame_pose(frame)
            np.testing.assert_allclose(rotation[k], data.oMf[frame].rotation, atol=1e-12)
            np.testing.assert_allclose(position[k], data.oMf[frame].translation, atol=1e-12)
        np.testing.assert_allclose(com[k], pin.centerOfMass(robot.model, data, q), atol=1e-12)


@pytest.mark.parametrize("columns", [range(36), range(6, 20), [3, 7, 30]])
@pytest.mark.parametrize("name", ["com", "position", "offset position", "orientation", "direction"])
def test_jacobians_against_finite_differences(robot, postures, columns, name):
    _, J = residual(name, robot, postures, columns)
    difference = np.empty_like(J)
    for i, column in enumerate(columns):
        step = STEP * np.eye(robot.nv)[column]
        before, after = (residual(name, robot, postures + sign * step, columns)[0] for sign in (-1, 1))
        difference[:, :, i] = (after - before) / (2 * STEP)
    np.testing.assert_allclose(J, difference, atol=1e-6)


@pytest.mark.parametrize("angle", [0.0, 1e-7, 0.99e-4, 1.01e-4])
def test_orientation_has_its_jacobian_near_the_target(robot, angle):
    y = np.zeros((1, robot.nv))
    y[0, 3] = angle
    error, J = Kinematics(JointTree(robot), y, [3, 4, 5]).orientation_residual(robot.point("waist"), np.eye(3))
    np.testing.assert_allclose(error, [[angle, 0.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(J[0], np.eye(3), atol=1e-4)


def test_orientation_error_is_the_angle_of_the_paper(robot):
    y = np.zeros((1, robot.nv))
    y[0, 3:6] = 0.2, -0.3, 1.0
    error, _ = Kinematics(JointTree(robot), y).orientation_residual(robot.point("waist"), np.eye(3))
    R = pin.rpy.rpyToMatrix(y[0, 3:6])
    sine = 0.5 * np.sqrt((R[0, 1] - R[1, 0]) ** 2 + (R[0, 2] - R[2, 0]) ** 2 + (R[1, 2] - R[2, 1]) ** 2)
    assert np.linalg.norm(error) == pytest.approx(np.arctan2(sine, 0.5 * (np.trace(R) - 1.0)))
