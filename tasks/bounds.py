"""Limits of motors and joints: torque and its rate; range, velocity and acceleration together."""

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Rows
from sot.acceleration_bounds import SOFT_BRAKING_RANGE, SPEED_LAG, AccelerationBounds
from sot.control.task import Task
from sot.control.tick import Tick
from sot.robots.robot import Robot

Array = np.ndarray

RANGE_MARGIN = 0.002
"""Distance that joints keep from the ends of their range [rad]."""


class TorqueBounds(Task):
    """Joint torques within the robot's limits.

    Args:
        robot: The robot.
        fraction: Part of the limits that may be used.
    """

    variable = "torque"
    equality = False
    gives_way = 2

    def __init__(self, robot: Robot, fraction: float = 1.0) -> None:
        super().__init__("TorqueBounds", "N m", "N m", weight=1.0 / float(np.median(robot.effort)))
        self.labels = robot.joints
        self._upper = fraction * robot.effort
        self._lower = -self._upper
        self._A = np.eye(robot.na)
        self.selects = slice(0, robot.na)

    def rows(self, tick: Tick) -> Rows:
        """Rows ``−limit <= τ <= limit``."""
        return self.make_rows(self._A, self._lower, self._upper)


class TorqueRateBounds(Task):
    """Joint torques that change no faster than drives follow.

    The optimum of strict levels is not continuous in the state: where another set of limits becomes the binding one,
    the load can go from one way of being shared to another within a tick. A posture can wait for a few ticks; balance
    and limits of joints cannot, so that rates are optional.

    Args:
        robot: The robot.
        rise_time: Time from no torque to a joint's limit [s].
    """

    variable = "torque"
    equality = False
    optional = True

    def __init__(self, robot: Robot, rise_time: float = 0.02) -> None:
        super().__init__("TorqueRateBounds", "N m", "N m", weight=1.0 / float(np.median(robot.effort)))
        self.labels = robot.joints
        self._rate = robot.effort / rise_time
        self._A = np.eye(robot.na)
        self._lower, self._upper = np.full(robot.na, -np.inf), np.full(robot.na, np.inf)
        self.selects = slice(0, robot.na)

    def rows(self, tick: Tick) -> Rows:
        """Rows about the torque that was commanded a tick ago, without bounds before there was one."""
        if tick.torque is None:
            self._lower.fill(-np.inf)
            self._upper.fill(np.inf)
        else:
            _write_bounds_about(tick.torque, self._rate, tick.period, self._lower, self._upper)
        return self.make_rows(self._A, self._lower, self._upper)


class JointBounds(Task):
    """Range, velocity and acceleration of the joints as bounds on the acceleration, Kim (14) in a viable form.

    Args:
        robot: The robot.
        range_margin: Distance kept from the ends of the range, for what the model does not know, of all joints or each
            (na,) [rad].
        velocity_fraction: Part of the velocity limits that may be used.
    """

    equality = False
    gives_way = 1

    def __init__(
        self, robot: Robot, range_margin: float | Array = RANGE_MARGIN, velocity_fraction: float = 0.99
    ) -> None:
        super().__init__("JointBounds", "rad/s²", "rad", weight=1.0 / 100.0)
        self.labels = robot.joints
        self._bounds = AccelerationBounds(
            robot.lower + range_margin,
            robot.upper - range_margin,
            velocity_fraction * robot.velocity,
            robot.acceleration,
            robot.acceleration_hard,
            SOFT_BRAKING_RANGE,
            SPEED_LAG,
        )
        self._A = np.hstack([np.zeros((robot.na, 6)), np.eye(robot.na)])
        self.selects = slice(6, robot.nv)

    def rows(self, tick: Tick) -> Rows:
        """Rows on the joint accelerations; `error` is how far each joint is outside its range."""
        lower, upper = self._bounds(tick.joint_positions, tick.joint_velocities, tick.period)
        self.error = self._bounds.outside
        return self.make_rows(self._A, lower, upper)


@compiled
def _write_bounds_about(torque: Array, rate: Array, period: float, lower: Array, upper: Array) -> None:
    """Bounds that leave the torques, the robot's first, room for a period at a rate."""
    for k in range(len(rate)):
        lower[k], upper[k] = torque[k] - period * rate[k], torque[k] + period * rate[k]
