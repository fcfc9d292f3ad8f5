"""Constrained closed-loop inverse kinematics, Hammam (15), (16), (41), and resolved acceleration, (31)-(42)."""

from collections.abc import Sequence

import numpy as np

from solvers import Level, ResolvedAcceleration
from sot.control.tick import Tick
from tasks.resolved.pairs import Distances, NearestPairs
from tasks.resolved.point import ResolvedPoint
from tasks.resolved.weighting import Weighting

Array = np.ndarray

NO_GAIN = np.inf


class ConstrainedResolvedAcceleration:
    """α_c of Hammam (31): the feet first, the points of the upper body in what they leave.

    Args:
        feet, points: Levels of points, the feet's first; they have one G_v.
        pairs: Distances that the weights know.
        weighting: What makes W.
        solver: The inverses.
        velocity_gain: G_v [1/s]; infinite if the points' rows are on velocities, for q̇_c of (41) alone.
    """

    def __init__(
        self,
        feet: Sequence[ResolvedPoint],
        points: Sequence[ResolvedPoint],
        pairs: NearestPairs,
        weighting: Weighting,
        solver: ResolvedAcceleration,
        velocity_gain: float = 30.0,
    ) -> None:
        self.feet, self.points, self.velocity_gain = feet, points, velocity_gain
        self._pairs, self._weighting, self._solver = pairs, weighting, solver
        self.distances: Distances | None = None

    def __call__(self, tick: Tick) -> Array:
        """α_c of (31), or q̇_c of (41) if G_v is infinite, shape (nv,)."""
        self.distances = self._pairs(tick)
        weights = self._weighting(tick, self.distances)
        self._solver.weight, self._solver.penalties = weights.matrix, weights.penalties
        nv = tick.robot.nv
        levels = [
            Level.stack(name, [point.rows(tick) for point in points], nv)
            for name, points in (("feet", self.feet), ("points", self.points))
        ]
        y = self._solver.solve(levels).x
        return y - self.velocity_gain * tick.v if np.isfinite(self.velocity_gain) else y
