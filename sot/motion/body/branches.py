"""Choose among an arm's several postures that point the same way: the best path through all of them over time."""

import numpy as np
from numpy.typing import NDArray
from scipy.stats.qmc import Halton

from sot.motion.body.limits import Limits
from sot.motion.body.parts import Part
from sot.motion.body.retarget import solve_knots

Array = NDArray[np.float64]

KEY_FRAME_PERIOD = 0.2  # s, between key frames
START_POSTURE_COUNT = 8  # number of postures from which every key frame is solved
FAST_TRAVEL_SHARE = 0.8  # share of the velocity limit above which travel costs more
TRAVEL_COST, FAST_TRAVEL_COST = (
    0.02,
    4.0,
)  # costs of travel and of fast travel, relative to (direction error / accepted error)²


def choose_arm_path(part: Part, y: Array, limits: Limits, period: float) -> Array:
    """Path (T, nv) of an arm with the least direction error and joint travel, from its posture at the first knot.

    Every key frame is solved from the same postures, spread over the joint range; dynamic programming finds the best
    sequence of their solutions; knots between key frames are linear.
    """
    columns = part.columns
    stride = max(1, round(KEY_FRAME_PERIOD / period))
    knots = np.append(np.arange(0, len(y) - 1, stride), len(y) - 1)
    lower, upper = limits.lower[columns], limits.upper[columns]
    starts = lower + Halton(len(columns), scramble=False).random(START_POSTURE_COUNT) * (upper - lower)
    repeated = np.repeat(knots[1:], START_POSTURE_COUNT)
    trials = y[repeated]
    trials[:, columns] = np.tile(starts, (len(knots) - 1, 1))
    found, error = solve_knots(part, repeated, trials, limits)
    found, error = found.reshape(-1, START_POSTURE_COUNT, len(columns)), error.reshape(-1, START_POSTURE_COUNT)
    first = np.broadcast_to(y[0, columns], (1, START_POSTURE_COUNT, len(columns)))
    chosen = _best_path(np.vstack([first, found]), error, limits.velocity[columns] * stride * period)
    path = y.copy()
    for i, column in enumerate(columns):
        path[:, column] = np.interp(np.arange(len(y)), knots, chosen[:, i])
    return path


def _best_path(candidates: Array, error: Array, reach: Array) -> Array:
    """Sequence (K, s) of one candidate (K, n, s) for each key frame with the least sum of errors and travel.

    error: (K - 1, n) cost of all candidates but the first key frame's.
    reach: (s,) farthest that a joint can travel from one key frame to the next.
    """
    travel = np.abs(candidates[1:, None] - candidates[:-1, :, None]) / reach
    prices = np.sum(
        TRAVEL_COST * travel**2 + FAST_TRAVEL_COST * np.maximum(travel - FAST_TRAVEL_SHARE, 0.0) ** 2, axis=3
    )
    cost, origins = np.zeros(candidates.shape[1]), []
    for price, own in zip(prices, error, strict=True):
        total = cost[:, None] + price
        origins.append(total.argmin(axis=0))
        cost = total.min(axis=0) + own
    best = [int(cost.argmin())]
    for origin in reversed(origins):
        best.append(int(origin[best[-1]]))
    return candidates[np.arange(len(candidates)), best[::-1]]
