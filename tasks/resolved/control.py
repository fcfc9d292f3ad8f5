"""Constrained closed-loop inverse kinematics, Hammam (15), (16), (41), and resolved acceleration, (31)-(42)."""

from collections.abc import Callable, Sequence

import numpy as np

from solvers import Level, ResolvedAcceleration
from solvers.rows import Equality
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.resolved.pairs import Distances, NearestPairs
from tasks.resolved.points import ResolvedPoints
from tasks.resolved.weighting import Weighting

Array = np.ndarray


class ConstrainedResolvedAcceleration:
    """α_c of Hammam (31): points in order of priority, the feet first, each level in what those above leave.

    Args:
        levels: Points of each level, which all have the same G_v.
        pairs: Distances that the weights know.
        weighting: What makes W.
        solver: The inverses.
        preferred: ζ of (32) for y, from a tick, shape (nv,); nothing unless given.

    Attributes:
        distances: Those of the last tick.
    """

    def __init__(
        self,
        levels: Sequence[ResolvedPoints],
        pairs: NearestPairs,
        weighting: Weighting,
        solver: ResolvedAcceleration,
        preferred: Callable[[Tick], Array] | None = None,
    ) -> None:
        self.levels, self.velocity_gain = levels, levels[0].velocity_gain
        self._pairs, self._weighting, self._solver, self._preferred = pairs, weighting, solver, preferred
        self.distances: Distances | None = None

    def __call__(self, tick: Tick) -> Array:
        """α_c of (31), or q̇_c of (41) if G_v is infinite, shape (nv,)."""
        self.distances = self._pairs(tick)
        weights = self._weighting(tick, self.distances)
        self._solver.weight, self._solver.penalties = weights.matrix, weights.penalties
        if self._preferred is not None:
            self._solver.preferred = self._preferred(tick)
        y = self._solver.solve([_equality_level(points, tick) for points in self.levels]).x
        return y - self.velocity_gain * tick.v if np.isfinite(self.velocity_gain) else y


def towards_rest(robot: Robot, rate: float, velocity_gain: float) -> Callable[[Tick], Array]:
    """A ζ of (32): joints go to their rest posture at a rate [1/s]."""
    wanted = np.zeros(robot.nv)

    def preferred(tick: Tick) -> Array:
        wanted[6:] = velocity_gain * rate * (robot.rest[7:] - tick.q[7:])
        return wanted

    return preferred


def _equality_level(points: ResolvedPoints, tick: Tick) -> Level:
    rows, nv = points.rows(tick), tick.robot.nv
    return Level(points.name, nv, [Equality(rows.A, rows.lower)], np.zeros((0, nv)), np.zeros(0), np.zeros(0))
