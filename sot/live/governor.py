"""A motion that follows targets as fast as range, velocity, acceleration and jerk allow, never stretching time."""

import numpy as np
from numpy.typing import NDArray

from solvers.compiled import compiled
from sot.acceleration_bounds import AccelerationBounds
from sot.motion.body.limits import Limits
from sot.robots.robot import Robot

Array = NDArray[np.float64]

APPROACH_RATE = 12.0
"""Rate at which an error dies out while it is small [1/s]."""
VELOCITY_GAIN = 48.0
"""Rate at which the velocity goes to the wanted one [1/s]: four times the other, critically damped."""
BRAKING_SHARE = 0.65
"""Share of the acceleration limit that is relied upon to stop at a target or at the end of the range."""
USABLE_VELOCITY_SHARE = 0.96
"""Share of the velocity limits that is gone for: an acceleration does not end at once."""
END_MARGIN = 0.01
"""Part at the ends of a joint's range where no target is put [rad]: bounds that act all the time make it tremble."""
JERK_TIME = 0.03
"""Time in which an acceleration goes from nothing to its limit [s]."""
MAX_HIP_SPEED, MAX_HIP_ACCELERATION = 1.0, 3.0
"""Bounds of the hips' velocity [m/s] and acceleration [m/s²]."""
MAX_PELVIS_SPEED, MAX_PELVIS_ACCELERATION = 4.0, 6.0
"""Bounds of the pelvis' velocity [rad/s] and acceleration [rad/s²]: the whole upper body turns with it."""
MAX_CHEST_ACCELERATION = 8.0
"""The same of the joints below the chest, which carry arms and head."""


class Governor:
    """State y, ẏ, ÿ (nv,) of a motion that goes after targets; see `sot.motion.body.coordinates` for y.

    The wanted velocity is the target's, and that with which the error can still be braked away,

        v* = ẏ_t + sign(e) min(λ |e|, √(2 b |e|)),    ÿ* = k (v* − ẏ),

    and ÿ* is kept within Kim (14) in its viable form and changes by no more than the jerk allows.

    Args:
        robot: who moves.
        limits: of the coordinates y.
        start: coordinates to start from, at rest (nv,).
        period: between its steps [s].
    """

    def __init__(self, robot: Robot, limits: Limits, start: Array, period: float) -> None:
        self.y, self.dy, self.ddy = start.copy(), np.zeros_like(start), np.zeros_like(start)
        self._period = period
        velocity, acceleration = USABLE_VELOCITY_SHARE * limits.velocity, limits.acceleration.copy()
        velocity[:3], acceleration[:3] = MAX_HIP_SPEED, MAX_HIP_ACCELERATION
        velocity[3:6], acceleration[3:6] = MAX_PELVIS_SPEED, MAX_PELVIS_ACCELERATION
        chest = 6 + np.array(robot.groups["chest"], dtype=int)
        acceleration[chest] = np.minimum(acceleration[chest], MAX_CHEST_ACCELERATION)
        self._lower, self._upper, self._velocity, self._acceleration = (
            limits.lower,
            limits.upper,
            velocity,
            acceleration,
        )
        self._bounds = AccelerationBounds(
            limits.lower, limits.upper, velocity, BRAKING_SHARE * acceleration, acceleration
        )

    def step(self, target: Array, velocity: Array, greatest_height: float = np.inf) -> None:
        """Go on by a period towards a target (nv,) that moves with a velocity (nv,), the base below a height [m]."""
        self._bounds.upper[2] = greatest_height
        rate = self.dy + 0.5 * JERK_TIME * self.ddy  # once the acceleration of now has come to an end
        low, high = self._bounds(self.y + JERK_TIME * rate, rate, self._period)
        wanted = _wanted_accelerations(
            self.y,
            self.dy,
            self.ddy,
            np.clip(target, self._lower + END_MARGIN, self._upper - END_MARGIN),
            np.clip(velocity, -self._velocity, self._velocity),
            low,
            high,
            self._acceleration,
        )
        T, change = self._period, self._acceleration * (self._period / JERK_TIME)
        curve = np.clip(wanted, self.ddy - change, self.ddy + change)
        self.y = self.y + T * self.dy + T**2 * (self.ddy / 3.0 + curve / 6.0)
        self.dy = self.dy + 0.5 * T * (self.ddy + curve)
        self.ddy = curve


@compiled
def _wanted_accelerations(
    y: Array, dy: Array, ddy: Array, target: Array, velocity: Array, low: Array, high: Array, acceleration: Array
) -> Array:
    """The accelerations (nv,) that go after the targets within bounds."""
    wanted = np.empty_like(y)
    for k in range(len(y)):
        brake = BRAKING_SHARE * acceleration[k]
        # what the velocity will be once the acceleration of now has come to an end
        ahead = dy[k] - velocity[k] + 0.5 * ddy[k] * JERK_TIME
        error = target[k] - y[k]
        size = abs(error)
        bend = brake / APPROACH_RATE**2  # where the root takes over from the line, with the same slope
        speed = APPROACH_RATE * size if size < bend else np.sqrt(2.0 * brake * (size - 0.5 * bend))
        wanted[k] = min(max(VELOCITY_GAIN * ((speed if error > 0.0 else -speed) - ahead), low[k]), high[k])
    return wanted
