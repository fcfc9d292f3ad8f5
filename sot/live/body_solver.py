"""Inverse kinematics of one moment: base, legs, chest and head, from where they were a moment ago."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from solvers.compiled import compiled
from sot.control.pose import Pose
from sot.control.quantities.points_motion import PointsMotion, pose_errors, turn_between
from sot.live.bounded_move import bounded_move
from sot.live.placement import MomentTargets
from sot.live.state import coordinate_columns, pinocchio_state
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
Indices = NDArray[np.int_]

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
        self._feet = tuple(phase.feet)
        points = [*self._feet, "waist", "neck", "chest", *(SEGMENTS["head"] if robot.groups["head"] else ())]
        self._points = PointsMotion(robot.model, [robot.point(point) for point in points], self.data)
        self._positions = np.array([pose.translation for pose in phase.feet.values()])
        self._rotations = np.array([pose.rotation for pose in phase.feet.values()])
        joints = (*robot.groups["legs"], *robot.groups["chest"], *robot.groups["head"])
        self._columns = np.array([*range(6), *(6 + np.sort(np.array(joints, dtype=int)))])
        self.head_columns = 6 + np.sort(np.array(robot.groups["head"], dtype=int))
        self._has_head = bool(robot.groups["head"])

    def put_feet(self, poses: Mapping[str, Pose]) -> None:
        """Say where the feet are from now on."""
        self._positions = np.array([poses[foot].position for foot in self._feet])
        self._rotations = np.array([poses[foot].rotation for foot in self._feet])

    def solve(self, wanted: MomentTargets, y: Array) -> Array:
        """Coordinates (nv,) that meet the targets, from those of the moment before; the arms stay as they are."""
        return self._improved(wanted, y, self._columns)

    def solve_head(self, wanted: MomentTargets, y: Array) -> Array:
        """Coordinates (nv,) of which those of the head meet its targets on a trunk as it is in y."""
        return self._improved(wanted, y, self.head_columns) if self._has_head else y

    def _improved(self, wanted: MomentTargets, y: Array, columns: Indices) -> Array:
        """Coordinates (nv,) of which some were moved by bounded Gauss-Newton steps."""
        y = y.copy()
        lower, upper = self._limits.lower[columns], self._limits.upper[columns]
        frames, directions, points = wanted.frames, wanted.directions, self._points
        turned = np.array([frames["pelvis"], frames["chest"], frames["head"] if self._has_head else np.eye(3)])
        along = np.array([directions["trunk"], directions["head"] if self._has_head else np.zeros(3)])
        for _ in range(GAUSS_NEWTON_STEPS):
            points.place(pinocchio_state(y, y, y)[0])
            J = coordinate_columns(points.jacobian, y)
            poses = points.positions, points.rotations, self._positions, self._rotations
            e, J = _weighted_residuals(J, *poses, self._hips, wanted.hips, turned, along, columns)
            H, g = J.T @ J + GAUSS_NEWTON_DAMPING * np.eye(len(columns)), J.T @ e
            x = y[columns]
            bounded_move(x, H, g, lower, upper)
            y[columns] = x
        return y

    def place(self, y: Array) -> pin.Data:
        """Pinocchio's data with all joints placed at coordinates (nv,)."""
        pin.forwardKinematics(self._model, self.data, pinocchio_state(y, y, y)[0])
        return self.data


@compiled
def _weighted_residuals(
    J: Array,
    positions: Array,
    rotations: Array,
    feet: Array,
    feet_turned: Array,
    hips: Array,
    hips_wanted: Array,
    turned: Array,
    along: Array,
    columns: Indices,
) -> tuple[Array, Array]:
    """Residuals (m,) and their Jacobian on some columns (m, c).

    Args:
        J: of the feet, waist, neck, chest, and the head's ends if there is one: n points, one after the other
            (6 n, nv).
        positions, rotations: of these (n, 3), (n, 3, 3).
        feet, feet_turned: where the feet are to be (f, 3), (f, 3, 3).
        hips: the middle of the hips in the waist's frame (3,), and where it is wanted.
        turned: rotations that pelvis, chest and head are to have (3, 3, 3).
        along: directions that trunk and head are to have (2, 3).
        columns: of J that count.
    """
    count = len(feet)
    waist, neck, chest, near, far = count, count + 1, count + 2, count + 3, count + 4
    has_head = far < len(positions)
    rows = 6 * count + (18 if has_head else 12)
    e, A = np.empty(rows), np.empty((rows, len(columns)))
    e[: 6 * count] = FOOT_WEIGHT * pose_errors(positions[:count], rotations[:count], feet, feet_turned)
    for i in range(6 * count):
        for c in range(len(columns)):
            A[i, c] = FOOT_WEIGHT * J[i, columns[c]]
    row, lever = 6 * count, np.zeros(3)
    for i in range(3):
        for k in range(3):
            lever[i] += rotations[waist, i, k] * hips[k]
    for i in range(3):
        weight = HIP_HEIGHT_WEIGHT_STANDING if i == 2 else HIP_PLACE_WEIGHT
        e[row + i] = weight * (positions[waist, i] + lever[i] - hips_wanted[i])
        one, other = (i + 1) % 3, (i + 2) % 3
        for c in range(len(columns)):
            k = columns[c]
            carried = J[6 * waist + 3 + one, k] * lever[other] - J[6 * waist + 3 + other, k] * lever[one]
            A[row + i, c] = weight * (J[6 * waist + i, k] + carried)
    row += 3
    _write_turn(J, rotations, waist, turned[0], PELVIS_WEIGHT, columns, e, A, row)
    _write_direction(J, positions, waist, neck, along[0], TRUNK_WEIGHT, columns, e, A, row + 3)
    _write_turn(J, rotations, chest, turned[1], np.full(3, CHEST_WEIGHT), columns, e, A, row + 6)
    if has_head:
        _write_direction(J, positions, near, far, along[1], SEGMENT_WEIGHT, columns, e, A, row + 9)
        _write_turn(J, rotations, near, turned[2], np.full(3, HEAD_ORIENTATION_WEIGHT), columns, e, A, row + 12)
    return e, A


@compiled
def _write_turn(
    J: Array,
    rotations: Array,
    point: int,
    wanted: Array,
    weights: Array,
    columns: Indices,
    e: Array,
    A: Array,
    row: int,
) -> None:
    """Write three rows: how far a point is turned from what is wanted (3, 3)."""
    e[row : row + 3] = weights * turn_between(rotations[point], wanted)
    for i in range(3):
        for c in range(len(columns)):
            A[row + i, c] = weights[i] * J[6 * point + 3 + i, columns[c]]


@compiled
def _write_direction(
    J: Array,
    positions: Array,
    start: int,
    end: int,
    wanted: Array,
    weight: float,
    columns: Indices,
    e: Array,
    A: Array,
    row: int,
) -> None:
    """Write three rows: how far the direction from a point to another one is off a unit vector (3,)."""
    unit = positions[end] - positions[start]
    length = np.sqrt(unit[0] ** 2 + unit[1] ** 2 + unit[2] ** 2)
    unit = unit / length
    for i in range(3):
        e[row + i] = weight * (unit[i] - wanted[i])
    for c in range(len(columns)):
        k, lengthening = columns[c], 0.0
        for i in range(3):
            A[row + i, c] = J[6 * end + i, k] - J[6 * start + i, k]
            lengthening += unit[i] * A[row + i, c]
        for i in range(3):
            A[row + i, c] = weight * (A[row + i, c] - unit[i] * lengthening) / length
