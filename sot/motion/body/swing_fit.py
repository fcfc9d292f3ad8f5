"""The path of an ankle through the air nearest to a wanted one, at rest at both footholds and within speed and
acceleration."""

from dataclasses import dataclass

import numpy as np
import quadprog
from numpy.typing import NDArray

from sot.smooth import MINIMUM_JERK_PEAK_SPEED

Array = NDArray[np.float64]

ACCEPTED_ERROR_LEGS = 0.03  # leg lengths off the wanted path, that cost as much as ACCEPTED_JERK
ACCEPTED_JERK = 600.0  # leg lengths/s³
ONSET_SHARE = 0.1  # of a swing's time at either end, in which its acceleration begins and ends
LEAST_ROOM = 1.3  # of the speed and acceleration of a path straight from hold to hold, that a limit leaves at least
LEAST_JERK_ACCELERATION = 5.774  # peak of that path, over its length and the square of its time


@dataclass(frozen=True)
class AirLimits:
    """Limits of an ankle in the air: its speed relative to the hips [m/s], its acceleration [m/s²], and the leg's
    length [m], which its errors count in."""

    speed: float
    acceleration: float
    leg: float


def nearest_path(
    wanted: Array,
    ends: Array,
    hips: Array,
    period: float,
    limits: AirLimits,
    ways: Array,
    least: Array,
) -> Array | None:
    """The path (n, d) nearest to a wanted one, over d axes; None if there is none within its limits.

    A quadratic programme over the n places. Speed and acceleration are bounded axis by axis; where the way from end to
    end asks for more than they allow, they allow LEAST_ROOM times that.

    Args:
        wanted: (n, d) at knots `period` apart, the first of them one period after the foot has left the floor [m].
        ends: (2, d) where it leaves the floor, and where it lands, one period after the last knot [m].
        hips: (n + 2, d) of the place to which its speed is relative, from leaving the floor to landing [m].
        period: between knots [s].
        limits: of the ankle.
        ways: (n, d) directions along which it is to be no less than `least` (n,) from the origin [m].
        least: see `ways`.
    """
    count, axes = wanted.shape
    padded = np.zeros((count + 6, count))
    padded[3:-3] = np.eye(count)
    start, stop = np.zeros(count + 6), np.zeros(count + 6)
    start[:3], stop[-3:] = 1.0, 1.0

    def difference(order: int) -> tuple[Array, Array]:
        """Differences of an order by the places, and those of the ends alone (·, d)."""
        cut = slice(3 - order, count + 3 + order)
        fixed = np.outer(start, ends[0]) + np.outer(stop, ends[1])
        return np.diff(padded[cut], order, axis=0), np.diff(fixed[cut], order, axis=0)

    jerk, jerk_of_ends = difference(3)
    smooth = 1.0 / (ACCEPTED_JERK * limits.leg * period**3) ** 2
    close = 1.0 / (ACCEPTED_ERROR_LEGS * limits.leg) ** 2
    H = close * np.eye(count) + smooth * jerk.T @ jerk
    gradient = close * wanted - smooth * jerk.T @ jerk_of_ends

    speed, speed_of_ends = difference(1)
    bend, bend_of_ends = difference(2)
    time = period * (count + 1)
    away = np.abs(np.diff(ends - hips[[0, -1]], axis=0)[0])
    far = np.abs(np.diff(ends, axis=0)[0])
    fastest = np.maximum(limits.speed, LEAST_ROOM * MINIMUM_JERK_PEAK_SPEED * away / time) * period
    hardest = np.maximum(limits.acceleration, LEAST_ROOM * LEAST_JERK_ACCELERATION * far / time**2) * period**2
    apart = np.minimum(np.arange(len(bend)), np.arange(len(bend))[::-1]) + 0.5  # periods from the nearer end
    begun = np.minimum(1.0, apart * period / (ONSET_SHARE * time))
    carried = np.diff(hips, axis=0)
    rows: list[Array] = []
    bounds: list[Array] = []
    for axis in range(axes):
        for D, of_ends, middle, most in (
            (speed, speed_of_ends[:, axis], carried[:, axis], np.full(len(speed), fastest[axis])),
            (bend, bend_of_ends[:, axis], np.zeros(len(bend)), begun * hardest[axis]),
        ):
            block = np.zeros((len(D), axes * count))
            block[:, axis * count : (axis + 1) * count] = D
            rows += [block, -block]
            bounds += [middle - most - of_ends, of_ends - middle - most]
    rows.append(np.hstack([np.diag(way) for way in ways.T]))
    bounds.append(least)
    try:
        found = quadprog.solve_qp(
            np.kron(np.eye(axes), H), gradient.T.ravel(), np.vstack(rows).T, np.concatenate(bounds)
        )[0]
    except ValueError:  # the limits contradict one another
        return None
    return found.reshape(axes, count).T
