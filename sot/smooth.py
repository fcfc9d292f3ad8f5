"""The minimum-jerk profile, and a low-pass filter without delay."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

Array = NDArray[np.float64]

MINIMUM_JERK_PEAK_SPEED = 1.875
"""Greatest speed of the minimum-jerk profile over its mean one."""


def minimum_jerk(s: Array) -> Array:
    """The minimum-jerk profile from 0 to 1 over s in 0..1; velocity and acceleration vanish at both ends and beyond."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def minimum_jerk_curve(s: Array) -> Array:
    """The second derivative of `minimum_jerk` over s."""
    s = np.clip(s, 0.0, 1.0)
    return s * (60.0 - 180.0 * s + 120.0 * s**2)


def low_passed(values: Array, rate: float, cutoff_hz: float) -> Array:
    """Values (T, ...) at a rate [Hz] without what is faster than `cutoff_hz`; the filter has no delay."""
    padding = min(len(values) - 1, round(rate / cutoff_hz))
    return sosfiltfilt(butter(2, cutoff_hz, fs=rate, output="sos"), values, axis=0, padlen=padding)
