"""Arms have several ways to point the same way. Which one to take, when: the best path through all of them."""

import numpy as np
from numpy.typing import NDArray
from scipy.stats.qmc import Halton

from sot.motion.limits import Limits
from sot.motion.parts import Arm
from sot.motion.retarget import solve_at

Array = NDArray[np.float64]

SPACING = 0.2  # s between key frames
KEPT = 3  # most solutions of a key frame; one fresh start joins them at the next
APART = 0.3  # rad, of two solutions that count as different
HURRY = 0.8  # of the velocity limit, from which travel costs more
TRAVEL, HASTE = 0.02, 4.0  # costs of travel and of hurry, against (direction error / accepted error)²


def choose(part: Arm, y: Array, limits: Limits, period: float) -> Array:
    """The path (T, nv) of least direction error and least joint travel, from the rest posture at the first knot.

    A key frame's candidates are solved from those of the frame before and from a fresh seed; dynamic programming finds
    the best sequence; knots between key frames are linear.
    """
    columns = part.columns
    stride = max(1, round(SPACING / period))
    knots = np.append(np.arange(0, len(y) - 1, stride), len(y) - 1)
    seeds = _seeds(len(columns), limits.lower[columns], limits.upper[columns])
    rate = limits.velocity[columns] * stride * period

    candidates, costs, origins = [y[:1, columns]], [np.zeros(1)], []
    for index, k in enumerate(knots[1:]):
        starts = np.vstack([candidates[-1], seeds[index % len(seeds)]])
        found, error = _solutions(part, k, y[k], starts, limits)
        travel = np.abs(found[None] - candidates[-1][:, None]) / rate
        price = np.sum(TRAVEL * travel**2 + HASTE * np.maximum(travel - HURRY, 0.0) ** 2, axis=2)
        total = costs[-1][:, None] + price
        origins.append(total.argmin(axis=0))
        candidates.append(found)
        costs.append(total.min(axis=0) + error)

    best = [int(costs[-1].argmin())]
    for origin in reversed(origins):
        best.append(int(origin[best[-1]]))
    chosen = np.array([found[i] for found, i in zip(candidates, reversed(best), strict=True)])
    path = y.copy()
    for i, column in enumerate(columns):
        path[:, column] = np.interp(np.arange(len(y)), knots, chosen[:, i])
    return path


def _solutions(part: Arm, k: int, y: Array, starts: Array, limits: Limits) -> tuple[Array, Array]:
    """Different local solutions at a knot (n, s) and their costs (n,), the best KEPT."""
    solved = []
    for start in starts:
        trial = y.copy()
        trial[part.columns] = start
        cost = solve_at(part, k, trial, limits)
        solved.append((cost, trial[part.columns]))
    solved.sort(key=lambda pair: pair[0])
    kept: list[tuple[float, Array]] = []
    for cost, x in solved:
        if len(kept) < KEPT and all(np.abs(x - other).max() > APART for _, other in kept):
            kept.append((cost, x))
    return np.array([x for _, x in kept]), np.array([cost for cost, _ in kept])


def _seeds(size: int, lower: Array, upper: Array) -> Array:
    """Postures (n, size) spread evenly over the joint range, the same every time."""
    return lower + Halton(size, scramble=False).random(64) * (upper - lower)
