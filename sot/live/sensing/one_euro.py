"""Causal smoothing of a person's points as they come."""

import numpy as np
from numpy.typing import NDArray

from sot.live.person import Moment
from sot.motion.human.human import nearest_rotations

Array = NDArray[np.float64]


class OneEuro:
    """First-order low-pass whose cutoff grows with speed: little noise at rest, little lag in motion.

    Casiez, Roussel and Vogel, CHI 2012: cutoff = least + slope |ẋ|, the speed itself low-passed.

    Args:
        least_hz: cutoff at rest [Hz].
        slope: growth of the cutoff with speed [Hz per unit/s].
        speed_hz: cutoff of the speed [Hz].
    """

    def __init__(self, least_hz: float = 6.0, slope: float = 10.0, speed_hz: float = 4.0) -> None:
        self._least, self._slope, self._speed_hz = least_hz, slope, speed_hz
        self._x: Array | None = None
        self._dx: Array | None = None

    def start_anew(self) -> None:
        """Forget the past."""
        self._x = None

    def __call__(self, x: Array, elapsed: float) -> Array:
        """Points (n, 3) smoothed, `elapsed` [s] after the last."""
        if self._x is None or self._dx is None or elapsed <= 0.0:
            self._x, self._dx = x.copy(), np.zeros_like(x)
            return x
        self._dx = self._dx + _share(self._speed_hz, elapsed) * ((x - self._x) / elapsed - self._dx)
        speed = np.linalg.norm(self._dx, axis=-1, keepdims=True)
        self._x = self._x + _share(self._least + self._slope * speed, elapsed) * (x - self._x)
        return self._x


class MomentFilter:
    """`OneEuro` for a person's points and for the orientations of its bodies, whose matrices' entries are smoothed."""

    def __init__(self) -> None:
        self._points, self._turns = OneEuro(), OneEuro()
        self._at = -np.inf

    def start_anew(self) -> None:
        """Forget the past."""
        self._points.start_anew()
        self._turns.start_anew()

    def __call__(self, moment: Moment, t: float) -> Moment:
        """The smoothed person at a time [s]."""
        elapsed, self._at = t - self._at, t
        points = self._points(np.array(list(moment.points.values())), elapsed)
        turns = self._turns(np.array(list(moment.frames.values())), elapsed)
        return Moment(
            dict(zip(moment.points, points, strict=True)),
            dict(zip(moment.frames, nearest_rotations(turns), strict=True)),
        )


def _share(cutoff_hz: float | Array, elapsed: float) -> float | Array:
    """Share of a new value that a first-order low-pass takes over."""
    w = 2.0 * np.pi * cutoff_hz * elapsed
    return w / (1.0 + w)
