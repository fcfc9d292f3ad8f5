"""Frequency responses of a robot on compliant feet: measured by sines, and the pendulum fitted to them."""

from math import log, pi
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.servo.pendulum import Pendulum

Array = np.ndarray

ROBUST_RESIDUAL = 0.1
"""Error of log(y / u), 0.9 dB or 6°, beyond which a frequency counts linearly only."""
LONGEST_DELAY = 0.2
"""Bound of lag and delay in a fit [s]."""
MIN_FREQUENCIES = 6
BENDING_RANGE = 0.5, 3.0
"""Least and largest frequency of the bending that is looked for, in the highest one that was measured."""
BENDING_START = 0.3, 1.2, 0.4
"""Share, frequency in the highest one that was measured, and damping ratio at which the search begins."""
GRID = 9
"""Natural frequencies that are tried between two measured frequencies far apart, and damping ratios."""


class FrequencyResponse(NamedTuple):
    """y / u at frequencies [Hz], ascending: (k,), complex (k,) [m/rad]."""

    frequency: Array
    value: Array


class FitErrors(NamedTuple):
    """Largest errors of a fit: of the gain [dB] and of the phase [deg]."""

    gain_db: float
    phase_deg: float


def sine_coefficients(time: Array, values: Array, frequency: float, pole: complex | None = None) -> complex:
    """Amplitude and phase of a sine in samples: values ≈ Im(a e^{jωt}) + offset + drift, by least squares.

    Args:
        time: of the samples (k,) [s]; of whole periods, or nearly.
        values: (k,).
        frequency: of the sine [Hz].
        pole: of an oscillation that dies out beside it, e^{st}, where the search for it begins [1/s]; None for none.
    """
    angle, middle = 2.0 * pi * frequency * time, time - time.mean()
    lasting = np.column_stack([np.sin(angle), np.cos(angle), np.ones_like(time), middle])

    def with_dying(parts: Array) -> Array:
        dying = np.exp(complex(*parts) * (time - time[0]))
        return np.column_stack([lasting, dying.real, dying.imag])

    def residual(parts: Array) -> Array:
        columns = with_dying(parts)
        left: Array = columns @ np.linalg.lstsq(columns, values, rcond=None)[0] - values
        return left

    columns = lasting
    if pole is not None:
        columns = with_dying(least_squares(residual, [pole.real, pole.imag], x_scale=abs(pole)).x)
    (sine, cosine, *_), *_ = np.linalg.lstsq(columns, values, rcond=None)
    return complex(sine, cosine)


def fit_pendulum(measured: FrequencyResponse, mass: float, length: float) -> Pendulum:
    """The pendulum whose response is nearest to a measured one, in logarithm of gain and phase, robustly.

    All but mass and length are free. The search starts from the best of a grid of natural
    frequencies and damping ratios.

    Raises:
        InputError: too few frequencies, or some without a response.
    """
    frequency, value = measured
    if len(frequency) < MIN_FREQUENCIES or not np.all(np.isfinite(value) & (np.abs(value) > 0.0)):
        raise InputError(f"a pendulum is fitted to {MIN_FREQUENCIES} frequencies or more, each with a response")

    def residual(parameters: Array) -> Array:
        ratio = _pendulum(parameters, mass, length).response(frequency) / value
        logarithm = np.log(ratio)
        return np.concatenate([logarithm.real, logarithm.imag])

    omega = 2.0 * pi * np.geomspace(frequency[0], frequency[-1], GRID * GRID)
    share, highest, zeta = BENDING_START
    bending = (share, log(highest * omega[-1]), log(zeta))
    starts = [
        np.array([log(w), log(zeta), share, 0.5 * share, 0.005, 0.005, *bending])
        for w in omega
        for zeta in np.geomspace(0.01, 0.7, GRID)
        for share in (0.05, 0.3)
    ]
    costs = [float(np.sum(np.minimum(np.abs(residual(start)), 1.0))) for start in starts]
    slowest, fastest = (log(ratio * omega[-1]) for ratio in BENDING_RANGE)
    lower = np.array([log(omega[0]), log(1e-4), 0.0, 0.0, 0.0, 0.0, 0.0, slowest, log(0.01)])
    upper = np.array([log(omega[-1]), log(3.0), 2.0, 2.0, LONGEST_DELAY, LONGEST_DELAY, 3.0, fastest, 0.0])
    best = None
    for k in np.argsort(costs)[:4]:
        found = least_squares(
            residual, np.clip(starts[k], lower + 1e-9, upper - 1e-9), bounds=(lower, upper), loss="soft_l1",
            f_scale=ROBUST_RESIDUAL, x_scale=[0.1, 0.3, 0.1, 0.1, 0.003, 0.003, 0.1, 0.1, 0.3],
        )  # fmt: skip
        best = found if best is None or found.cost < best.cost else best
    assert best is not None
    return _pendulum(best.x, mass, length)


def _pendulum(parameters: Array, mass: float, length: float) -> Pendulum:
    """From log ω_n, log ζ, I and I_u in m l², lag and delay, c, log ω_b and log ζ_b."""
    omega, zeta = np.exp(parameters[:2])
    point = mass * length**2
    inertia = float(parameters[2]) * point
    turning = point + inertia
    return Pendulum(
        mass,
        length,
        float(turning * omega**2 + mass * GRAVITY * length),
        float(2.0 * zeta * omega * turning),
        inertia,
        float(parameters[3]) * point,
        float(parameters[4]),
        float(parameters[5]),
        float(parameters[6]),
        float(np.exp(parameters[7])),
        float(np.exp(parameters[8])),
    )


def fit_errors(pendulum: Pendulum, measured: FrequencyResponse) -> FitErrors:
    """How far a pendulum's response is from a measured one at most."""
    ratio = pendulum.response(measured.frequency) / measured.value
    return FitErrors(
        float(np.max(np.abs(20.0 * np.log10(np.abs(ratio))))), float(np.max(np.abs(np.rad2deg(np.angle(ratio)))))
    )
