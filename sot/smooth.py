"""Smooth ways from one value to another, and the slow part of a signal."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

Array = NDArray[np.float64]


def ease(s: Array) -> Array:
    """From 0 to 1 with the least jerk, over s in 0..1; at rest and without acceleration at both ends, and beyond."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def slow_part(values: Array, rate: float, cutoff_hz: float) -> Array:
    """The part of values (T, ...) at a rate [Hz] that is slower than `cutoff_hz`, without delay."""
    padding = min(len(values) - 1, round(rate / cutoff_hz))
    return sosfiltfilt(butter(2, cutoff_hz, fs=rate, output="sos"), values, axis=0, padlen=padding)
