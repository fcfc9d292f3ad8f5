"""Points of the robot as resolved acceleration follows them: the feedback of Hammam (11), (12) and (15) in one row."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from solvers.rows import Rows
from sot.control.task import MotionTask
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.resolved.orientation import orientation_error

Array = np.ndarray


class PointsSample(NamedTuple):
    """Where n points are to be and how they are to move, in the world.

    Args:
        positions: Shape (n, 3) [m].
        velocities, accelerations: Shapes (n, k): k = 3, or 6 with the angular part below [m/s, rad/s; m/s², rad/s²].
        rotations: Shape (n, 3, 3), where k = 6.
    """

    positions: Array
    velocities: Array
    accelerations: Array
    rotations: Array | None = None


PointsReference = Callable[[float], PointsSample]
"""t -> where points are to be then."""


class ResolvedPoints(MotionTask):
    """Rows ``J y = a* − J̇ q̇ + G_v v*`` on ``y = q̈ + G_v q̇`` (see `weighting`), or rows ``J q̇ = v*``.

    ``a* = a_d + K_v (v_d − v) + K_p e`` of (11), ``v* = v_d + K e`` of (15).

    Args:
        robot: The robot.
        points: Names of its operational points.
        reference: Of these points; with rotations, orientations are followed too.
        kp: K_p of (11) [1/s²]; K_v is critical.
        velocity_kp: K_p of (15) [1/s]: one number, or one for each point.
        velocity_gain: G_v of (31) [1/s]; infinite for rows on velocities alone.
        confidence: In each point, shape (n,), from 0 to 1: a factor of K, Dariush 4.3.1; 1 unless given.
        point_weights: Of each point's rows, shape (n,); 1 unless given.
    """

    def __init__(
        self,
        robot: Robot,
        points: Sequence[str],
        reference: PointsReference,
        kp: float = 300.0,
        velocity_kp: float | Array = 20.0,
        velocity_gain: float = 30.0,
        confidence: Array | None = None,
        point_weights: Array | None = None,
    ) -> None:
        super().__init__("points", "SI", "m, rad", kp)
        sample = reference(0.0)
        self._size = 3 if sample.rotations is None else 6
        self.points, self.reference, self.velocity_gain = tuple(points), reference, velocity_gain
        self.labels = [name for name in points for _ in range(self._size)]
        gains = np.broadcast_to(velocity_kp, len(self.points)) * (1.0 if confidence is None else confidence)
        self.velocity_kp = np.repeat(gains, self._size)
        self._row_weights = None if point_weights is None else np.repeat(point_weights, self._size)
        count = len(self.points) * self._size
        self._J, self._drift, self._velocity = np.zeros((count, robot.nv)), np.zeros(count), np.zeros(count)
        self._errors = np.zeros((len(self.points), self._size))

    @property
    def distances(self) -> Array:
        """Distances of the points from where they were to be at the last tick, shape (n,) [m]."""
        away: Array = np.linalg.norm(self._errors[:, :3], axis=1)
        return away

    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """Errors, their rates, J, J̇ v and feed-forward of all points; orientation errors by Hammam (12)."""
        wanted, size = self.reference(tick.t), self._size
        for k, name in enumerate(self.points):
            frame, rows = tick.frame(name), slice(k * size, (k + 1) * size)
            self._J[rows], self._drift[rows] = frame.jacobian[:size], frame.drift[:size]
            self._velocity[rows] = frame.velocity[:size]
            self._errors[k, :3] = wanted.positions[k] - frame.position
            if wanted.rotations is not None:
                self._errors[k, 3:] = orientation_error(frame.rotation, wanted.rotations[k])
        rate = wanted.velocities.ravel() - self._velocity
        return self._errors.ravel().copy(), rate, self._J, self._drift, wanted.accelerations.ravel()

    def rows(self, tick: Tick) -> Rows:
        """Rows on y, or on q̇."""
        self.error, rate, J, drift, forward = self.observe(tick)
        wanted = rate + self._velocity + self.velocity_kp * self.error  # v*
        if np.isfinite(self.velocity_gain):
            wanted = self.velocity_gain * wanted + forward + self.kd * rate + self.kp * self.error - drift
        if self._row_weights is not None:
            J, wanted = self._row_weights[:, None] * J, self._row_weights * wanted
        return self.make_rows(J, wanted, wanted)
