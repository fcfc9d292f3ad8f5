"""What motors and joints can do: torque, range, velocity and acceleration at once."""

import numpy as np

from solvers.rows import Rows
from sot.robot import Robot
from sot.task import Task
from sot.tick import Tick

Array = np.ndarray


class TorqueBounds(Task):
    """Joint torques within the robot's limits.

    Args:
        robot: The robot.
        fraction: Of the limit that may be used.
    """

    on = "torque"
    equality = False
    gives_way = 2

    def __init__(self, robot: Robot, fraction: float = 1.0) -> None:
        super().__init__("TorqueBounds", "N m", "N m", weight=1.0 / float(np.median(robot.effort)))
        self._limit = fraction * robot.effort
        self._A = np.eye(robot.na)
        self.selects = slice(0, robot.na)

    def rows(self, tick: Tick) -> Rows:
        """Rows ``−limit <= τ <= limit``."""
        return self._rows(self._A, -self._limit, self._limit)


class JointBounds(Task):
    """Range, velocity and acceleration of the joints as bounds on the acceleration, Kim (14) in a viable form.

    Args:
        robot: The robot.
        range_margin: Distance kept from the ends of the range, for what the model does not know [rad].
        velocity_fraction: Of the velocity limit that may be used.
    """

    equality = False
    gives_way = 1

    def __init__(self, robot: Robot, range_margin: float = 0.002, velocity_fraction: float = 0.99) -> None:
        super().__init__("JointBounds", "rad/s²", "rad", weight=1.0 / 100.0)
        self._lower, self._upper = robot.lower + range_margin, robot.upper - range_margin
        self._velocity = velocity_fraction * robot.velocity
        self._brake, self._hard = robot.acceleration, robot.acceleration_hard
        self._A = np.hstack([np.zeros((robot.na, 6)), np.eye(robot.na)])
        self.selects = slice(6, robot.nv)

    def rows(self, tick: Tick) -> Rows:
        """Rows on the joint accelerations; `error` is how far each joint is outside its range."""
        q, v = tick.q[7:], tick.v[6:]
        self.error = np.maximum(q - self._upper, 0.0) + np.minimum(q - self._lower, 0.0)
        lower, upper = acceleration_bounds(
            q, v, self._lower, self._upper, self._velocity, self._brake, self._hard, tick.period
        )
        return self._rows(self._A, lower, upper)


def acceleration_bounds(
    q: Array,
    v: Array,
    lower: Array,
    upper: Array,
    velocity: Array,
    brake: Array,
    hard: Array,
    period: float,
) -> tuple[Array, Array]:
    """Accelerations for the next period after which every limit can still be kept, shapes (n,).

    Kim (14) bounds the speed *now* by what can be braked before the end of the range, ``v² <= 2 a (q_max − q)``; over a
    finite period a state that obeys it may leave it, and no acceleration then satisfies all three terms. Here the state
    *after* the period has to be one from which braking for whole periods stops inside the range; that is a quadratic in
    the acceleration, and such a state always has such a successor. A state from which nothing does is led back instead
    of made infeasible: the bounds always admit something.

    Args:
        q, v: Positions and velocities.
        lower, upper: Range.
        velocity: Velocity limits, symmetric.
        brake: Deceleration that is relied upon to stop before the end of the range.
        hard: Acceleration limits, symmetric, not below `brake`.
        period: Time for which the acceleration stays [s].
    """
    # Both ends at once: towards the upper one, and mirrored, towards the lower one.
    distance, speed = np.array([upper - q, q - lower]), np.array([v, -v])
    most = np.minimum((velocity - speed) / period, _approach(distance, speed, brake, period))
    up, down = np.minimum(np.maximum(most, -hard), hard)
    return np.minimum(-down, up), up


def _approach(distance: Array, v: Array, brake: Array, period: float) -> Array:
    """Largest acceleration towards a limit at `distance`, after which it can still be kept; v > 0 is towards it."""
    # With w = v + a T: w² + brake T w = 2 brake (distance − (v + w) T / 2), the larger root. The second term is what
    # braking for whole periods takes beyond w² = 2 brake distance; without it the last of them ends in a kick.
    reach = brake * period
    room = 2.0 * distance - v * period
    wanted = (np.sqrt(np.maximum(reach**2 + brake * room, 0.0)) - reach - v) / period
    if min(room.min(), distance.min()) < 0.0:
        # Nearer than one period's travel: to be no further than the limit after it.
        wanted = np.where(room >= 0.0, wanted, 2.0 * (distance - v * period) / period**2)
        # Beyond the limit: back at a rate that dies out, not harder than one brakes.
        returning = np.maximum((RETURN_RATE * distance - v) / period, -brake)
        wanted = np.where(distance >= 0.0, wanted, returning)
    return wanted


RETURN_RATE = 10.0
"""Rate [1/s] at which a joint that starts outside its range is led back."""
