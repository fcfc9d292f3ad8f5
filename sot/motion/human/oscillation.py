"""Where a joint oscillates, at which frequency and how far: ridges of its scalogram that noise does not explain."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from sot.motion.human.scalogram import RELATIVE_BANDWIDTH, Scalogram, scalogram

Array = NDArray[np.float64]

BAND_HZ = (0.7, 7.0)  # slower is a gesture, faster a tremor
LEAST_AMPLITUDE_RAD = math.radians(0.5)
FALSE_ALARM_PROBABILITY = 0.05  # that noise shows an oscillation anywhere in a signal
KNOTS_PER_PERIOD = 4.0  # candidates for a stretch's ends, before these are refined
RIDGE_STEP_ROWS = 2  # a ridge moves by at most so many rows per sample, a twelfth of an octave
RIDGE_SMOOTHING_ROWS = (
    3.0  # rows, a third of the wavelet's own width: PyWavelets' samples of it make ripples on a ridge
)
STEADINESS_LIMIT = 1.0 - 1e-12  # steadiness that rounding leaves of 1


@dataclass(frozen=True)
class Oscillation:
    """A stretch of a signal that swings as A sin(2π f t + φ) about its slow part.

    Attributes:
        start, end: of the stretch [s].
        frequency: f [Hz].
        amplitude: A, half the way from one turning point to the next, in the signal's unit (rad for a joint).
        phase: φ [rad], at time 0 of the signal, in -π..π.
    """

    start: float
    end: float
    frequency: float
    amplitude: float
    phase: float

    def swing_at(self, t: Array) -> Array:
        """The swing at times [s], as if it had neither beginning nor end."""
        return self.amplitude * np.sin(2.0 * np.pi * self.frequency * t + self.phase)


@dataclass(frozen=True, eq=False)
class _Ridge:
    """A line of greatest amplitude through a scalogram: row `rows[k]` at sample `first` + k."""

    first: int
    rows: NDArray[np.int_]


@dataclass(frozen=True)
class _Stretch:
    """Samples `first` to `last`, which swing at a frequency [Hz] as steadily as noise does once in exp(-`chance`)."""

    first: int
    last: int
    frequency: float
    log_probability: float


def find_oscillations(
    t: Array, q: Array, band: tuple[float, float] = BAND_HZ, least: float = LEAST_AMPLITUDE_RAD
) -> list[Oscillation]:
    """The oscillations of a signal, in order of their beginning.

    Along each ridge of the scalogram the stretches are sought whose steadiness chance explains least. Let y be the
    coefficients of a stretch, turned back by a frequency f: their steadiness R = |mean y|² / mean |y|² is 1 for a sine.
    Where n of them are independent, noise exceeds R with probability (1 - R)^(n - 1), the exponential tail behind
    Fisher's test of a hidden period, whatever the noise's spectrum and strength. A stretch counts if that is below
    `FALSE_ALARM_PROBABILITY` for all the independent places together that the signal has. So no scale, threshold or
    background is chosen for a signal. Of 400 signals of 24 s of white to f^-3 noise over slow motion, 16 showed an
    oscillation.

    Args:
        t: times, evenly spaced [s], (N,).
        q: signal, (N,) [rad].
        band: lowest and highest frequency looked at [Hz].
        least: smallest amplitude that counts, in the signal's unit.

    Raises:
        InputError: as `scalogram`.
    """
    seen = scalogram(t, q, band)
    places = RELATIVE_BANDWIDTH * (seen.times[-1] - seen.times[0]) * (band[1] - band[0])
    worst = math.log(FALSE_ALARM_PROBABILITY / max(places, 1.0))
    stretches = [stretch for ridge in _scalogram_ridges(seen) for stretch in _steady_stretches(seen, ridge, worst)]
    found: list[Oscillation] = []
    for stretch in sorted(stretches, key=lambda one: one.log_probability):
        one = _measured_oscillation(seen, stretch)
        if one.amplitude >= least and not any(_is_same_oscillation(one, other) for other in found):
            found.append(one)
    return sorted(found, key=lambda one: one.start)


def _scalogram_ridges(seen: Scalogram) -> list[_Ridge]:
    """Local maxima over frequency, each followed from sample to sample as long as there is one nearby."""
    power = gaussian_filter1d(seen.power, RIDGE_SMOOTHING_ROWS, axis=0)
    peaks = (power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:])
    done: list[tuple[int, list[int]]] = []
    growing: dict[int, tuple[int, list[int]]] = {}
    for sample, column in enumerate(peaks.T):
        grown = {}
        for row in (np.flatnonzero(column) + 1).tolist():
            near = [other for other in growing if abs(other - row) <= RIDGE_STEP_ROWS]
            before = min(near, key=lambda other: abs(other - row), default=None)
            first, rows = growing.pop(before) if before is not None else (sample, [])
            rows.append(row)
            grown[row] = (first, rows)
        done += growing.values()
        growing = grown
    return [_Ridge(first, np.array(rows)) for first, rows in [*done, *growing.values()]]


def _steady_stretches(seen: Scalogram, ridge: _Ridge, worst: float) -> Iterator[_Stretch]:
    """Stretches of a ridge that noise is unlikely to show: the least likely one first, then those on either side."""
    rate, count = seen.rate, len(ridge.rows)
    on_ridge = seen.frequencies[ridge.rows]
    knots = np.arange(0, count, max(1, round(rate / (KNOTS_PER_PERIOD * float(np.median(on_ridge))))))
    if len(knots) < 3:
        return
    times = np.arange(count) / rate
    tried = np.arange(on_ridge.min(), on_ridge.max() + 1.0 / times[-1], 0.25 / times[-1])
    y = seen.coefficients[ridge.rows, ridge.first + np.arange(count)]
    turned = y[:, None] * np.exp(-2j * np.pi * times[:, None] * tried)
    sums = np.concatenate([np.zeros((1, len(tried))), np.cumsum(turned, axis=0)])[knots]
    energies = np.concatenate([[0.0], np.cumsum(np.abs(y) ** 2)])[knots]
    waiting = [(0, len(knots))]
    while waiting:
        begin, end = waiting.pop()
        best = (worst, 0, 0, 0)
        for i in range(begin, end - 1):
            samples = knots[i + 1 : end] - knots[i]
            energy = np.maximum(samples * (energies[i + 1 : end] - energies[i]), np.finfo(float).tiny)
            steadiness = np.abs(sums[i + 1 : end] - sums[i]) ** 2 / energy[:, None]
            independent = RELATIVE_BANDWIDTH * samples[:, None] / rate * tried
            chances = np.maximum(independent - 1.0, 0.0) * np.log1p(-np.minimum(steadiness, STEADINESS_LIMIT))
            j, k = divmod(int(chances.argmin()), len(tried))
            best = min(best, (float(chances[j, k]), i, i + 1 + j, k))
        chance, i, j, k = best
        if j:
            yield _Stretch(ridge.first + int(knots[i]), ridge.first + int(knots[j]) - 1, float(tried[k]), chance)
            waiting += [(begin, i + 1), (j, end)]


def _measured_oscillation(seen: Scalogram, stretch: _Stretch) -> Oscillation:
    """The oscillation in a stretch, with refined ends, frequency, amplitude and phase."""
    row = int(np.abs(seen.frequencies - stretch.frequency).argmin())
    y = seen.coefficients[row] * np.exp(-2j * np.pi * stretch.frequency * seen.times)
    mean = y[stretch.first : stretch.last + 1].mean()
    # Where a sine is switched on or off, half of its amplitude is seen.
    beyond_half = (y * mean.conjugate()).real / abs(mean) ** 2 - 0.5
    middle, period = (stretch.first + stretch.last) // 2, seen.rate / stretch.frequency
    first = middle - _switch_off_sample(beyond_half[middle::-1], period)
    last = middle + _switch_off_sample(beyond_half[middle:], period)
    if last - first < 2.0 * period:  # weakest in its middle
        first, last = stretch.first, stretch.last
    # Away from the ends the amplitude is whole; a phase that drifts corrects the frequency.
    inner = slice(first + int(0.5 * period), last - int(0.5 * period) + 1)
    times, y, mean = seen.times[inner], y[inner], y[inner].mean()
    drift, _ = np.polyfit(times, np.angle(y / mean), 1, w=np.abs(y))
    frequency = stretch.frequency + float(drift) / (2.0 * np.pi)
    start, end = float(seen.times[first]), float(seen.times[last])
    steady = y * np.exp(-1j * drift * times)
    return Oscillation(start, end, frequency, float(abs(steady.mean())), float(np.angle(1j * steady.mean())))


def _switch_off_sample(beyond: Array, period: float) -> int:
    """Sample at which a signal falls below zero for good: for at least a period, at full strength."""
    total = np.cumsum(beyond)
    highest = np.maximum.accumulate(total)
    ended = np.flatnonzero(total < highest - 0.5 * period)
    return int(total[: ended[0] if len(ended) else len(total)].argmax())


def _is_same_oscillation(one: Oscillation, other: Oscillation) -> bool:
    """Whether two ridges show one oscillation: they share most of the shorter one, and the wavelet hardly tells their
    frequencies apart."""
    shared = min(one.end, other.end) - max(one.start, other.start)
    shorter = min(one.end - one.start, other.end - other.start)
    return shared > 0.5 * shorter and abs(math.log(one.frequency / other.frequency)) < 0.5 * RELATIVE_BANDWIDTH
