"""Legs that go with the pelvis while the feet stay where they are, or go where they are led."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from solvers.compiled import compiled
from sot.control.pose import Pose
from sot.control.quantities.points_motion import PointsMotion, pose_errors
from sot.live.bounded_move import bounded_move
from sot.live.state import coordinate_columns, pinocchio_state
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
        self._names = tuple(phase.feet)
        frames = [robot.point(foot) for foot in self._names]
        self._feet = PointsMotion(robot.model, frames, robot.model.createData())
        self._positions = np.array([pose.translation for pose in phase.feet.values()])
        self._rotations = np.array([pose.rotation for pose in phase.feet.values()])
        self._foot_velocity, self._foot_acceleration = np.zeros((2, 6 * len(self._names)))
        self._still = np.zeros(robot.nv)
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
        self._positions = np.array([poses[foot].position for foot in self._names])
        self._rotations = np.array([poses[foot].rotation for foot in self._names])
        self._foot_velocity = np.concatenate([poses[foot].velocity for foot in self._names])
        self._foot_acceleration = np.concatenate([poses[foot].acceleration for foot in self._names])

    def accelerations(self, y: Array, dy: Array) -> tuple[Array, Array]:
        """A (k, 6) and b (k,): the legs' accelerations are A ÿ + b with the base's ÿ (6,), at coordinates (nv,)."""
        q, v, a = pinocchio_state(y, dy, self._still)
        feet = self._feet
        feet.place(q)
        feet.move(v)
        missing = self._foot_acceleration - feet.drift - feet.jacobian @ a
        answers = _leg_answers(
            feet.jacobian, self.columns, np.column_stack([-coordinate_columns(feet.jacobian, y)[:, :6], missing])
        )
        return answers[:, :6], answers[:, 6]

    def __call__(self, y: Array, dy: Array, ddy: Array) -> tuple[Array, Array, Array]:
        """Coordinates and derivatives (nv,) with such legs, whose angles follow from those of the last call."""
        legs, feet = self.columns, self._feet
        y, dy, ddy = y.copy(), dy.copy(), ddy.copy()
        self._solve(y)
        y[legs] = self._angles
        dy[legs] = ddy[legs] = 0.0
        q, v, a = pinocchio_state(y, dy, ddy)
        feet.place(q)
        rates = self._answer(self._foot_velocity - feet.jacobian @ v)
        v[legs] = dy[legs] = _within(rates, self._velocity)
        feet.move(v)
        # At the end of a range, or straight, a leg cannot follow: what it would have to do there is nobody's motion.
        curve = self._answer(self._foot_acceleration - feet.drift - feet.jacobian @ a)
        ddy[legs] = _within(curve, self._acceleration)
        return y, dy, ddy

    def _answer(self, missing: Array) -> Array:
        """Rates (k,) of the legs that make the feet's rates differ by as much (12,)."""
        return np.asarray(_leg_answers(self._feet.jacobian, self.columns, missing[:, None])[:, 0])

    def _solve(self, y: Array) -> None:
        """Angles of the legs under a base as in coordinates (nv,), from those of the last call."""
        angles, error = self._improved(y, self._angles, GAUSS_NEWTON_STEPS)
        if error > MAX_FOOT_ERROR:
            tried = [self._improved(y, start, MAX_GAUSS_NEWTON_STEPS) for start in (angles, self._start)]
            angles, _ = min(tried, key=lambda one: one[1])
        self._angles = angles

    def _improved(self, y: Array, angles: Array, steps: int) -> tuple[Array, float]:
        """Angles (k,) after bounded Gauss-Newton steps, and the length of the feet's error."""
        y, legs, angles, feet = y.copy(), self.columns, angles.copy(), self._feet
        for step in range(steps + 1):
            y[legs] = angles
            feet.place(pinocchio_state(y, self._still, self._still)[0])
            e = pose_errors(feet.positions, feet.rotations, self._positions, self._rotations)
            if step < steps:
                _move_legs(angles, feet.jacobian, legs, e, self._lower, self._upper)
        return angles, float(np.sqrt(e @ e))


@compiled
def _move_legs(angles: Array, J: Array, columns: NDArray[np.int_], e: Array, lower: Array, upper: Array) -> None:
    """Move angles (k,) by a bounded Gauss-Newton step on the error e (12,) of the feet."""
    H, own = _leg_hessian(J, columns)
    g = np.zeros(len(columns))
    for i in range(len(columns)):
        for m in range(len(e)):
            g[i] += own[i, m] * e[m]
    bounded_move(angles, H, g, lower, upper)


@compiled
def _leg_answers(J: Array, columns: NDArray[np.int_], missing: Array) -> Array:
    """The damped least-squares answers (k, n) of the legs to rates (12, n) that the feet lack."""
    H, own = _leg_hessian(J, columns)
    g = np.zeros((len(columns), missing.shape[1]))
    for i in range(len(columns)):
        for m in range(len(missing)):
            for n in range(missing.shape[1]):
                g[i, n] += own[i, m] * missing[m, n]
    return np.linalg.solve(H, g).astype(np.float64)


@compiled
def _leg_hessian(J: Array, columns: NDArray[np.int_]) -> tuple[Array, Array]:
    """The damped square (k, k) of the legs' part of the feet's Jacobian (12, nv), and that part transposed (k, 12)."""
    own, H = np.empty((len(columns), len(J))), np.zeros((len(columns), len(columns)))
    for i in range(len(columns)):
        for m in range(len(J)):
            own[i, m] = J[m, columns[i]]
    for i in range(len(columns)):
        H[i, i] = DAMPING
        for k in range(len(columns)):
            for m in range(len(J)):
                H[i, k] += own[i, m] * own[k, m]
    return H, own


@compiled
def _within(values: Array, most: Array) -> Array:
    """Values (k,) within ± their bounds."""
    out = np.empty_like(values)
    for i in range(len(values)):
        out[i] = min(max(values[i], -most[i]), most[i])
    return out
