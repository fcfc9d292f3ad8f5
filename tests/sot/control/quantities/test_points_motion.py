"""The motion of points is Pinocchio's own of the same frames."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.quantities.points_motion import PointsMotion, pose_errors
from sot.robots.robot import Robot

AXES = pin.LOCAL_WORLD_ALIGNED


@pytest.mark.parametrize("name", ["hrp2", "g1"])
def test_places_jacobians_and_drifts_are_pinocchios(name):
    robot, chance = Robot.load(name), np.random.default_rng(3)
    frames = [robot.point(point) for point in ("left_foot", "chest", "right_wrist")]
    points, data = PointsMotion(robot.model, frames, robot.model.createData()), robot.model.createData()
    for _ in range(3):
        q = pin.integrate(robot.model, robot.rest, 0.4 * chance.normal(size=robot.nv))
        v = chance.normal(size=robot.nv)
        for _ in range(2):  # the second time nothing is computed anew
            points.place(q)
            points.move(v)
        pin.computeJointJacobians(robot.model, data, q)
        pin.forwardKinematics(robot.model, data, q, v, np.zeros(robot.nv))
        for k, frame in enumerate(frames):
            place, own = pin.updateFramePlacement(robot.model, data, frame), slice(6 * k, 6 * k + 6)
            np.testing.assert_allclose(points.positions[k], place.translation, atol=1e-12)
            np.testing.assert_allclose(points.rotations[k], place.rotation, atol=1e-12)
            jacobian = pin.getFrameJacobian(robot.model, data, frame, AXES)
            np.testing.assert_allclose(points.jacobian[own], jacobian, atol=1e-12)
            drift = pin.getFrameClassicalAcceleration(robot.model, data, frame, AXES).vector
            np.testing.assert_allclose(points.drift[own], drift, atol=1e-10)


def test_errors_of_poses_are_the_ways_between_them():
    chance = np.random.default_rng(4)
    places, turned = chance.normal(size=(3, 3)), np.array([pin.exp3(chance.normal(size=3)) for _ in range(3)])
    ways, turns = chance.normal(size=(3, 3)), chance.normal(size=(3, 3))
    moved = np.array([pin.exp3(turn) @ R for turn, R in zip(turns, turned, strict=True)])
    errors = pose_errors(places + ways, moved, places, turned).reshape(3, 6)
    np.testing.assert_allclose(errors, np.hstack([ways, turns]), atol=1e-9)
