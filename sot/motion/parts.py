"""The parts of a body that are fitted on their own, each with what it is asked to do: Ramos (20) with weights.

A weight is the inverse of the error that one is ready to accept, so that metres and radians compare.
"""

from typing import Protocol

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.contacts import Phase
from sot.motion.human import SEGMENTS
from sot.motion.kinematics import Kinematics
from sot.motion.stance import Build
from sot.motion.targets import Targets
from sot.robot import Robot

Array = NDArray[np.float64]

FOOT = 1.0 / 0.0005  # 1/m and 1/rad
COM = 1.0 / 0.001  # 1/m
PLACE = 1.0 / 0.05  # 1/m, of the hips where no CoM is asked for
HEIGHT = 1.0 / 0.05  # 1/m, of the hips
PELVIS = 1.0 / 0.3  # 1/rad
TRUNK = 1.0 / 0.05
CHEST = 1.0 / 0.15
SEGMENT = 1.0 / 0.05  # of the head, upper arms and forearms
FACE = 1.0 / 0.1  # the head's orientation
POSTURE = 1.0 / 2.0  # of joints that leave no trace in what is asked


class Part(Protocol):
    """Some coordinates and their residuals.

    `fill` writes weighted errors e (rows,) at knot k, the kinematics being evaluated, and their Jacobian J (rows, nv) with
    respect to Pinocchio's velocities.
    """

    columns: Array
    rows: int

    def fill(self, kinematics: Kinematics, k: int, e: Array, J: Array) -> None: ...


class Body:
    """Base, legs and chest: feet that stay, then the CoM (or the hips), then the pelvis and the trunk."""

    rows = 24

    def __init__(self, robot: Robot, build: Build, targets: Targets, phase: Phase, com: Array | None = None):
        """com: (T, 2) horizontal CoM to follow [m]; without it the hips follow the human's."""
        joints = robot.groups["legs"] + robot.groups["chest"]
        self.columns = np.array([*range(6), *(6 + np.sort(joints))])
        self._targets, self._com, self._hips = targets, com, build.hips
        self._waist, self._chest, self._neck = (robot.point(point) for point in ("waist", "chest", "neck"))
        self._feet = [(robot.point(foot), pose.translation, pose.rotation) for foot, pose in phase.feet.items()]

    def fill(self, kinematics: Kinematics, k: int, e: Array, J: Array) -> None:
        wanted = self._targets
        row = 0
        for frame, place, rotation in self._feet:
            _put(e, J, row, FOOT, kinematics.position(frame, place))
            _put(e, J, row + 3, FOOT, kinematics.orientation(frame, rotation))
            row += 6
        waist = kinematics.placement(self._waist)
        arm = waist.rotation @ self._hips
        J_waist = kinematics.jacobian(self._waist)
        J_hips = J_waist[:3] - pin.skew(arm) @ J_waist[3:]
        hips = waist.translation + arm - wanted.hips[k]
        if self._com is None:
            _put(e, J, row, PLACE, (hips[:2], J_hips[:2]))
        else:
            com, J_com = kinematics.com()
            _put(e, J, row, COM, (com[:2] - self._com[k], J_com[:2]))
        _put(e, J, row + 2, HEIGHT, (hips[2:], J_hips[2:]))
        _put(e, J, row + 3, PELVIS, kinematics.orientation(self._waist, wanted.frames["pelvis"][k]))
        _put(e, J, row + 6, TRUNK, kinematics.direction(self._waist, self._neck, wanted.directions["trunk"][k]))
        _put(e, J, row + 9, CHEST, kinematics.orientation(self._chest, wanted.frames["chest"][k]))


class Head:
    """The neck: where the head points, and where it looks."""

    rows = 6

    def __init__(self, robot: Robot, targets: Targets):
        self.columns = 6 + np.sort(robot.groups["head"])
        self._targets = targets
        self._near, self._far = (robot.point(point) for point in SEGMENTS["head"])

    def fill(self, kinematics: Kinematics, k: int, e: Array, J: Array) -> None:
        wanted = self._targets
        _put(e, J, 0, SEGMENT, kinematics.direction(self._near, self._far, wanted.directions["head"][k]))
        _put(e, J, 3, FACE, kinematics.orientation(self._near, wanted.frames["head"][k]))


class Arm:
    """Shoulder and elbow: directions of upper arm and forearm; the joints they leave free stay near rest."""

    def __init__(self, robot: Robot, side: str, targets: Targets):
        upper, lower = SEGMENTS[f"{side}_upper_arm"], SEGMENTS[f"{side}_forearm"]
        supports = robot.model.supports[robot.model.frames[robot.point(lower[1])].parentJoint]
        moving = {robot.model.joints[joint].idx_v for joint in supports if joint > 1}
        self.columns = np.array([6 + j for j in sorted(robot.groups[f"{side}_arm"]) if 6 + j in moving])
        self.rows = 6 + len(self.columns)
        self.rest = robot.rest[1 + self.columns]
        self._upper = [robot.point(point) for point in upper]
        self._lower = [robot.point(point) for point in lower]
        self._wanted_upper = targets.directions[f"{side}_upper_arm"]
        self._wanted_lower = targets.directions[f"{side}_forearm"]

    def fill(self, kinematics: Kinematics, k: int, e: Array, J: Array) -> None:
        _put(e, J, 0, SEGMENT, kinematics.direction(*self._upper, self._wanted_upper[k]))
        _put(e, J, 3, SEGMENT, kinematics.direction(*self._lower, self._wanted_lower[k]))
        e[6:] = POSTURE * (kinematics.joints(self.columns) - self.rest)
        J[6 + np.arange(len(self.columns)), self.columns] = POSTURE


def _put(e: Array, J: Array, row: int, weight: float, residual: tuple[Array, Array]) -> None:
    error, jacobian = residual
    stop = row + len(error)
    e[row:stop] = weight * error
    J[row:stop] = weight * jacobian
