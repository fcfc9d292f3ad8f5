"""The path of a swinging foot to a foothold that may still change."""

from typing import Any

import numpy as np
import pinocchio as pin

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
UPWARD = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


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
        self._rotation, self._floor, self._ground = rotation.copy(), float(start[2]), ground
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
        at, rate, second = self._horizontal_state(min(max(t, self.lift), self.land))
        span = self.land - self.lift
        s = min(max((t - self.lift) / span, 0.0), 1.0)
        r = s * (1.0 - s)
        position = np.array([at[0], at[1], self._floor + 64.0 * self._height * r**3])
        velocity, acceleration = np.zeros(6), np.zeros(6)
        velocity[:2], acceleration[:2], velocity[5], acceleration[5] = rate[:2], second[:2], rate[2], second[2]
        velocity[2] = 192.0 * self._height * r**2 * (1.0 - 2.0 * s) / span
        acceleration[2] = self._height * bump_curve(s) / span**2
        rotation = pin.utils.rotate("z", float(at[2])) @ self._rotation if at[2] else self._rotation
        over = Pose(position, rotation, velocity, acceleration)
        return lowered_pose(
            raised_pose(over, self._ground - self._floor - LANDING_DEPTH, t - self.lift, span), t - self.land
        )

    def _horizontal_state(self, t: float) -> tuple[Array, Array, Array]:
        """Horizontal position and turn, their velocity and acceleration at a time [s], (3,) each."""
        return value_and_derivatives(self._coefficients, t - self._coefficients_from)


def bump_curve(s: Any) -> Any:
    """The second derivative of a stride's bump of unit height over its shares s (0 to 1), an array or a number."""
    r = s * (1.0 - s)
    return 384.0 * r * ((1.0 - 2.0 * s) ** 2 - r)


def lowered_pose(pose: Pose, late: float) -> Pose:
    """A pose on the floor, lowered at a steady speed for a foot that is late [s] and has not touched down yet."""
    if late < 0.0:
        return pose
    speed = DESCENT_SPEED * min(late / DESCENT_RAMP_TIME, 1.0)
    depth = 0.5 * speed * late if late < DESCENT_RAMP_TIME else DESCENT_SPEED * (late - 0.5 * DESCENT_RAMP_TIME)
    return pose._replace(position=pose.position - depth * UPWARD[:3], velocity=pose.velocity - speed * UPWARD)


def raised_pose(pose: Pose, by: float, t: float, span: float) -> Pose:
    """A pose at a time into a step [s], raised along a minimum-jerk curve so that the step ends higher [m]."""
    s = min(max(t / span, 0.0), 1.0)
    r = s * (1.0 - s)
    return pose._replace(
        position=pose.position + by * s**3 * (10.0 - 15.0 * s + 6.0 * s * s) * UPWARD[:3],
        velocity=pose.velocity + by * 30.0 * r**2 / span * UPWARD,
        acceleration=pose.acceleration + by * 60.0 * r * (1.0 - 2.0 * s) / span**2 * UPWARD,
    )


def value_and_derivatives(coefficients: Array, x: float) -> tuple[Array, Array, Array]:
    """Values, first and second derivatives (n,) of polynomials with coefficients (6, n), the constant ones first."""
    powers = np.arange(6)
    rows = [x**powers, powers[1:] * x ** powers[:-1], (powers[2:] * powers[1:-1]) * x ** powers[:-2]]
    return rows[0] @ coefficients, rows[1] @ coefficients[1:], rows[2] @ coefficients[2:]


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
