"""Residuals of a robot's points and their Jacobians, in the coordinates that motions are fitted in."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.robot import Robot

Array = NDArray[np.float64]


class Kinematics:
    """Evaluates one configuration at a time. Jacobians have all nv columns and Pinocchio's velocities, until
    `in_coordinates` turns them into those of coordinates y (see coordinates).

    Args:
        robot: whose points.
        columns: indices into y (nv) that may move.
    """

    def __init__(self, robot: Robot, columns: Sequence[int] | NDArray[np.int_]):
        self.robot = robot
        self.columns = np.array(columns)
        self._model, self._data = robot.model, robot.model.createData()
        self._q = np.empty(robot.nq)
        self._frames: dict[int, tuple[pin.SE3, Array]] = {}

    def at(self, y: Array) -> None:
        """Evaluate the coordinates y (nv,) from now on."""
        q = self._q
        self._rpy = y[3:6]
        q[:3], q[3:7], q[7:] = y[:3], pin.Quaternion(pin.rpy.rpyToMatrix(self._rpy)).coeffs(), y[6:]
        pin.computeJointJacobians(self._model, self._data, q)
        self._frames.clear()

    def in_coordinates(self, J: Array) -> Array:
        """Jacobian (n, s) with respect to the chosen coordinates, from one (n, nv); overwrites it."""
        J[:, :3] = J[:, :3] @ self._data.oMi[1].rotation.T
        J[:, 3:6] = J[:, 3:6] @ pin.rpy.computeRpyJacobian(self._rpy, pin.LOCAL)
        return J[:, self.columns]

    def frame(self, frame: int) -> tuple[pin.SE3, Array]:
        """Pose of a frame in the world, and its Jacobian (6, nv), linear over angular, in world axes."""
        if frame not in self._frames:
            pose = pin.updateFramePlacement(self._model, self._data, frame)
            J = pin.getFrameJacobian(self._model, self._data, frame, pin.LOCAL_WORLD_ALIGNED)
            self._frames[frame] = pose, J
        return self._frames[frame]

    def com(self) -> tuple[Array, Array]:
        """CoM (3,) and its Jacobian (3, nv)."""
        J = pin.jacobianCenterOfMass(self._model, self._data, self._q)
        return self._data.com[0].copy(), J

    def position(self, frame: int, wanted: Array) -> tuple[Array, Array]:
        """Error (3,) of a frame's position against a wanted one [m], and its Jacobian."""
        pose, J = self.frame(frame)
        return pose.translation - wanted, J[:3]

    def orientation(self, frame: int, wanted: Array) -> tuple[Array, Array]:
        """Rotation vector (3,) from a wanted orientation (3, 3) to a frame's, Ramos (24)-(27), and its Jacobian."""
        pose, J = self.frame(frame)
        error = pin.log3(pose.rotation @ wanted.T)
        return error, pin.Jlog3(pin.exp3(-error)) @ J[3:]

    def direction(self, start: int, end: int, wanted: Array) -> tuple[Array, Array]:
        """Error (3,) of the direction between two frames against a wanted unit vector (3,), and its Jacobian."""
        (near, J_near), (far, J_far) = self.frame(start), self.frame(end)
        along, J = unit(far.translation - near.translation, J_far[:3] - J_near[:3])
        return along - wanted, J


def unit(way: Array, J: Array) -> tuple[Array, Array]:
    """A vector (3,) made a unit vector, and so its Jacobian (3, n)."""
    length = np.sqrt(way @ way)
    along = way / length
    J = J / length
    return along, J - along[:, None] * (along @ J)
