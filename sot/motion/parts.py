"""The parts of a body that are fitted on their own, each with what it is asked to do: Ramos (20) with weights.

A weight is the inverse of the error that one is ready to accept, so that metres and radians compare.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.contacts import Phase
from sot.motion.human import SEGMENTS
from sot.motion.kinematics import Kinematics, unit
from sot.motion.stance import Build
from sot.motion.targets import Targets
from sot.robot import Robot

Array = NDArray[np.float64]

FOOT = 1.0 / 0.0001  # 1/m and 1/rad
COM = 1.0 / 0.0003  # 1/m
PLACE = 1.0 / 0.05  # 1/m, of the hips where no CoM is asked for
HEIGHT = 1.0 / 0.05  # 1/m, of the hips
PELVIS = 1.0 / np.array([0.3, 0.3, 0.1])  # 1/rad, tilted and turned
TRUNK = 1.0 / 0.05
CHEST = 1.0 / 0.15
SEGMENT = 1.0 / 0.05  # of the head, upper arms and forearms
FACE = 1.0 / 0.15  # the head's orientation
POSTURE = 1.0 / 2.0  # 1/rad, of what the directions leave free: the twist of a straight arm
NO_LEVER = 1e-6  # m, a joint whose axis passes a point this close does not move it


class Part(Protocol):
    """Some coordinates and their residuals.

    `evaluate` writes the weighted errors e (rows,) at knot k for coordinates y (nv,) and their Jacobian J (rows, s)
    with respect to the columns of y that the part moves.
    """

    columns: Array
    rows: int

    def evaluate(self, k: int, y: Array, e: Array, J: Array) -> None: ...


class Body:
    """Base, legs and chest: feet that stay, then the CoM (or the hips), then the pelvis and the trunk."""

    rows = 24

    def __init__(self, robot: Robot, build: Build, targets: Targets, phase: Phase, com: Array | None = None):
        """com: (T, 2) horizontal CoM to follow [m]; without it the hips follow the human's."""
        joints = robot.groups["legs"] + robot.groups["chest"]
        self.columns = np.array([*range(6), *(6 + np.sort(joints))])
        self._kinematics = Kinematics(robot, self.columns)
        self._full = np.zeros((self.rows, robot.nv))
        self._targets, self._com, self._hips = targets, com, build.hips
        self._waist, self._chest, self._neck = (robot.point(point) for point in ("waist", "chest", "neck"))
        self._feet = [(robot.point(foot), pose.translation, pose.rotation) for foot, pose in phase.feet.items()]

    def evaluate(self, k: int, y: Array, e: Array, J: Array) -> None:
        kinematics, wanted, full = self._kinematics, self._targets, self._full
        kinematics.at(y)
        row = 0
        for frame, place, rotation in self._feet:
            _put(e, full, row, FOOT, kinematics.position(frame, place))
            _put(e, full, row + 3, FOOT, kinematics.orientation(frame, rotation))
            row += 6
        waist, J_waist = kinematics.frame(self._waist)
        arm = waist.rotation @ self._hips
        J_hips = J_waist[:3] - pin.skew(arm) @ J_waist[3:]
        hips = waist.translation + arm - wanted.hips[k]
        if self._com is None:
            _put(e, full, row, PLACE, (hips[:2], J_hips[:2]))
        else:
            com, J_com = kinematics.com()
            _put(e, full, row, COM, (com[:2] - self._com[k], J_com[:2]))
        _put(e, full, row + 2, HEIGHT, (hips[2:], J_hips[2:]))
        tilt, J_tilt = kinematics.orientation(self._waist, wanted.frames["pelvis"][k])
        _put(e, full, row + 3, 1.0, (PELVIS * tilt, PELVIS[:, None] * J_tilt))
        _put(e, full, row + 6, TRUNK, kinematics.direction(self._waist, self._neck, wanted.directions["trunk"][k]))
        _put(e, full, row + 9, CHEST, kinematics.orientation(self._chest, wanted.frames["chest"][k]))
        J[:] = kinematics.in_coordinates(full)


class Limb:
    """A chain that hangs off the chest, in a model of its own that knows nothing else, so that it is evaluated fast.

    Targets are turned into the chest's frame once, for the orientations (T, 3, 3) that the chest has.
    """

    def __init__(self, robot: Robot, columns: Array, chest: Array):
        model = robot.model
        moving = {model.names[j] for j in range(2, model.njoints) if model.joints[j].idx_v in columns}
        locked = [j for j in range(1, model.njoints) if model.names[j] not in moving]
        self.columns = columns
        self._model = pin.buildReducedModel(model, locked, pin.neutral(model))
        self._data = self._model.createData()
        self._names = {point: model.frames[frame].name for point, frame in robot.points.items()}
        pin.framesForwardKinematics(self._model, self._data, pin.neutral(self._model))
        fixed = self._data.oMf[self._frame("chest")].rotation
        self._turn = fixed @ chest.transpose(0, 2, 1)

    def _frame(self, point: str) -> int:
        return self._model.getFrameId(self._names[point])

    def _direction_targets(self, directions: Array) -> Array:
        return np.einsum("tij,tj->ti", self._turn, directions)

    def _segment(self, near: int, far: int) -> tuple[Array, Array]:
        """Unit vector (3,) between two frames and its Jacobian (3, s)."""
        model, data, axes = self._model, self._data, pin.LOCAL_WORLD_ALIGNED
        way = data.oMf[far].translation - data.oMf[near].translation
        J = pin.getFrameJacobian(model, data, far, axes)[:3] - pin.getFrameJacobian(model, data, near, axes)[:3]
        return unit(way, J)


class Head(Limb):
    """The neck: where the head points, and where it looks."""

    rows = 6

    def __init__(self, robot: Robot, targets: Targets, chest: Array):
        super().__init__(robot, 6 + np.sort(robot.groups["head"]), chest)
        self._near, self._far = (self._frame(point) for point in SEGMENTS["head"])
        self._pointing = self._direction_targets(targets.directions["head"])
        self._facing = self._turn @ targets.frames["head"]

    def evaluate(self, k: int, y: Array, e: Array, J: Array) -> None:
        pin.computeJointJacobians(self._model, self._data, y[self.columns])
        pin.updateFramePlacements(self._model, self._data)
        along, J_along = self._segment(self._near, self._far)
        _put(e, J, 0, SEGMENT, (along - self._pointing[k], J_along))
        error = pin.log3(self._data.oMf[self._near].rotation @ self._facing[k].T)
        turning = pin.getFrameJacobian(self._model, self._data, self._near, pin.LOCAL_WORLD_ALIGNED)[3:]
        _put(e, J, 3, FACE, (error, pin.Jlog3(pin.exp3(-error)) @ turning))


class Arm(Limb):
    """Shoulder and elbow: directions of upper arm and forearm; the joints they leave free stay near rest."""

    def __init__(self, robot: Robot, side: str, targets: Targets, chest: Array):
        wrist = robot.point(f"{side}_wrist")
        super().__init__(robot, _moving(robot, wrist, robot.groups[f"{side}_arm"]), chest)
        self.rows = 6 + len(self.columns)
        self._rest = robot.rest[1 + self.columns]
        self._posture = POSTURE * np.eye(len(self.columns))
        self._points = [self._frame(f"{side}_{joint}") for joint in ("shoulder", "elbow", "wrist")]
        self._wanted = [self._direction_targets(targets.directions[f"{side}_{s}"]) for s in ("upper_arm", "forearm")]

    def evaluate(self, k: int, y: Array, e: Array, J: Array) -> None:
        x = y[self.columns]
        model, data, axes = self._model, self._data, pin.LOCAL_WORLD_ALIGNED
        pin.computeJointJacobians(model, data, x)
        places = [pin.updateFramePlacement(model, data, point).translation for point in self._points]
        jacobians = [pin.getFrameJacobian(model, data, point, axes)[:3] for point in self._points]
        for i in range(2):
            along, J_along = unit(places[i + 1] - places[i], jacobians[i + 1] - jacobians[i])
            _put(e, J, 3 * i, SEGMENT, (along - self._wanted[i][k], J_along))
        e[6:] = POSTURE * (x - self._rest)
        J[6:] = self._posture


def _moving(robot: Robot, frame: int, joints: Sequence[int]) -> Array:
    """Those of the joints, as columns of y, that move the origin of a frame."""
    middle = np.concatenate([robot.rest[:7], 0.5 * (robot.lower + robot.upper)])
    J = pin.computeFrameJacobian(robot.model, robot.model.createData(), middle, frame, pin.LOCAL)
    return np.array([6 + j for j in sorted(joints) if np.abs(J[:3, 6 + j]).max() > NO_LEVER])


def _put(e: Array, J: Array, row: int, weight: float, residual: tuple[Array, Array]) -> None:
    error, jacobian = residual
    stop = row + len(error)
    e[row:stop] = weight * error
    J[row:stop] = weight * jacobian
