"""Inverse kinematics of one moment: base, legs, chest and head, from where they were a moment ago."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.control.pose import Pose
from sot.live.bounded_move import bounded_move
from sot.live.placement import MomentTargets
from sot.live.state import pinocchio_state
from sot.motion.body.coordinates import rate_matrix, to_rotation
from sot.motion.body.limits import Limits
from sot.motion.body.parts import (
    CHEST_WEIGHT,
    FOOT_WEIGHT,
    HEAD_ORIENTATION_WEIGHT,
    HIP_HEIGHT_WEIGHT_STANDING,
    HIP_PLACE_WEIGHT,
    PELVIS_WEIGHT,
    SEGMENT_WEIGHT,
    TRUNK_WEIGHT,
)
from sot.motion.body.retarget import GAUSS_NEWTON_DAMPING
from sot.motion.feet.contacts import planted_phases
from sot.motion.feet.stance import Build
from sot.motion.human.human import SEGMENTS
from sot.robots.robot import Robot

Array = NDArray[np.float64]

GAUSS_NEWTON_STEPS = 2
"""Steps a moment: the one before is near."""


class BodySolver:
    """Bounded Gauss-Newton steps on the residuals of `parts.Body` and `parts.Head`, over feet that stay unless put.

    Of the batch code for whole clips one frame takes 24 ms; this takes Pinocchio's Jacobians, which are compiled.

    Args:
        robot: who follows.
        build: its sizes.
        limits: range of the coordinates y of `sot.motion.body.coordinates`.

    Attributes:
        head_columns: of the head's joints in the coordinates.
    """

    def __init__(self, robot: Robot, build: Build, limits: Limits) -> None:
        self._model, self.data = robot.model, robot.model.createData()
        self._limits, self._hips = limits, build.hips
        (phase,) = planted_phases(robot, 1.0)
        self._frames = {foot: robot.point(foot) for foot in phase.feet}
        self._feet = [(robot.point(foot), pose.translation, pose.rotation) for foot, pose in phase.feet.items()]
        self._waist, self._neck, self._chest = (robot.point(point) for point in ("waist", "neck", "chest"))
        self._head = tuple(robot.point(point) for point in SEGMENTS["head"])
        joints = (*robot.groups["legs"], *robot.groups["chest"], *robot.groups["head"])
        self._columns = np.array([*range(6), *(6 + np.sort(np.array(joints, dtype=int)))])
        self.head_columns = 6 + np.sort(np.array(robot.groups["head"], dtype=int))
        self._has_head = bool(robot.groups["head"])

    def put_feet(self, poses: Mapping[str, Pose]) -> None:
        """Say where the feet are from now on."""
        self._feet = [(self._frames[foot], pose.position, pose.rotation) for foot, pose in poses.items()]

    def solve(self, wanted: MomentTargets, y: Array) -> Array:
        """Coordinates (nv,) that meet the targets, from those of the moment before; the arms stay as they are."""
        return self._improved(wanted, y, self._columns)

    def solve_head(self, wanted: MomentTargets, y: Array) -> Array:
        """Coordinates (nv,) of which those of the head meet its targets on a trunk as it is in y."""
        return self._improved(wanted, y, self.head_columns) if self._has_head else y

    def _improved(self, wanted: MomentTargets, y: Array, columns: NDArray[np.int_]) -> Array:
        """Coordinates (nv,) of which some were moved by bounded Gauss-Newton steps."""
        y = y.copy()
        lower, upper = self._limits.lower[columns], self._limits.upper[columns]
        for _ in range(GAUSS_NEWTON_STEPS):
            e, J = self._residuals(wanted, y, columns)
            H, g = J.T @ J + GAUSS_NEWTON_DAMPING * np.eye(len(columns)), J.T @ e
            x = y[columns]
            bounded_move(x, H, g, lower, upper)
            y[columns] = x
        return y

    def place(self, y: Array) -> pin.Data:
        """Pinocchio's data with all joints placed at coordinates (nv,)."""
        pin.forwardKinematics(self._model, self.data, pinocchio_state(y, y, y)[0])
        return self.data

    def _residuals(self, wanted: MomentTargets, y: Array, columns: NDArray[np.int_]) -> tuple[Array, Array]:
        pin.computeJointJacobians(self._model, self.data, pinocchio_state(y, y, y)[0])
        pin.updateFramePlacements(self._model, self.data)
        base, rates = to_rotation(y[None, 3:6])[0], rate_matrix(y[None, 3:6])[0]

        def jacobian(frame: int) -> Array:
            J = pin.getFrameJacobian(self._model, self.data, frame, pin.LOCAL_WORLD_ALIGNED)
            J[:, :3] = J[:, :3] @ base.T
            J[:, 3:6] = J[:, 3:6] @ rates
            return J[:, columns]

        place = self.data.oMf
        rows: list[tuple[Array | float, Array, Array]] = []
        for foot, position, rotation in self._feet:
            J = jacobian(foot)
            rows.append((FOOT_WEIGHT, place[foot].translation - position, J[:3]))
            rows.append((FOOT_WEIGHT, pin.log3(place[foot].rotation @ rotation.T), J[3:]))
        J_waist, lever = jacobian(self._waist), place[self._waist].rotation @ self._hips
        weights = np.array([HIP_PLACE_WEIGHT, HIP_PLACE_WEIGHT, HIP_HEIGHT_WEIGHT_STANDING])
        hips = place[self._waist].translation + lever
        rows.append((weights, hips - wanted.hips, J_waist[:3] - pin.skew(lever) @ J_waist[3:]))
        tilt = pin.log3(place[self._waist].rotation @ wanted.frames["pelvis"].T)
        rows.append((PELVIS_WEIGHT, tilt, J_waist[3:]))
        J_neck = jacobian(self._neck)
        trunk = place[self._neck].translation - place[self._waist].translation
        rows.append((TRUNK_WEIGHT, *_direction(trunk, J_neck[:3] - J_waist[:3], wanted.directions["trunk"])))
        turn = pin.log3(place[self._chest].rotation @ wanted.frames["chest"].T)
        rows.append((CHEST_WEIGHT, turn, jacobian(self._chest)[3:]))
        if self._has_head:
            near, far = self._head
            J_near = jacobian(near)
            along = place[far].translation - place[near].translation
            turn = pin.log3(place[near].rotation @ wanted.frames["head"].T)
            rows.append((SEGMENT_WEIGHT, *_direction(along, jacobian(far)[:3] - J_near[:3], wanted.directions["head"])))
            rows.append((HEAD_ORIENTATION_WEIGHT, turn, J_near[3:]))
        e = np.concatenate([weight * error for weight, error, _ in rows])
        return e, np.concatenate([np.reshape(weight, (-1, 1)) * J for weight, _, J in rows])


def _direction(along: Array, J: Array, wanted: Array) -> tuple[Array, Array]:
    """Error (3,) of a vector's direction against a unit vector, and its Jacobian from that of the vector."""
    length = float(np.linalg.norm(along))
    unit = along / length
    return unit - wanted, (J - np.outer(unit, unit @ J)) / length
