"""A damping controller of one plane: pole placement on the pendulum with a compliant joint, Kim & Oh 4.3."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import pi, sqrt

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.servo.pendulum import Pendulum, StateSpace
from sot.servo.pendulum_fit import FrequencyResponse

Array = np.ndarray

FORMS = ("filtered", "paper")
FILTER_TIME = 1.0
"""Time constant of the filter of the command, in √(l / g): 0.28 s for 0.78 m."""
DISTURBANCE_RATE = 0.1
"""Standard deviation by which the moment of a disturbance is taken to wander in 1 s, in m g l."""
ZMP_NOISE = 0.0026
"""Standard deviation of the measured zero-moment point, in l: 2 mm for 0.78 m."""
MIN_LAG = 1e-3
"""Least lag, and half of the least delay, that a design takes the robot to have [s]."""
MIN_MARGIN = 0.5
"""Least distance of the loop's measured response from the point where it would oscillate, min |1 + L|."""


@dataclass(frozen=True, eq=False)
class DampingDesign:
    """The controller of one plane on given feet, from sample to sample.

    Each tick it corrects its estimate x of the pendulum's states by the measured zero-moment point y, and commands

        x = x⁻ + correction (y − C x⁻ − D u⁻),   u = −feedback x,   x⁻ next = A x + B u.

    Attributes:
        pendulum: as it was identified.
        damping_ratio: that is asked for.
        form: one of `FORMS`: "filtered", the command passes through a filter that is one of the states; or "paper",
            Kim & Oh's own, whose command goes straight to the joints.
        period: of the control [s].
        system: A (n, n), B (n, 1), C (1, n), D (1, 1); the moment of a disturbance is the last state of "filtered".
        feedback: (1, n).
        correction: (n, 1).
        reference: what of the states (1, n) is the reference of the centre of mass, the angle seen from the joint.
    """

    pendulum: Pendulum
    damping_ratio: float
    form: str
    period: float
    system: StateSpace = field(repr=False)
    feedback: Array = field(repr=False)
    correction: Array = field(repr=False)
    reference: Array = field(repr=False)

    def response(self, frequencies: Array) -> Array:
        """Reference over measured zero-moment point at frequencies (k,) [Hz], complex (k,) [rad/m]."""
        A, B, C, D = self.controller
        z = np.exp(2j * pi * np.asarray(frequencies) * self.period)
        value: Array = (C @ np.linalg.solve(z[:, None, None] * np.eye(len(A)) - A, B[None]) + D)[:, 0, 0]
        return value

    @property
    def controller(self) -> StateSpace:
        """The controller from sample to sample, measured zero-moment point in, reference out; its states are x⁻, u⁻."""
        A, B, C, D = self.system
        corrected = np.hstack([np.eye(len(A)) - self.correction @ C, -self.correction @ D])
        ahead = np.vstack([A - B @ self.feedback, -self.feedback])
        return StateSpace(
            ahead @ corrected, ahead @ self.correction, self.reference @ corrected, self.reference @ self.correction
        )

    def margin(self, measured: FrequencyResponse) -> float:
        """Least |1 + L| over a measured response of the robot; −1 if the loop is unstable, by Nyquist's criterion.

        The robot is stable by itself. A controller need not be, as the paper's form shows: then 1 + L has to turn about
        the origin once for each unstable pole.
        """
        frequencies = _dense_frequencies(measured)
        difference = 1.0 - self._dense(measured) * self.response(frequencies)
        # At rest L is real, and half of the turns are at negative frequencies.
        turned = np.diff(np.unwrap(np.angle(np.append(difference.real[0] + 0j, difference)))).sum()
        unstable = np.count_nonzero(np.abs(np.linalg.eigvals(self.controller.A)) > 1.0)
        return float(np.abs(difference).min()) if abs(turned - pi * unstable) < 0.5 * pi else -1.0

    def _dense(self, measured: FrequencyResponse) -> Array:
        """The measured response between its frequencies: the pendulum's, times what it is off, interpolated."""
        frequencies = _dense_frequencies(measured)
        off = measured.value / self.pendulum.response(measured.frequency)
        logarithm = [np.log(np.abs(off)), np.unwrap(np.angle(off))]
        gain, phase = (np.interp(np.log(frequencies), np.log(measured.frequency), part) for part in logarithm)
        value: Array = self.pendulum.response(frequencies) * np.exp(gain + 1j * phase)
        return value


def _dense_frequencies(measured: FrequencyResponse) -> Array:
    return np.geomspace(measured.frequency[0], measured.frequency[-1], 40 * len(measured.frequency))


def design_damping(pendulum: Pendulum, damping_ratio: float, period: float, form: str = "filtered") -> DampingDesign:
    """Move the pendulum's poles to a damping ratio at its natural frequency; all other poles stay, Kim & Oh (33).

    Args:
        pendulum: as it was identified.
        damping_ratio: asked for, 0 to 1.
        period: of the control [s].
        form: one of `FORMS`.

    Raises:
        InputError: a ratio that is none, no such form, or a pendulum that cannot stand.
    """
    if not 0.0 < damping_ratio <= 1.0:
        raise InputError(f"damping ratio {damping_ratio:g}: give more than 0, and 1 at most")
    if form not in FORMS:
        raise InputError(f"unknown form '{form}': choose one of {', '.join(FORMS)}")
    if not pendulum.natural_frequency > 0.0:
        raise InputError(f"a joint of {pendulum.stiffness:g} N m/rad is too soft to stand on")
    fall = sqrt(pendulum.length / GRAVITY)
    filtered = form == "filtered"
    # Every design has a lag and a delay among its states, so that those of two supports can be blended.
    sensed = replace(pendulum, lag=max(pendulum.lag, MIN_LAG), delay=max(pendulum.delay, 2.0 * MIN_LAG))
    system = sensed.filtered_states(FILTER_TIME * fall) if filtered else sensed.printed_states()
    n = len(system.A)
    wander = DISTURBANCE_RATE * pendulum.weight * pendulum.length
    if filtered:  # a moment that wanders, as a state
        A = np.block([[system.A, system.B[:, 1:]], [np.zeros((1, n + 1))]])
        B = np.vstack([system.B[:, :1], [[0.0]]])
        noise = np.zeros(n + 1)
        noise[-1] = wander**2
        system = StateSpace(A, B, np.hstack([system.C, [[0.0]]]), system.D[:, :1])
    else:  # a moment that is noise
        noise = (wander * fall * system.B[:, 1]) ** 2
        system = StateSpace(system.A, system.B[:, :1], system.C, system.D[:, :1])
    sampled, covariance = _sampled(system, np.diag(noise), period)
    placed = 3 if filtered else 2  # what is behind these states, lag and delay, keeps its poles without feedback
    feedback = np.zeros((1, len(sampled.A)))
    poles = _placed_poles(system.A[:placed, :placed], pendulum.natural_frequency, damping_ratio)
    feedback[:, :placed] = _ackermann(sampled.A[:placed, :placed], sampled.B[:placed], np.exp(np.array(poles) * period))
    reference = np.eye(1, len(sampled.A), 2) if filtered else -feedback
    correction = _kalman_gain(sampled, covariance, (ZMP_NOISE * pendulum.length) ** 2)
    return DampingDesign(pendulum, damping_ratio, form, period, sampled, feedback, correction, reference)


def checked_margin(design: DampingDesign, measured: FrequencyResponse, what: str, least: float = MIN_MARGIN) -> float:
    """The margin of a design on a measured response.

    Raises:
        InputError: it is less than the least; `what` says which design.
    """
    margin = design.margin(measured)
    if margin < least:
        why = "the loop is unstable" if margin < 0.0 else f"min |1 + L| is {margin:.2f}, less than {least:g}"
        raise InputError(
            f"{what}: damping ratio {design.damping_ratio:g} in the {design.form} form is refused, {why} on the "
            "measured response"
        )
    return margin


def _placed_poles(A: Array, natural_frequency: float, damping_ratio: float) -> Sequence[complex]:
    """The poles of a system, its oscillation with another damping ratio."""
    own = np.linalg.eigvals(A)
    # The pendulum's pair is the one whose product is nearest to ω_n²; a filter's pole is real and alone.
    pair = np.argsort(np.where(np.abs(own.imag) > 0.0, 0.0, 1.0), kind="stable")[:2]
    kept = [complex(pole) for k, pole in enumerate(own) if k not in pair]
    turned = natural_frequency * (-damping_ratio + 1j * sqrt(1.0 - damping_ratio**2))
    return [turned, turned.conjugate(), *kept]


def _ackermann(A: Array, B: Array, poles: Array) -> Array:
    """Feedback (1, n) that gives A − B K these poles."""
    n = len(A)
    controllability = np.hstack([np.linalg.matrix_power(A, k) @ B for k in range(n)])
    polynomial = np.zeros((n, n))
    for coefficient in np.poly(poles).real:
        polynomial = polynomial @ A + coefficient * np.eye(n)
    feedback: Array = np.linalg.solve(controllability.T, np.eye(n)[:, -1])[None] @ polynomial
    return feedback


def _sampled(system: StateSpace, noise: Array, period: float) -> tuple[StateSpace, Array]:
    """A system whose input is held over each period, and the covariance of its noise from sample to sample."""
    n, m = len(system.A), system.B.shape[1]
    held = expm(period * np.block([[system.A, system.B], [np.zeros((m, n + m))]]))
    # Van Loan: the noise of a period.
    both = expm(period * np.block([[-system.A, noise], [np.zeros((n, n)), system.A.T]]))
    covariance = both[n:, n:].T @ both[:n, n:]
    return StateSpace(held[:n, :n], held[:n, n:], system.C, system.D), 0.5 * (covariance + covariance.T)


def _kalman_gain(system: StateSpace, covariance: Array, noise: float) -> Array:
    """The steady gain (n, 1) by which a filter corrects its states by a measurement of a variance."""
    P = solve_discrete_are(system.A.T, system.C.T, covariance, np.array([[noise]]))
    gain: Array = P @ system.C.T / (system.C @ P @ system.C.T + noise)
    return gain
