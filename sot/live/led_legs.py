"""Legs that go with the pelvis while the feet stay where they are, or go where they are led."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.control.pose import Pose
from sot.live.bounded_move import bounded_move
from sot.live.state import pinocchio_state
from sot.motion.body.coordinates import rate_matrix, to_rotation
from sot.motion.feet.contacts import Phase
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot

Array = NDArray[np.float64]

DAMPING = 1e-4
"""Of the inverse of the legs' Jacobian, for a leg that is nearly straight."""
GAUSS_NEWTON_STEPS, MAX_GAUSS_NEWTON_STEPS = 1, 8
"""Steps a moment, and while the feet are farther off than `MAX_FOOT_ERROR`."""
MAX_FOOT_ERROR = 0.01
"""Length of the error of both feet [m, rad] beyond which legs are solved for from their posture at the start, too.
Where the pelvis goes too far, they end up at the ends of their ranges, and do not come back from there alone."""


class LedLegs:
    """Replaces the legs' part of a motion by what has the feet where they are to be.

    A pelvis and legs that are governed each by itself contradict each other, and the angular momentum of that is
    nobody's. With feet that move with v_f and a_f, J v = v_f and J a + J̇ v = a_f give the legs' velocities and
    accelerations from the rest.

    Args:
        robot: who stands.
        phase: where its feet are; they stay there until they are led elsewhere.
        start: coordinates (nv,) to start from.

    Attributes:
        columns: of the legs in the coordinates (k,).
        stand: whether each of them is of a leg whose foot stays where it is (k,).
    """

    def __init__(self, robot: Robot, phase: Phase, start: Array) -> None:
        self._model, self._data = robot.model, robot.model.createData()
        self._frames = {foot: robot.point(foot) for foot in phase.feet}
        self._feet = [(robot.point(foot), pose) for foot, pose in phase.feet.items()]
        self._foot_velocity, self._foot_acceleration = np.zeros(6 * len(self._feet)), np.zeros(6 * len(self._feet))
        self._joints = np.array(robot.groups["legs"], dtype=int)
        self.columns = 6 + self._joints
        self.stand = np.ones(len(self._joints), bool)
        self._legs_of = {
            foot: np.isin(self._joints, robot.groups[f"{side}_leg"])
            for foot, side in zip(robot.feet, SIDES, strict=True)
        }
        self._lower, self._upper = robot.lower[self._joints], robot.upper[self._joints]
        self._velocity, self._acceleration = robot.velocity[self._joints], robot.acceleration[self._joints]
        self._start = start[self.columns]
        self._angles = self._start

    def lead(self, poses: Mapping[str, Pose]) -> None:
        """Say where the feet are to be at the next call, and how they move there."""
        self.stand = ~np.any([self._legs_of[foot] & bool(pose.velocity.any()) for foot, pose in poses.items()], axis=0)
        self._feet = [
            (frame, pin.SE3(poses[foot].rotation, poses[foot].position)) for foot, frame in self._frames.items()
        ]
        self._foot_velocity = np.concatenate([poses[foot].velocity for foot in self._frames])
        self._foot_acceleration = np.concatenate([poses[foot].acceleration for foot in self._frames])

    def accelerations(self, y: Array, dy: Array) -> tuple[Array, Array]:
        """A (k, 6) and b (k,): the legs' accelerations are A ÿ + b with the base's ÿ (6,), at coordinates (nv,)."""
        q, v, a = pinocchio_state(y, dy, np.zeros_like(y))
        a[6:] = 0.0
        J = self._jacobian(q)
        base, inverse = J[:, :6].copy(), self._inverse(J)
        base[:, :3] = base[:, :3] @ to_rotation(y[None, 3:6])[0].T
        base[:, 3:] = base[:, 3:] @ rate_matrix(y[None, 3:6])[0]
        return -inverse @ base, -inverse @ (self._feet_accelerations(q, v, a) - self._foot_acceleration)

    def __call__(self, y: Array, dy: Array, ddy: Array) -> tuple[Array, Array, Array]:
        """Coordinates and derivatives (nv,) with such legs, whose angles follow from those of the last call."""
        legs = self.columns
        y, dy, ddy = y.copy(), dy.copy(), ddy.copy()
        self._solve(y)
        y[legs] = self._angles
        q, v, a = pinocchio_state(y, dy, ddy)
        v[legs], a[legs] = 0.0, 0.0
        J = self._jacobian(q)
        inverse = self._inverse(J)
        v[legs] = np.clip(-inverse @ (J @ v - self._foot_velocity), -self._velocity, self._velocity)
        # At the end of a range, or straight, a leg cannot follow: what it would have to do there is nobody's motion.
        wanted = -inverse @ (self._feet_accelerations(q, v, a) - self._foot_acceleration)
        curve = np.clip(wanted, -self._acceleration, self._acceleration)
        y[legs], dy[legs], ddy[legs] = self._angles, v[legs], curve
        return y, dy, ddy

    def _solve(self, y: Array) -> None:
        """Angles of the legs under a base as in coordinates (nv,), from those of the last call."""
        angles, error = self._improved(y, self._angles, GAUSS_NEWTON_STEPS)
        if error > MAX_FOOT_ERROR:
            tried = [self._improved(y, start, MAX_GAUSS_NEWTON_STEPS) for start in (angles, self._start)]
            angles, _ = min(tried, key=lambda one: one[1])
        self._angles = angles

    def _improved(self, y: Array, angles: Array, steps: int) -> tuple[Array, float]:
        """Angles (k,) after bounded Gauss-Newton steps, and the length of the feet's error."""
        y, legs, angles = y.copy(), self.columns, angles.copy()
        for step in range(steps + 1):
            y[legs] = angles
            J = self._jacobian(pinocchio_state(y, y, y)[0])[:, legs]
            e = self._error()
            if step < steps:
                bounded_move(angles, J.T @ J + DAMPING * np.eye(len(legs)), J.T @ e, self._lower, self._upper)
        return angles, float(np.linalg.norm(e))

    def _inverse(self, J: Array) -> Array:
        """Damped inverse (k, 12) of the legs' part of the feet's Jacobian (12, nv)."""
        own = J[:, self.columns]
        return np.asarray(np.linalg.solve(own.T @ own + DAMPING * np.eye(own.shape[1]), own.T))

    def _feet_accelerations(self, q: Array, v: Array, a: Array) -> Array:
        """Accelerations (12,) of both feet."""
        pin.forwardKinematics(self._model, self._data, q, v, a)
        return np.concatenate(
            [
                pin.getFrameClassicalAcceleration(self._model, self._data, foot, pin.LOCAL_WORLD_ALIGNED).vector
                for foot, _ in self._feet
            ]
        )

    def _jacobian(self, q: Array) -> Array:
        """Jacobian (12, nv) of both feet at a configuration (nq,)."""
        pin.computeJointJacobians(self._model, self._data, q)
        return np.vstack(
            [pin.getFrameJacobian(self._model, self._data, foot, pin.LOCAL_WORLD_ALIGNED) for foot, _ in self._feet]
        )

    def _error(self) -> Array:
        """Error (12,) of both feet where Pinocchio's joints are placed [m, rad]."""
        places = [(pin.updateFramePlacement(self._model, self._data, foot), pose) for foot, pose in self._feet]
        return np.concatenate(
            [
                part
                for place, pose in places
                for part in (place.translation - pose.translation, pin.log3(place.rotation @ pose.rotation.T))
            ]
        )
