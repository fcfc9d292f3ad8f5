"""The parts of a body that are fitted on their own, each with its residuals: Ramos (20) with weights.

A weight is the inverse of an acceptable error, so that metres and radians compare.
"""

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.targets import Targets
from sot.motion.feet.stance import Build
from sot.motion.feet.swing import FootPath, any_foot_moves
from sot.motion.human.human import SEGMENTS
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

FOOT_WEIGHT = 1.0 / 0.0001  # 1/m and 1/rad
ACCEPTED_SWING_TILT = 0.05  # rad, of a foot in the middle of a swing, and as much again where it yields
ACCEPTED_YIELD = 0.004  # m, off its path, of a foot that yields
COM_WEIGHT_STANDING, COM_WEIGHT_STEPPING = 1.0 / 0.0003, 1.0 / 0.00005  # 1/m: support is scarce where feet step
HIP_PLACE_WEIGHT = 1.0 / 0.05  # 1/m, of the hips' horizontal place, where there is no CoM to follow
HIP_HEIGHT_WEIGHT_STANDING, HIP_HEIGHT_WEIGHT_STEPPING = 1.0 / 0.05, 1.0 / 0.01  # 1/m
PELVIS_WEIGHT = 1.0 / np.array([0.3, 0.3, 0.1])  # 1/rad, about the world's x, y and z
TRUNK_WEIGHT = 1.0 / 0.05
CHEST_WEIGHT = 1.0 / 0.15
SEGMENT_WEIGHT = 1.0 / 0.05  # of the directions of head, upper arms and forearms
HEAD_ORIENTATION_WEIGHT = 1.0 / 0.15  # of the head's orientation
FREE_FOOT_WEIGHT = 1.0 / 0.3  # 1/rad, of the orientation of a foot in the air
POSTURE_WEIGHT = 1.0 / 2.0  # 1/rad, of an arm's joints, for what the directions leave free: the twist of a straight arm
MIN_LEVER = 1e-6  # m, distance from its axis below which a joint does not move a point


class Part(Protocol):
    """Part of the coordinates, with its residuals.

    `evaluate` gives the weighted errors (n, rows) at n knots (indices) for coordinates y (n, nv) and their Jacobians
    (n, rows, s) with respect to the columns of y that the part moves.
    """

    columns: Indices

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]: ...


class Body:
    """Base, legs and chest, which place the feet, then the CoM (or the hips), then pelvis and trunk."""

    def __init__(
        self, robot: Robot, build: Build, targets: Targets, feet: Mapping[str, FootPath], com: Array | None = None
    ):
        """com: (T, 2) horizontal CoM to follow [m]; without it the hips follow the human's."""
        joints = robot.groups["legs"] + robot.groups["chest"]
        self.columns: Indices = np.array([*range(6), *(6 + np.sort(joints))])
        self._chains = JointTree(robot)
        self._targets, self._com, self._hips = targets, com, build.hips
        self._waist, self._chest, self._neck = (robot.point(point) for point in ("waist", "chest", "neck"))
        steps = any_foot_moves(feet)
        self._com_weight = COM_WEIGHT_STEPPING if steps else COM_WEIGHT_STANDING
        own_height_weight = HIP_HEIGHT_WEIGHT_STEPPING if steps else HIP_HEIGHT_WEIGHT_STANDING
        self._height = own_height_weight if targets.height is None else 1.0 / targets.height
        self._feet = [(robot.point(foot), path) for foot, path in feet.items()]

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        wanted, kinematics = self._targets, Kinematics(self._chains, y, self.columns)
        hips, J_hips = kinematics.position_residual(self._waist, wanted.hips[knots], offset=self._hips)
        if self._com is None:
            place = HIP_PLACE_WEIGHT, hips[:, :2], J_hips[:, :2]
        else:
            com, J_com = kinematics.com()
            place = self._com_weight, com[:, :2] - self._com[knots], J_com[:, :2]
        tilt, J_tilt = kinematics.orientation_residual(self._waist, wanted.frames["pelvis"][knots])
        feet = []
        for foot, path in self._feet:
            free, yielding = path.free[knots, None], path.yielding[knots, None]
            near = FOOT_WEIGHT / (1.0 + FOOT_WEIGHT * ACCEPTED_YIELD * yielding)
            level = FOOT_WEIGHT / (1.0 + FOOT_WEIGHT * ACCEPTED_SWING_TILT * (free + yielding))
            off, J_off = kinematics.position_residual(foot, path.position[knots])
            turn, J_turn = kinematics.orientation_residual(foot, path.rotation[knots])
            feet += [(1.0, near * off, near[:, None] * J_off), (1.0, level * turn, level[:, None] * J_turn)]
        return _stacked_residuals(
            *feet,
            place,
            (self._height, hips[:, 2:], J_hips[:, 2:]),
            (1.0, PELVIS_WEIGHT * tilt, PELVIS_WEIGHT[:, None] * J_tilt),
            (TRUNK_WEIGHT, *kinematics.direction_residual(self._waist, self._neck, wanted.directions["trunk"][knots])),
            (CHEST_WEIGHT, *kinematics.orientation_residual(self._chest, wanted.frames["chest"][knots])),
        )


class Head:
    """The neck, which points the head and turns its face."""

    def __init__(self, robot: Robot, targets: Targets):
        self.columns: Indices = 6 + np.sort(np.array(robot.groups["head"], dtype=int))
        self._chains, self._targets = JointTree(robot), targets
        self._near, self._far = (robot.point(point) for point in SEGMENTS["head"])

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        wanted, kinematics = self._targets, Kinematics(self._chains, y, self.columns)
        return _stacked_residuals(
            (SEGMENT_WEIGHT, *kinematics.direction_residual(self._near, self._far, wanted.directions["head"][knots])),
            (HEAD_ORIENTATION_WEIGHT, *kinematics.orientation_residual(self._near, wanted.frames["head"][knots])),
        )


class Arm:
    """Shoulder and elbow, which follow the directions of upper arm and forearm; joints left free stay near rest."""

    def __init__(self, robot: Robot, side: str, targets: Targets):
        self.columns: Indices = _moving_columns(robot, robot.point(f"{side}_wrist"), robot.groups[f"{side}_arm"])
        self._chains = JointTree(robot)
        self._rest = robot.rest[1 + self.columns]
        self._segments = [
            (robot.point(near), robot.point(far), targets.directions[segment])
            for segment in (f"{side}_upper_arm", f"{side}_forearm")
            for near, far in (SEGMENTS[segment],)
        ]

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        kinematics, size = Kinematics(self._chains, y, self.columns), len(self.columns)
        return _stacked_residuals(
            *(
                (SEGMENT_WEIGHT, *kinematics.direction_residual(near, far, way[knots]))
                for near, far, way in self._segments
            ),
            (POSTURE_WEIGHT, y[:, self.columns] - self._rest, np.broadcast_to(np.eye(size), (len(y), size, size))),
        )


class Leg:
    """Hip, knee and ankle of a leg in the air, which follow the directions of thigh and shank, and how its foot is
    turned."""

    def __init__(self, robot: Robot, side: str, directions: Mapping[str, Array], foot: Array):
        """directions: segment -> (T, 3) unit vectors; foot: (T, 3, 3) orientation of its frame."""
        self.columns: Indices = 6 + np.sort(np.array(robot.groups[f"{side}_leg"], dtype=int))
        self._chains, self._foot, self._turned = JointTree(robot), robot.point(f"{side}_foot"), foot
        self._segments = [
            (robot.point(near), robot.point(far), directions[segment])
            for segment in (f"{side}_thigh", f"{side}_shank")
            for near, far in (SEGMENTS[segment],)
        ]

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        kinematics = Kinematics(self._chains, y, self.columns)
        return _stacked_residuals(
            *(
                (SEGMENT_WEIGHT, *kinematics.direction_residual(near, far, way[knots]))
                for near, far, way in self._segments
            ),
            (FREE_FOOT_WEIGHT, *kinematics.orientation_residual(self._foot, self._turned[knots])),
        )


def _moving_columns(robot: Robot, frame: int, joints: Sequence[int]) -> Indices:
    """Columns of y of the joints that move the origin of a frame."""
    middle = np.concatenate([robot.rest[:7], 0.5 * (robot.lower + robot.upper)])
    J = pin.computeFrameJacobian(robot.model, robot.model.createData(), middle, frame, pin.LOCAL)
    return np.array([6 + j for j in sorted(joints) if np.abs(J[:3, 6 + j]).max() > MIN_LEVER], dtype=int)


def _stacked_residuals(*residuals: tuple[float, Array, Array]) -> tuple[Array, Array]:
    """Residuals, each a weight, errors (n, r) and their Jacobians (n, r, s), as errors and Jacobians of all rows."""
    errors = np.concatenate([weight * error for weight, error, _ in residuals], axis=1)
    return errors, np.concatenate([weight * jacobian for weight, _, jacobian in residuals], axis=1)
