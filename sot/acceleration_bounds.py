"""Range, velocity and acceleration as bounds on the acceleration of the next period, Kim (14) in a viable form."""

import numpy as np

from solvers.compiled import compiled

Array = np.ndarray

SOFT_BRAKING_RANGE = 0.015
"""Part of a joint's range that braking gently takes when the joint is fast [rad]; plans leave it to the controller."""
SPEED_LAG = 0.01
"""Time constant of a joint's speed near its limit [s]."""
RETURN_RATE = 10.0
"""Rate [1/s] at which a joint that starts outside its range returns into it."""


class AccelerationBounds:
    """Accelerations for the next period after which every limit can still be kept.

    Kim (14) bounds the speed *now* by what can be braked before the end of the range, ``v² <= 2 a (q_max − q)``; over a
    finite period a state that obeys it may leave it, and no acceleration then satisfies all three terms. Here the state
    *after* the period has to be one from which braking for whole periods stops inside the range; that is a quadratic in
    the acceleration, and such a state always has such a successor. A state from which nothing does is led back instead
    of made infeasible: the bounds always admit something.

    Braking with all that is relied upon, however slow a joint is, hits it: a standing ankle that met the end of its
    range at 0.05 rad/s took the robot's weight twice over, and again where it was faster than commanded, since the sole
    had given way. With `soft`, a speed below ``w = √(2 brake soft)`` is braked in proportion to itself, at
    ``brake v / w``, and dies out; what is too fast comes back as gradually, within ``w / brake``.

    A speed limit that is met with some acceleration stops it within one period, and torques step. With `speed_lag` the
    speed comes near to its limit in proportion to what is left, within about that time.

    Args:
        lower, upper: Range, shapes (n,).
        velocity: Velocity limits, symmetric, shape (n,).
        brake: Deceleration that is relied upon to stop before the end of the range, shape (n,).
        hard: Acceleration limits, symmetric, not below `brake`, shape (n,).
        soft: Part of the range that braking in proportion takes, in the unit of the range.
        speed_lag: Time constant of a speed near its limit [s].

    Attributes:
        outside: How far the last positions were outside the range, shape (n,).
    """

    def __init__(
        self,
        lower: Array,
        upper: Array,
        velocity: Array,
        brake: Array,
        hard: Array,
        soft: float = 0.0,
        speed_lag: float = 0.0,
    ) -> None:
        self._soft, self._speed_lag = soft, speed_lag
        self._limits = np.array([lower, upper, velocity, brake, hard])
        self.outside = np.zeros(len(lower))

    def __call__(self, q: Array, v: Array, period: float) -> tuple[Array, Array]:
        """Smallest and largest acceleration of joints at q, moving with v, for a period [s]; shapes (n,)."""
        low, high, self.outside = _viable_accelerations(q, v, period, self._limits, self._soft, self._speed_lag)
        return low, high


@compiled
def _viable_accelerations(q: Array, v: Array, period: float, limits: Array, soft: float, speed_lag: float) -> Array:
    """Smallest and largest viable accelerations, and how far outside their ranges the joints are, (3, n)."""
    lower, upper, velocity, brake, hard = limits
    out = np.empty((3, len(q)))
    lag = max(period, speed_lag)
    for k in range(len(q)):
        high = max_viable_acceleration(upper[k] - q[k], v[k], period, brake[k], soft)
        low = -max_viable_acceleration(q[k] - lower[k], -v[k], period, brake[k], soft)
        high, low = min(high, (velocity[k] - v[k]) / lag), max(low, -(velocity[k] + v[k]) / lag)
        high, low = min(max(high, -hard[k]), hard[k]), min(max(low, -hard[k]), hard[k])
        out[0, k], out[1, k] = min(low, high), high
        out[2, k] = max(q[k] - upper[k], 0.0) - max(lower[k] - q[k], 0.0)
    return out


@compiled
def max_viable_acceleration(distance: float, v: float, period: float, brake: float, soft: float) -> float:
    """Largest acceleration towards an end of the range that is a distance away, moving towards it with v."""
    # With w = v + a T: w² + brake T w = 2 brake (distance − (v + w) T / 2), the larger root. The second term is what
    # braking for whole periods takes beyond w² = 2 brake distance; without it the last of them is a kick.
    reach, room = brake * period, 2.0 * distance - period * v
    # Below the speed at which that parabola, moved by `soft`, touches a straight line, it goes on along the line.
    lag = np.sqrt(2.0 * soft / brake)
    most = 0.5 * room / (lag + period)
    if most > brake * lag:
        most = np.sqrt(brake * (room - 2.0 * soft) + reach**2) - reach
    most = (most - v) / period
    if distance < 0.0:  # beyond the limit: back at a rate that dies out, without overshoot
        most = (RETURN_RATE / max(1.0, 4.0 * RETURN_RATE * lag) * distance - v) / period
    elif room < 0.0:  # nearer than one period's travel: to be no further than the limit after it
        most = 2.0 * (distance - period * v) / period**2
    # What keeps along that line, and of the rest no more than comes back within the lag.
    along = -min(max(v, 0.0) / (lag + period), brake)
    most = along + (most - along) * period / max(period, lag)
    if distance < 0.0:
        most = max(most, -brake)
    return float(most)
