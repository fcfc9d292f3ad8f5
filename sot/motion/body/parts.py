"""The parts of a body that are fitted on their own, each with what it is asked to do: Ramos (20) with weights.

A weight is the inverse of the error that one is ready to accept, so that metres and radians compare.
"""

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.body.kinematics import Chains, Kinematics
from sot.motion.body.targets import Targets
from sot.motion.feet.stance import Build
from sot.motion.feet.swing import FootPath, moving
from sot.motion.human.human import SEGMENTS
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

FOOT = 1.0 / 0.0001  # 1/m and 1/rad
COM = {False: 1.0 / 0.0003, True: 1.0 / 0.00005}  # 1/m, on feet that stand or step: stepping, support is scarce
PLACE = 1.0 / 0.05  # 1/m, of the hips where no CoM is asked for
HEIGHT = {False: 1.0 / 0.05, True: 1.0 / 0.01}  # 1/m, of the hips
PELVIS = 1.0 / np.array([0.3, 0.3, 0.1])  # 1/rad, tilted and turned
TRUNK = 1.0 / 0.05
CHEST = 1.0 / 0.15
SEGMENT = 1.0 / 0.05  # of the head, upper arms and forearms
FACE = 1.0 / 0.15  # the head's orientation
POSTURE = 1.0 / 2.0  # 1/rad, of what the directions leave free: the twist of a straight arm
NO_LEVER = 1e-6  # m, a joint whose axis passes a point this close does not move it


class Part(Protocol):
    """Some coordinates and their residuals.

    `evaluate` gives the weighted errors (n, rows) at n knots (indices) for coordinates y (n, nv) and their Jacobians
    (n, rows, s) with respect to the columns of y that the part moves.
    """

    columns: Indices

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]: ...


class Body:
    """Base, legs and chest: the feet, then the CoM (or the hips), then the pelvis and the trunk."""

    def __init__(
        self, robot: Robot, build: Build, targets: Targets, feet: Mapping[str, FootPath], com: Array | None = None
    ):
        """com: (T, 2) horizontal CoM to follow [m]; without it the hips follow the human's."""
        joints = robot.groups["legs"] + robot.groups["chest"]
        self.columns: Indices = np.array([*range(6), *(6 + np.sort(joints))])
        self._chains = Chains(robot)
        self._targets, self._com, self._hips = targets, com, build.hips
        self._waist, self._chest, self._neck = (robot.point(point) for point in ("waist", "chest", "neck"))
        self._steps = moving(feet)
        self._height = HEIGHT[self._steps] if targets.height is None else 1.0 / targets.height
        self._feet = [(robot.point(foot), path) for foot, path in feet.items()]

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        wanted, kinematics = self._targets, Kinematics(self._chains, y, self.columns)
        hips, J_hips = kinematics.position(self._waist, wanted.hips[knots], offset=self._hips)
        if self._com is None:
            place = PLACE, hips[:, :2], J_hips[:, :2]
        else:
            com, J_com = kinematics.com()
            place = COM[self._steps], com[:, :2] - self._com[knots], J_com[:, :2]
        tilt, J_tilt = kinematics.orientation(self._waist, wanted.frames["pelvis"][knots])
        feet = [
            (FOOT, *residual)
            for foot, path in self._feet
            for residual in (
                kinematics.position(foot, path.position[knots]),
                kinematics.orientation(foot, path.rotation[knots]),
            )
        ]
        return _weighted(
            *feet,
            place,
            (self._height, hips[:, 2:], J_hips[:, 2:]),
            (1.0, PELVIS * tilt, PELVIS[:, None] * J_tilt),
            (TRUNK, *kinematics.direction(self._waist, self._neck, wanted.directions["trunk"][knots])),
            (CHEST, *kinematics.orientation(self._chest, wanted.frames["chest"][knots])),
        )


class Head:
    """The neck: where the head points, and where it looks."""

    def __init__(self, robot: Robot, targets: Targets):
        self.columns: Indices = 6 + np.sort(np.array(robot.groups["head"], dtype=int))
        self._chains, self._targets = Chains(robot), targets
        self._near, self._far = (robot.point(point) for point in SEGMENTS["head"])

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        wanted, kinematics = self._targets, Kinematics(self._chains, y, self.columns)
        return _weighted(
            (SEGMENT, *kinematics.direction(self._near, self._far, wanted.directions["head"][knots])),
            (FACE, *kinematics.orientation(self._near, wanted.frames["head"][knots])),
        )


class Arm:
    """Shoulder and elbow: directions of upper arm and forearm; the joints they leave free stay near rest."""

    def __init__(self, robot: Robot, side: str, targets: Targets):
        self.columns: Indices = _moving(robot, robot.point(f"{side}_wrist"), robot.groups[f"{side}_arm"])
        self._chains = Chains(robot)
        self._rest = robot.rest[1 + self.columns]
        self._segments = [
            (robot.point(near), robot.point(far), targets.directions[segment])
            for segment in (f"{side}_upper_arm", f"{side}_forearm")
            for near, far in (SEGMENTS[segment],)
        ]

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        kinematics, size = Kinematics(self._chains, y, self.columns), len(self.columns)
        return _weighted(
            *((SEGMENT, *kinematics.direction(near, far, way[knots])) for near, far, way in self._segments),
            (POSTURE, y[:, self.columns] - self._rest, np.broadcast_to(np.eye(size), (len(y), size, size))),
        )


def _moving(robot: Robot, frame: int, joints: Sequence[int]) -> Indices:
    """Those of the joints, as columns of y, that move the origin of a frame."""
    middle = np.concatenate([robot.rest[:7], 0.5 * (robot.lower + robot.upper)])
    J = pin.computeFrameJacobian(robot.model, robot.model.createData(), middle, frame, pin.LOCAL)
    return np.array([6 + j for j in sorted(joints) if np.abs(J[:3, 6 + j]).max() > NO_LEVER], dtype=int)


def _weighted(*residuals: tuple[float, Array, Array]) -> tuple[Array, Array]:
    """Residuals, each a weight, errors (n, r) and their Jacobians (n, r, s), as errors and Jacobians of all rows."""
    errors = np.concatenate([weight * error for weight, error, _ in residuals], axis=1)
    return errors, np.concatenate([weight * jacobian for weight, _, jacobian in residuals], axis=1)
