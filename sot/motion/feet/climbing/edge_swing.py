"""How a foot gets from one level to another one: up before the edge, ahead over it, and down behind it."""

import numpy as np
from numpy.typing import NDArray

from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

CLEARANCE = 0.05  # leg lengths, of a sole over the higher one of the levels that it leaves and comes to
RISE_SHARE = 0.45  # of a swing's time, in which a foot rises, and in which it comes down
WAY_SHARES = 0.15, 0.85  # of a swing's time, between which a foot moves ahead, as long as it is over the higher level


def edge_swing(share: Array, before: float, after: float, clearance: float, passed: float = 0.0) -> tuple[Array, Array]:
    """The share of its way ahead that a foot has made, and its height (n,) [m], each with least jerk.

    Args:
        share: of the swing's time that is over (n,).
        before, after: heights of the levels that it leaves and comes to [m].
        clearance: over the higher one of them [m].
        passed: height of what is between them, which it clears, too [m].
    """
    higher = max(before, after, passed)
    top = higher + clearance
    begin = max(WAY_SHARES[0], _time_share(higher - before, top - before))
    end = min(WAY_SHARES[1], 1.0 - _time_share(higher - after, top - after))
    height = before + (top - before) * minimum_jerk(share / RISE_SHARE)
    height -= (top - after) * minimum_jerk((share - 1.0 + RISE_SHARE) / RISE_SHARE)
    return minimum_jerk((share - begin) / (end - begin)), height


def edge_swing_length(way: float, rise: float, clearance: float) -> float:
    """How far a foot moves in such a swing, up, ahead and down [m]."""
    return way + abs(rise) + 2.0 * clearance


def _time_share(part: float, whole: float) -> float:
    """Share of a swing's time within which a foot has risen by a part of the whole height."""
    shares = np.linspace(0.0, 1.0, 201)
    return RISE_SHARE * float(np.interp(part / whole, minimum_jerk(shares), shares))
