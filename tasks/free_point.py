"""A link that is led while it is free, and left alone while it supports the robot: E2 and E3 of Otani (23)."""

import numpy as np
import pinocchio as pin

from solvers.rows import Rows
from sot.control.contact import ARRIVAL_ACCELERATION_FADE_POWER
from sot.control.pose import AXES, PoseReference
from sot.control.tick import Tick
from sot.robots.robot import Robot
from sot.robots.system import System
from tasks.operational_point import OperationalPoint

Array = np.ndarray

RELEASE_TIME = 0.04
"""Time within which a point's acceleration goes over from its contact's demand to its path's [s]: no torque steps."""


class FreePoint(OperationalPoint):
    """A point follows its reference while no contact with the world that it has is made; else it has no rows.

    What holds a thing is still led: the contact moves the thing along. A path may begin with an acceleration, and the
    point may be beside it: the demand begins with what the contact demanded.

    Args:
        robot, point, reference, axes, kp, kd, weight, name: As for an `OperationalPoint`.
    """

    def __init__(
        self,
        robot: Robot | System,
        point: str,
        reference: PoseReference | Array | pin.SE3,
        axes: str = AXES,
        kp: float = 100.0,
        kd: float | None = None,
        weight: float = 1.0,
        name: str | None = None,
    ) -> None:
        super().__init__(robot, point, reference, axes, kp, kd, weight, name or f"FreePoint {point}")
        self._was_supporting, self._release = False, (-np.inf, np.zeros(6))  # when it left, with which acceleration
        self._no_error, self._no_rows = np.zeros(0), np.zeros((0, robot.nv))

    def rows(self, tick: Tick) -> Rows:
        """Acceleration rows while the point is free, none while it supports."""
        footings = [contact for contact in tick.contacts if contact.point == self.point and contact.is_footing]
        if any(contact.mode != "off" for contact in footings):
            self._was_supporting = True
            return self.no_rows()
        if self._was_supporting:
            self._was_supporting, self._release = False, (tick.t, footings[0].acceleration(tick))
        return super().rows(tick)

    def no_rows(self) -> Rows:
        """What the task asks for while it asks for nothing."""
        self.error = self._no_error
        return self.make_rows(self._no_rows, self._no_error, self._no_error)

    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """As for an `OperationalPoint`, beginning with the acceleration that the contact demanded."""
        error, rate, J, drift, feedforward = super().observe(tick)
        start, left = self._release
        share = 1.0 - (tick.t - start) / RELEASE_TIME
        if share > 0.0:
            feedforward = feedforward + share**ARRIVAL_ACCELERATION_FADE_POWER * (
                left[self.selected] - feedforward - self.kp * error - self.kd * rate
            )
        return error, rate, J, drift, feedforward
