"""How far a signal swings at each time and frequency: its wavelet scalogram, Ramos section VI-A and Figure 5."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pywt
from numpy.typing import NDArray
from scipy.signal import hilbert

from sot.errors import InputError
from sot.smooth import low_passed

Array = NDArray[np.float64]

WAVELET = "gaus4"  # Gaussian derivative of order 4
SAMPLES_PER_PERIOD = 16.0  # samples in a period of the highest frequency: PyWavelets' short wavelets are coarse
FREQUENCIES_PER_OCTAVE = 24
RELATIVE_BANDWIDTH = 0.873
"""Bandwidth of the wavelet over its frequency, (∫|ψ̂|²)² / ∫|ψ̂|⁴ with ψ̂ = ω⁴ exp(-ω²/4): as many coefficients in a
period are independent."""
TIME_STEP_TOLERANCE = 1e-3  # of a sample: times that differ by more are not evenly spaced


@dataclass(frozen=True, eq=False)
class Scalogram:
    """A signal over time and frequency.

    Attributes:
        times: (T,) [s].
        frequencies: (F,), rising [Hz].
        coefficients: (F, T) complex, in the signal's unit: those of a sine A sin(2π f t + φ) at its frequency f are
            A exp(i (2π f t + φ - π/2)).
    """

    times: Array
    frequencies: Array
    coefficients: NDArray[np.complex128]

    @property
    def rate(self) -> float:
        """Samples a second [Hz]."""
        return float((len(self.times) - 1) / (self.times[-1] - self.times[0]))

    @property
    def power(self) -> Array:
        """Square of the amplitude, (F, T)."""
        return np.abs(self.coefficients) ** 2


def scalogram(t: Array, q: Array, band: tuple[float, float]) -> Scalogram:
    """The continuous wavelet transform of a signal with the Gaussian derivative of order 4.

    Scale a shows frequency f = f_s f_w / a, with f_w measured on a sine (the nominal 0.5 would read 3.0 Hz for 2.7).
    Coefficients are divided by √a, so that sines of equal amplitude count alike at every frequency, and made complex by
    their Hilbert transform: those of a real wavelet vanish twice a period.

    Args:
        t: times, evenly spaced [s], (N,).
        q: signal, (N,), in any unit.
        band: lowest and highest frequency [Hz].

    Returns:
        The scalogram, at no more times than the highest frequency needs.

    Raises:
        InputError: times and values do not match or are no signal, or it is too short or too coarse for the band.
    """
    t, q, rate = _checked_signal(t, q, band)
    step = max(1, int(rate / (SAMPLES_PER_PERIOD * band[1])))
    if step > 1:
        q = low_passed(q, rate, rate / (4.0 * step))[::step]
    frequencies = np.geomspace(*band, max(3, round(FREQUENCIES_PER_OCTAVE * np.log2(band[1] / band[0]))))
    center, gain = _wavelet_centre_and_gain()
    # The signal goes on beyond its ends, turned by 180°, so that neither its value nor its slope jumps there.
    beyond = min(len(q) - 1, round(2.0 * rate / (step * band[0])))
    going_on = np.concatenate([2.0 * q[0] - q[beyond:0:-1], q, 2.0 * q[-1] - q[-2 : -beyond - 2 : -1]])
    coefficients = _wavelet_transform(going_on - going_on.mean(), rate / step * center / frequencies) / gain
    return Scalogram(t[::step], frequencies, coefficients[:, beyond : beyond + len(q)])


def _wavelet_transform(values: Array, scales: Array) -> NDArray[np.complex128]:
    real, _ = pywt.cwt(values, scales, WAVELET, method="fft")
    return hilbert(real / np.sqrt(scales)[:, None], axis=1)


@cache
def _wavelet_centre_and_gain() -> tuple[float, float]:
    """Centre frequency f_w of the wavelet and the gain at it, from the scale at which a sine shows most."""
    samples = 64.0  # in a period
    sine = np.sin(2.0 * np.pi / samples * np.arange(40 * samples))
    scales = samples * np.linspace(0.4, 0.6, 201)
    gains = np.abs(_wavelet_transform(sine, scales)[:, len(sine) // 2])
    best = int(gains.argmax())
    return float(scales[best] / samples), float(gains[best])


def _checked_signal(t: Array, q: Array, band: tuple[float, float]) -> tuple[Array, Array, float]:
    t, q = np.asarray(t, dtype=float), np.asarray(q, dtype=float)
    if t.ndim != 1 or t.shape != q.shape:
        raise InputError(f"a scalogram needs as many times as values, one value each, not {t.shape} and {q.shape}")
    if not (np.isfinite(t).all() and np.isfinite(q).all()):
        raise InputError("a scalogram needs times and values that are finite numbers")
    if not 0.0 < band[0] < band[1]:
        raise InputError(f"a scalogram needs a lowest frequency above 0 and below the highest, not {band} Hz")
    if len(t) < 2 or t[-1] - t[0] < 2.0 / band[0]:
        raise InputError(f"a scalogram from {band[0]:g} Hz on needs a signal of {2.0 / band[0]:.1f} s or more")
    period = (t[-1] - t[0]) / (len(t) - 1)
    if np.abs(t - t[0] - period * np.arange(len(t))).max() > TIME_STEP_TOLERANCE * period:
        raise InputError("a scalogram needs times that rise in even steps")
    if period * band[1] > 0.25:
        raise InputError(f"a scalogram up to {band[1]:g} Hz needs {4.0 * band[1]:.0f} samples a second or more")
    return t, q, 1.0 / period
