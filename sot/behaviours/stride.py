"""The path of a swinging foot to a foothold that may still change."""

from typing import Any

import numpy as np

from solvers.compiled import compiled
from sot.control.pose import Pose

Array = np.ndarray

DESCENT_SPEED = 0.1
DESCENT_RAMP_TIME = 0.03
"""Speed at which a late foot is lowered [m/s], and the time in which it reaches that speed [s]."""
LANDING_DEPTH = 0.005
"""Depth below the floor at which the path ends, so that the foot does not hover above it [m]."""
BUMP_CURVATURE = 19.2
"""Greatest second derivative of the bump over the share of the time, upward, by its height."""
PEAK_SAMPLES = 9
"""Times at which the rest of a path is looked at for its peaks."""


class Stride:
    """Path of a foot that leaves the floor and lands at rest at a fixed time: ``t -> Pose``.

    It is led a little into the floor, so as to land in time. Over the floor it follows quintic polynomials, from what
    it does when it is led elsewhere; above it a bump. It turns about the vertical alone.

    Args:
        start: Where its point stands, shape (3,) [m].
        rotation: How it is turned, shape (3, 3).
        lift, land: When it leaves the floor, and when it is back [s].
        height: Of the bump [m].
        ground: Height of what it lands on [m].
    """

    def __init__(
        self, start: Array, rotation: Array, lift: float, land: float, height: float, ground: float = 0.0
    ) -> None:
        self.lift, self.land, self._height = lift, land, height
        self._rotation, self._floor, self._ground = np.array(rotation, order="C"), float(start[2]), ground
        self._coefficients_from, self._coefficients = lift, np.zeros((6, 3))
        self._coefficients[0, :2] = self.landing_place = start[:2].copy()

    def redirect(self, t: float, place: Array, turn: float = 0.0) -> None:
        """Change the landing place (2,) [m], and the turn from the start to it [rad], from a time on [s]."""
        t = max(t, self.lift)
        if t < self.land:
            self._coefficients, self._coefficients_from, self.landing_place = (
                quintic_to_rest(*self._horizontal_state(t), np.append(place, turn), self.land - t),
                t,
                place.copy(),
            )

    def peak_rates(self, t: float, place: Array, turn: float) -> tuple[float, float]:
        """Greatest speed of the turn [rad/s] and horizontal acceleration [m/s²] if it were redirected at a time [s]."""
        span = self.land - max(t, self.lift)
        coefficients = quintic_to_rest(*self._horizontal_state(self.land - span), np.append(place, turn), span)
        curves = [value_and_derivatives(coefficients, x) for x in np.linspace(0.0, span, PEAK_SAMPLES)]
        return max(abs(float(rate[2])) for _, rate, _ in curves), max(float(np.hypot(*c[:2])) for _, _, c in curves)

    def __call__(self, t: float) -> Pose:
        """Pose of the foot at a time [s]; lower and lower once it should have landed."""
        return Pose(
            *_stride_pose(
                *(self._coefficients, self._coefficients_from, self._rotation, self._floor, self._ground),
                *(self._height, self.lift, self.land, t),
            )
        )

    def _horizontal_state(self, t: float) -> tuple[Array, Array, Array]:
        """Horizontal position and turn, their velocity and acceleration at a time [s], (3,) each."""
        return value_and_derivatives(self._coefficients, t - self._coefficients_from)


def bump(s: Any) -> Any:
    """A stride's bump of unit height over its shares s (0 to 1), an array or a number."""
    return 64.0 * (s * (1.0 - s)) ** 3


def bump_curve(s: Any) -> Any:
    """The second derivative of a stride's bump of unit height over its shares s (0 to 1), an array or a number."""
    r = s * (1.0 - s)
    return 384.0 * r * ((1.0 - 2.0 * s) ** 2 - r)


@compiled
def _stride_pose(
    coefficients: Array,
    since: float,
    rotation: Array,
    floor: float,
    ground: float,
    height: float,
    lift: float,
    land: float,
    t: float,
) -> tuple[Array, Array, Array, Array]:
    """The `Pose` of a stride at a time [s]; coefficients are those of the time since a time."""
    at, rate, second = value_and_derivatives(coefficients, min(max(t, lift), land) - since)
    span = land - lift
    s = min(max((t - lift) / span, 0.0), 1.0)
    r = s * (1.0 - s)
    position = np.array((at[0], at[1], floor + 64.0 * height * r**3))
    velocity, acceleration = np.zeros(6), np.zeros(6)
    velocity[:2], acceleration[:2], velocity[5], acceleration[5] = rate[:2], second[:2], rate[2], second[2]
    velocity[2] = 192.0 * height * r**2 * (1.0 - 2.0 * s) / span
    acceleration[2] = height * 384.0 * r * ((1.0 - 2.0 * s) ** 2 - r) / span**2
    _raise(position, velocity, acceleration, ground - floor - LANDING_DEPTH, t - lift, span)
    _lower(position, velocity, t - land)
    cosine, sine, turned = np.cos(at[2]), np.sin(at[2]), rotation.copy()
    for k in range(3):
        turned[0, k] = cosine * rotation[0, k] - sine * rotation[1, k]
        turned[1, k] = sine * rotation[0, k] + cosine * rotation[1, k]
    return position, turned, velocity, acceleration


def lowered_pose(pose: Pose, late: float) -> Pose:
    """A pose on the floor, lowered at a steady speed for a foot that is late [s] and has not touched down yet."""
    if late < 0.0:
        return pose
    position, velocity = pose.position.copy(), pose.velocity.copy()
    _lower(position, velocity, late)
    return pose._replace(position=position, velocity=velocity)


def raised_pose(pose: Pose, by: float, t: float, span: float) -> Pose:
    """A pose at a time into a step [s], raised along a minimum-jerk curve so that the step ends higher [m]."""
    position, velocity, acceleration = pose.position.copy(), pose.velocity.copy(), pose.acceleration.copy()
    _raise(position, velocity, acceleration, by, t, span)
    return Pose(position, pose.rotation, velocity, acceleration)


@compiled
def _lower(position: Array, velocity: Array, late: float) -> None:
    """See `lowered_pose`."""
    if late >= 0.0:
        speed = DESCENT_SPEED * min(late / DESCENT_RAMP_TIME, 1.0)
        is_ramp = late < DESCENT_RAMP_TIME
        position[2] -= 0.5 * speed * late if is_ramp else DESCENT_SPEED * (late - 0.5 * DESCENT_RAMP_TIME)
        velocity[2] -= speed


@compiled
def _raise(position: Array, velocity: Array, acceleration: Array, by: float, t: float, span: float) -> None:
    """See `raised_pose`."""
    s = min(max(t / span, 0.0), 1.0)
    r = s * (1.0 - s)
    position[2] += by * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    velocity[2] += by * 30.0 * r**2 / span
    acceleration[2] += by * 60.0 * r * (1.0 - 2.0 * s) / span**2


@compiled
def value_and_derivatives(coefficients: Array, x: float) -> tuple[Array, Array, Array]:
    """Values, first and second derivatives (n,) of polynomials with coefficients (6, n), the constant ones first."""
    count = coefficients.shape[1]
    value, rate, second = np.zeros(count), np.zeros(count), np.zeros(count)
    for n in range(count):
        for k in range(5, -1, -1):
            value[n] = value[n] * x + coefficients[k, n]
        for k in range(5, 0, -1):
            rate[n] = rate[n] * x + k * coefficients[k, n]
        for k in range(5, 1, -1):
            second[n] = second[n] * x + k * (k - 1) * coefficients[k, n]
    return value, rate, second


def quintic_to_rest(at: Array, rate: Array, second: Array, to: Array, span: float) -> Array:
    """Coefficients (6, n) of polynomials that begin with places, velocities and accelerations (n,) and end at rest."""
    rest = to - at - span * rate - 0.5 * span**2 * second
    slower, slack = -rate - span * second, -second
    return np.array(
        [
            at,
            rate,
            0.5 * second,
            10.0 * rest / span**3 - 4.0 * slower / span**2 + 0.5 * slack / span,
            -15.0 * rest / span**4 + 7.0 * slower / span**3 - slack / span**2,
            6.0 * rest / span**5 - 3.0 * slower / span**4 + 0.5 * slack / span**3,
        ]
    )
