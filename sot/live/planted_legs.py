"""Legs that go with the pelvis while the feet stay where they are."""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.live.state import pinocchio_state
from sot.motion.body.coordinates import to_rotation
from sot.motion.feet.contacts import Phase
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot
from sot.robots.size import leg_length

Array = NDArray[np.float64]

DAMPING = 1e-4
"""Of the inverse of the legs' Jacobian, for a leg that is nearly straight."""
MAX_LEG_EXTENSION = 0.965
"""Share of its length to which a leg is stretched at most: a straight one can no longer push, and jerks."""
MAX_NEWTON_STEP = 0.1
"""Bound of a joint's correction in one step [rad]."""


class PlantedLegs:
    """Replaces the legs' part of a motion by what keeps the feet in place.

    A pelvis and legs that are governed each by itself contradict each other, and the angular momentum of that is
    nobody's. With feet at rest, J v = 0 and J a + J̇ v = 0 give the legs' velocities and accelerations from the rest.

    Args:
        robot: who stands.
        phase: where its feet are.
        start: coordinates (nv,) to start from.
    """

    def __init__(self, robot: Robot, phase: Phase, start: Array) -> None:
        self._model, self._data = robot.model, robot.model.createData()
        self._feet = [(robot.point(foot), pose) for foot, pose in phase.feet.items()]
        self._joints = np.array(robot.groups["legs"], dtype=int)
        self._columns = 6 + self._joints
        self._lower, self._upper = robot.lower[self._joints], robot.upper[self._joints]
        self._angles = start[self._columns]
        pin.framesForwardKinematics(robot.model, self._data, robot.rest)
        place = {point: self._data.oMf[robot.point(point)].translation.copy() for point in robot.points}
        base = self._data.oMi[1]
        self._hips = np.array([base.actInv(place[f"{side}_hip"]) for side in SIDES])
        self._ankles = np.array([place[f"{side}_ankle"] for side in SIDES])
        rest = np.array([np.linalg.norm(place[f"{side}_hip"] - place[f"{side}_ankle"]) for side in SIDES])
        self._reach = np.maximum(rest, MAX_LEG_EXTENSION * leg_length(robot))

    def greatest_height(self, y: Array) -> float:
        """Greatest height of the base [m] from which both legs reach, turned and placed as in coordinates (nv,)."""
        hips = self._hips @ to_rotation(y[None, 3:6])[0].T
        away = y[:2] + hips[:, :2] - self._ankles[:, :2]
        drop = np.sqrt(np.maximum(self._reach**2 - np.sum(away**2, axis=1), 0.0))
        return float(np.min(self._ankles[:, 2] + drop - hips[:, 2]))

    def __call__(self, y: Array, dy: Array, ddy: Array) -> tuple[Array, Array, Array]:
        """Coordinates and derivatives (nv,) with such legs, whose angles follow from those of the last call."""
        model, data, legs = self._model, self._data, self._columns
        y, dy, ddy = y.copy(), dy.copy(), ddy.copy()
        y[legs] = self._angles
        q, v, a = pinocchio_state(y, dy, ddy)
        v[legs], a[legs] = 0.0, 0.0
        pin.computeJointJacobians(model, data, q)
        J = np.vstack([pin.getFrameJacobian(model, data, foot, pin.LOCAL_WORLD_ALIGNED) for foot, _ in self._feet])
        own = J[:, legs]
        inverse = np.linalg.solve(own.T @ own + DAMPING * np.eye(len(legs)), own.T)
        error = np.concatenate([self._error(foot, pose) for foot, pose in self._feet])
        step = np.clip(-inverse @ error, -MAX_NEWTON_STEP, MAX_NEWTON_STEP)
        self._angles = np.clip(self._angles + step, self._lower, self._upper)
        v[legs] = -inverse @ (J @ v)
        pin.forwardKinematics(model, data, q, v, a)
        moved = [
            pin.getFrameClassicalAcceleration(model, data, foot, pin.LOCAL_WORLD_ALIGNED).vector
            for foot, _ in self._feet
        ]
        y[legs], dy[legs], ddy[legs] = self._angles, v[legs], -inverse @ np.concatenate(moved)
        return y, dy, ddy

    def _error(self, foot: int, pose: pin.SE3) -> Array:
        place = pin.updateFramePlacement(self._model, self._data, foot)
        return np.concatenate([place.translation - pose.translation, pin.log3(place.rotation @ pose.rotation.T)])
