"""Joint velocities limited by a slower clock, Dariush 4.5."""

import numpy as np

Array = np.ndarray

BISECTIONS = 60


def modulation_factors(q: Array, period: float, limits: Array) -> Array:
    """ε_s, the largest of all joints: speed over limit in each step between samples q (T, n), shape (T − 1,)."""
    factors: Array = (np.abs(np.diff(q, axis=0)) / period / limits).max(axis=1)
    return factors


def modulated_times(factors: Array, period: float) -> Array:
    """t' of Dariush (15), (16): steps in which a joint is too fast take as much longer, shape (T,) [s]."""
    return np.concatenate([[0.0], np.cumsum(period * np.maximum(factors, 1.0))])


def duration_keeping_times(factors: Array, period: float) -> Array | None:
    """Times of the same samples within the same duration, shape (T,) [s]: fast steps take longer, slow ones less.

    Steps take ``max(ε, c)`` of the period, with the c <= 1 that keeps the duration: no step is played faster than
    ``1 / c``, nor than its joints allow. None if even the fastest way through takes longer.
    """
    count = len(factors)
    if factors.sum() > count:
        return None
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if np.maximum(factors, middle).sum() > count:
            high = middle
        else:
            low = middle
    return np.concatenate([[0.0], np.cumsum(period * np.maximum(factors, low))])
