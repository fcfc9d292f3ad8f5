"""The filters of Dariush et al. (2009), 4.2, to compare with, and how late each filter is."""

from collections import deque
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfilt, sosfilt_zi

Array = NDArray[np.float64]
Filter = Callable[[Array], Array]
"""A new sample (n,) -> what the filter makes of it and of those before (n,)."""

TEST_HZ = (0.3, 0.5, 0.8)
"""Frequencies of the test signal, such as arms have [Hz]."""
TEST_TIME = 20.0
DELAY_STEP, MAX_DELAY = 0.001, 0.6


class CausalButterworth:
    """Second-order Butterworth low-pass, sample by sample.

    Args:
        cutoff_hz: where it begins to smooth [Hz].
        rate: samples a second [Hz].
    """

    def __init__(self, cutoff_hz: float, rate: float) -> None:
        self._sos = butter(2, cutoff_hz, fs=rate, output="sos")
        self._state: Array | None = None

    def __call__(self, x: Array) -> Array:
        """The smoothed sample (n,)."""
        if self._state is None:
            self._state = sosfilt_zi(self._sos)[:, :, None] * x
        y, self._state = sosfilt(self._sos, x[None], axis=0, zi=self._state)
        return np.asarray(y[0])


class CardinalSpline:
    """Cardinal spline through the samples: tangents are `(1 - tension) / 2` times the way between neighbours.

    A tangent needs the sample after its own: what can be told at a sample is where the person was two periods ago, and
    from there on one period of curve.
    """

    def __init__(self, tension: float = 0.0) -> None:
        self._share = 0.5 * (1.0 - tension)
        self._samples: deque[Array] = deque(maxlen=4)

    def __call__(self, x: Array) -> Array:
        """The curve two periods before the sample (n,)."""
        self._samples.append(x)
        return self.between(0.0)

    def between(self, share: float) -> Array:
        """The curve at a share 0..1 of the period that began two samples ago (n,)."""
        if len(self._samples) < 4:
            return self._samples[0]
        before, start, end, after = self._samples
        out, into = self._share * (end - before), self._share * (after - start)
        s, t = share, 1.0 - share
        return np.asarray(t**2 * (1 + 2 * s) * start + s**2 * (1 + 2 * t) * end + s * t**2 * out - s**2 * t * into)


def measured_delay(filter_: Filter, rate: float) -> float:
    """How late a filter is [s]: the shift at which a smooth signal at a rate [Hz] agrees best with what comes out."""
    times = np.arange(0.0, TEST_TIME, 1.0 / rate)

    def signal(t: Array) -> Array:
        return np.asarray(sum(np.sin(2.0 * np.pi * hz * t + hz) for hz in TEST_HZ))

    out = np.array([filter_(np.array([x]))[0] for x in signal(times)])
    used = times > 2.0
    delays = np.arange(0.0, MAX_DELAY, DELAY_STEP)
    agreement = [np.corrcoef(out[used], signal(times[used] - delay))[0, 1] for delay in delays]
    return float(delays[int(np.argmax(agreement))])
