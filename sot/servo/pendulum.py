"""The inverted pendulum with a compliant joint (IPCJ): how a stiff robot rocks on soft feet, Kim & Oh (26)-(33)."""

from dataclasses import dataclass
from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from sot.gravity import GRAVITY

Array = np.ndarray

NEGLIGIBLE_TIME = 1e-4
"""Lags and delays below this [s] make no state."""


class StateSpace(NamedTuple):
    """ẋ = A x + B u, y = C x + D u; or the same from sample to sample."""

    A: Array
    B: Array
    C: Array
    D: Array

    def response(self, frequencies: Array) -> Array:
        """y / u of a continuous system at frequencies (k,) [Hz], complex (k,)."""
        s = 2j * pi * np.asarray(frequencies)
        x = np.linalg.solve(s[:, None, None] * np.eye(len(self.A)) - self.A, self.B[None])
        y: Array = (self.C @ x + self.D)[:, 0, 0]
        return y


@dataclass(frozen=True)
class Pendulum:
    """A robot as one body that stands on a compliant joint; in one plane, on given feet.

    The reference of the centre of mass is at the angle u from the vertical through the joint, seen from there. The body
    moves there by its legs, upper parts farther than lower ones, with an angular momentum I_u u̇ about the centre of
    mass. The joint gives way by δ and turns the whole body, so that the centre of mass is at θ = u + δ. About the joint

        m l² θ̈ + I δ̈ + I_u ü = m g l θ − K δ − b δ̇,

    and what the joint gives, K δ + b δ̇, is the moment of the weight at the zero-moment point (ZMP):

        y = (K δ + b δ̇) / (m g) = l θ − (m l² θ̈ + I δ̈ + I_u ü) / (m g).

    The body also bends on the servos of the legs that carry it, at several times the pendulum's frequency; its next
    mode adds a share c of its own to the response, which becomes 1 + c s² / (s² + 2 ζ_b ω_b s + ω_b²) times as large.

    Kim & Oh (26) and (28) are this with I = I_u = 0 and the damping on θ̇. Their (27), (31) and (32) are misprinted: the
    lower row of A is (g/l − K/ml², −b/ml²), the zeros are those of s² − g/l, and ω_n² is K/ml² − g/l.

    Attributes:
        mass: m [kg].
        length: l, height of the centre of mass above the joint [m].
        stiffness: K [N m/rad].
        damping: b [N m s/rad].
        inertia: I about the centre of mass [kg m²].
        led_inertia: I_u [kg m²].
        lag: time constant of the sensors and servos [s].
        delay: T [s].
        bending_share: c.
        bending_frequency: ω_b [rad/s].
        bending_damping_ratio: ζ_b.
    """

    mass: float
    length: float
    stiffness: float
    damping: float
    inertia: float = 0.0
    led_inertia: float = 0.0
    lag: float = 0.0
    delay: float = 0.0
    bending_share: float = 0.0
    bending_frequency: float = 0.0
    bending_damping_ratio: float = 0.0

    @property
    def weight(self) -> float:
        """m g [N]."""
        return self.mass * GRAVITY

    @property
    def turning_inertia(self) -> float:
        """m l² + I [kg m²]."""
        return self.mass * self.length**2 + self.inertia

    @property
    def leading_inertia(self) -> float:
        """m l² + I_u [kg m²]."""
        return self.mass * self.length**2 + self.led_inertia

    @property
    def natural_frequency(self) -> float:
        """ω_n [rad/s]; not a number where the joint is too soft to stand on."""
        excess = self.stiffness - self.weight * self.length
        return sqrt(excess / self.turning_inertia) if excess > 0.0 else float("nan")

    @property
    def damping_ratio(self) -> float:
        """ζ."""
        return self.damping / (2.0 * self.natural_frequency * self.turning_inertia)

    @property
    def pole(self) -> complex:
        """−ζ ω_n + j ω_n √(1 − ζ²) [1/s], of a joint that is not overdamped."""
        omega, zeta = self.natural_frequency, self.damping_ratio
        return complex(-zeta * omega, omega * sqrt(max(1.0 - zeta**2, 0.0)))

    @property
    def static_gain(self) -> float:
        """y / u at rest [m/rad]: more than l, since the joint gives way."""
        return self.stiffness * self.length / (self.stiffness - self.weight * self.length)

    @property
    def high_frequency_gain(self) -> float:
        """|y / u| far above ω_n without the joint's damping, lag and delay [m/rad]."""
        return self.stiffness * self.leading_inertia / (self.weight * self.turning_inertia)

    def response(self, frequencies: Array) -> Array:
        """y / u at frequencies (k,) [Hz], complex (k,) [m/rad]: Kim & Oh (31) with inertia, bending, an exact delay."""
        s = 2j * pi * np.asarray(frequencies)
        joint = self.stiffness + self.damping * s
        motion = self.turning_inertia * s**2 + joint - self.weight * self.length
        inverted = self.leading_inertia * s**2 - self.weight * self.length
        numerator, denominator = self.bending_polynomials
        sensed = np.exp(-self.delay * s) / (self.lag * s + 1.0) * np.polyval(numerator, s) / np.polyval(denominator, s)
        y: Array = -joint / self.weight * inverted / motion * sensed
        return y

    @property
    def bending_polynomials(self) -> tuple[Array, Array]:
        """Numerator and denominator of what bending makes of the response, in s."""
        if not self.bending_share > 0.0:
            return np.ones(1), np.ones(1)
        stiffness, damping = self.bending_frequency**2, 2.0 * self.bending_damping_ratio * self.bending_frequency
        return np.array([1.0 + self.bending_share, damping, stiffness]), np.array([1.0, damping, stiffness])

    def filtered_states(self, filter_time: float) -> StateSpace:
        """The pendulum behind a first-order filter of its command, with the moment of a disturbance as second input.

        States: z = δ + c u_f with c = (m l² + I_u) / (m l² + I), ż, the filtered command u_f; then y behind the lag,
        and the delay (Padé's first approximation), where there are any. In z no acceleration of the
        command occurs. Bending is left out: a controller of the sway is slow against it.

        Args:
            filter_time: time constant of the filter [s].
        """
        inertia, weight = self.turning_inertia, self.weight
        c, falling = self.leading_inertia / inertia, weight * self.length
        # δ and δ̇ as rows on (z, ż, u_f) and u.
        deflection, rate = np.array([1.0, 0.0, -c]), np.array([0.0, 1.0, c / filter_time])
        rate_of_input = -c / filter_time
        tilt = deflection + np.array([0.0, 0.0, 1.0])
        acceleration = (falling * tilt - self.stiffness * deflection - self.damping * rate) / inertia
        A = np.vstack([[0.0, 1.0, 0.0], acceleration, [0.0, 0.0, -1.0 / filter_time]])
        B = np.array([[0.0, 0.0], [-self.damping * rate_of_input / inertia, 1.0 / inertia], [1.0 / filter_time, 0.0]])
        C = ((self.stiffness * deflection + self.damping * rate) / weight)[None]
        D = np.array([[self.damping * rate_of_input / weight, 0.0]])
        return self._sensed(StateSpace(A, B, C, D))

    def printed_states(self) -> StateSpace:
        """Kim & Oh (27) and (28) with corrected signs: states θ and θ̇; the command feeds straight through to y."""
        inertia, weight, length = self.mass * self.length**2, self.weight, self.length
        A = np.array([[0.0, 1.0], [GRAVITY / length - self.stiffness / inertia, -self.damping / inertia]])
        B = np.array([[0.0, 0.0], [self.stiffness / inertia, 1.0 / inertia]])
        C = np.array([[self.stiffness / weight, self.damping / weight]])
        return self._sensed(StateSpace(A, B, C, np.array([[-self.stiffness / weight, 0.0]])))

    def _sensed(self, system: StateSpace) -> StateSpace:
        """A system whose output passes through the lag and the delay."""
        for pole, direct in ((self.lag, 0.0), (0.5 * self.delay, -1.0)):
            if pole > NEGLIGIBLE_TIME:
                # x' = (y − x) / τ; the output is x, or 2 x − y for Padé's (1 − τ s) / (1 + τ s).
                A, B, C, D = system
                n = len(A)
                A = np.block([[A, np.zeros((n, 1))], [C / pole, np.full((1, 1), -1.0 / pole)]])
                B = np.vstack([B, D / pole])
                C, D = np.hstack([direct * C, [[1.0 - direct]]]), direct * D
                system = StateSpace(A, B, C, D)
        return system
