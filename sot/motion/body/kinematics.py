"""Residuals of a robot's points and their Jacobians along a motion, in the coordinates of `coordinates`.

All configurations are evaluated at once, joint by joint, with arrays over time: a clip has thousands of them, and one
call each from Python would cost more than the arithmetic. A joint is evaluated when something first asks for it.
"""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.motion.body.coordinates import to_rotation
from sot.robots.robot import Robot

Array = NDArray[np.float64]

BASE = 1  # the joint of the floating base
SMALL_ANGLE = 1e-4  # rad, below which the series of the logarithm's derivative is exact to double precision


class JointTree:
    """Constants of a robot's tree of joints; every joint but the base turns about one axis.

    Attributes:
        model: Pinocchio's.
        fixed, sine, versine: joint -> (3, 3); their sum, weighted by 1, sin θ and 1 - cos θ, is the joint's rotation in
            its parent (Rodrigues' formula behind the placement).
        axis: joint -> (3,) unit vector in the joint's own frame.
        mass: joint -> mass of the body and of all that hangs off it [kg].
    """

    def __init__(self, robot: Robot):
        self.model = model = robot.model
        data = model.createData()
        pin.computeJointJacobians(model, data, pin.neutral(model))
        self.fixed, self.sine, self.versine, self.axis = {}, {}, {}, {}
        for j in range(BASE + 1, model.njoints):
            axis = data.oMi[j].rotation.T @ data.J[3:, model.joints[j].idx_v]
            placement, turn = model.jointPlacements[j].rotation, pin.skew(axis)
            self.axis[j] = axis
            self.fixed[j], self.sine[j], self.versine[j] = placement, placement @ turn, placement @ turn @ turn
        self.mass = [inertia.mass for inertia in model.inertias]
        for j in range(model.njoints - 1, BASE, -1):
            self.mass[model.parents[j]] += self.mass[j]


class Kinematics:
    """Forward kinematics and Jacobians of a robot at n configurations.

    Args:
        tree: of the robot.
        y: (n, nv) coordinates (see coordinates).
        columns: (s,) indices into y: Jacobians (n, 3, s) are with respect to these; none where only poses are asked.
    """

    def __init__(self, tree: JointTree, y: Array, columns: NDArray[np.int_] | Sequence[int] = ()):
        self._tree, self._model, self._y = tree, tree.model, y
        self._slot_of_column = {int(column): slot for slot, column in enumerate(columns)}
        rotation, yaw, nought = to_rotation(y[:, 3:6]), y[:, 5], np.zeros(len(y))
        # of roll, pitch and yaw: X of the base, Y turned by the yaw alone, Z of the world
        self._base_axes = (
            rotation[:, :, 0],
            np.column_stack([-np.sin(yaw), np.cos(yaw), nought]),
            np.column_stack([nought, nought, nought + 1.0]),
        )
        self._poses = {BASE: (rotation, y[:, :3])}
        self._axes_of_joint: dict[int, list[tuple[int, Array, Array]]] = {}
        self._origins: dict[int, tuple[Array, Array]] = {}

    def frame_pose(self, frame: int) -> tuple[Array, Array]:
        """Rotation (n, 3, 3) and position (n, 3) of a frame in the world."""
        return self._frame_rotation(frame), self._frame_origin(frame)[0]

    def position_residual(self, frame: int, wanted: Array, offset: Array | None = None) -> tuple[Array, Array]:
        """Error (n, 3) of a frame's position against a wanted one, (n, 3) or (3,) [m], and its Jacobian.

        offset: (3,) of the point meant from the frame's origin, in the frame [m]; none unless given.
        """
        place, J = self._frame_origin(frame)
        if offset is not None:
            place = place + self._frame_rotation(frame) @ offset
            J = self.point_jacobian(self._model.frames[frame].parentJoint, place)
        return place - wanted, J

    def orientation_residual(self, frame: int, wanted: Array) -> tuple[Array, Array]:
        """Rotation vectors (n, 3) from wanted orientations, (n, 3, 3) or (3, 3), to a frame's, Ramos (24)-(27), and
        their Jacobian."""
        error = Rotation.from_matrix(self._frame_rotation(frame) @ np.swapaxes(wanted, -1, -2)).as_rotvec()
        J = np.zeros((len(error), 3, len(self._slot_of_column)))
        for slot, axis, _ in self._rotation_axes(self._model.frames[frame].parentJoint):
            J[:, :, slot] = axis
        return error, _log_derivative(error) @ J

    def direction_residual(self, start: int, end: int, wanted: Array) -> tuple[Array, Array]:
        """Error (n, 3) of the direction between two frames against wanted unit vectors (n, 3), and its Jacobian."""
        (near, J_near), (far, J_far) = self._frame_origin(start), self._frame_origin(end)
        along, J = far - near, J_far - J_near
        length = np.linalg.norm(along, axis=1, keepdims=True)
        along = along / length
        J = J / length[:, :, None]
        return along - wanted, J - along[:, :, None] * (along[:, None] @ J)

    def com(self) -> tuple[Array, Array]:
        """Centre of mass (n, 3) [m] and its Jacobian (n, 3, s)."""
        model, total = self._model, self._tree.mass[BASE]
        moments: dict[int, Array] = {}  # joint -> (n, 3) mass times CoM of the body and of all that hangs off it
        for j in range(BASE, model.njoints):
            rotation, position = self._joint_pose(j)
            inertia = model.inertias[j]
            moments[j] = inertia.mass * (position + rotation @ inertia.lever)
        for j in range(model.njoints - 1, BASE, -1):
            moments[model.parents[j]] += moments[j]
        J = self._translations()
        for j in range(BASE, model.njoints):
            lever = (moments[j] - self._tree.mass[j] * self._joint_pose(j)[1]) / total
            for column, axis in self._own_axes(j):
                J[:, :, self._slot_of_column[column]] = _cross(axis, lever)
        return moments[BASE] / total, J

    def point_jacobian(self, joint: int, place: Array) -> Array:
        """Jacobian (n, 3, s) of points at world positions (n, 3) that move with a joint."""
        J = self._translations()
        for slot, axis, origin in self._rotation_axes(joint):
            J[:, :, slot] = _cross(axis, place - origin)
        return J

    def _frame_rotation(self, frame: int) -> Array:
        about = self._model.frames[frame]
        return self._joint_pose(about.parentJoint)[0] @ about.placement.rotation

    def _frame_origin(self, frame: int) -> tuple[Array, Array]:
        """Position (n, 3) of a frame in the world, and its Jacobian; directions share them."""
        if frame not in self._origins:
            about = self._model.frames[frame]
            rotation, position = self._joint_pose(about.parentJoint)
            place = position + rotation @ about.placement.translation
            self._origins[frame] = place, self.point_jacobian(about.parentJoint, place)
        return self._origins[frame]

    def _joint_pose(self, joint: int) -> tuple[Array, Array]:
        """Rotation (n, 3, 3) and position (n, 3) of a joint in the world, behind its own turn."""
        if joint not in self._poses:
            chains, model = self._tree, self._model
            rotation, position = self._joint_pose(model.parents[joint])
            angle = self._y[:, model.joints[joint].idx_v, None, None]
            own = chains.fixed[joint] + np.sin(angle) * chains.sine[joint] + (1 - np.cos(angle)) * chains.versine[joint]
            self._poses[joint] = rotation @ own, position + rotation @ model.jointPlacements[joint].translation
        return self._poses[joint]

    def _own_axes(self, joint: int) -> list[tuple[int, Array]]:
        """Columns that turn a joint itself, each with its axis (n, 3) in the world."""
        if joint == BASE:
            return [(3 + i, axis) for i, axis in enumerate(self._base_axes) if 3 + i in self._slot_of_column]
        column = self._model.joints[joint].idx_v
        return [(column, self._joint_pose(joint)[0] @ self._tree.axis[joint])] if column in self._slot_of_column else []

    def _rotation_axes(self, joint: int) -> list[tuple[int, Array, Array]]:
        """Rotations that move a joint, its own and those above it: slot, axis (n, 3) and origin (n, 3) of each."""
        if joint not in self._axes_of_joint:
            self._axes_of_joint[joint] = [
                (self._slot_of_column[column], axis, self._joint_pose(j)[1])
                for j in list(self._model.supports[joint])[BASE:]
                for column, axis in self._own_axes(j)
            ]
        return self._axes_of_joint[joint]

    def _translations(self) -> Array:
        """Jacobian (n, 3, s) of a point that only the base's translation moves."""
        J = np.zeros((len(self._y), 3, len(self._slot_of_column)))
        for i in range(3):
            if i in self._slot_of_column:
                J[:, i, self._slot_of_column[i]] = 1.0
        return J


def _cross(a: Array, b: Array) -> Array:
    """Cross products (n, 3); numpy's own function would double the time of a fit."""
    c = np.empty_like(a)
    c[:, 0] = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    c[:, 1] = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    c[:, 2] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return c


def _log_derivative(turn: Array) -> Array:
    """(n, 3, 3) matrices that turn a world angular velocity into the rate of the rotation vector (n, 3).

    I - [w]/2 + (1 - θ/2 cot θ/2)/θ² [w]², the inverse of the left Jacobian of SO(3).
    """
    angle = np.linalg.norm(turn, axis=1)
    half = 0.5 * np.maximum(angle, SMALL_ANGLE)
    factor = np.where(angle < SMALL_ANGLE, 1.0 / 12.0, (1.0 - half / np.tan(half)) / (4.0 * half**2))
    skew = np.zeros((len(turn), 3, 3))
    skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0] = turn.T
    skew[:, 1, 2], skew[:, 2, 0], skew[:, 0, 1] = -turn.T
    return np.eye(3) - 0.5 * skew + factor[:, None, None] * (skew @ skew)
