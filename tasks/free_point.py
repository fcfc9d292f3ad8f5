"""A link that is led while it is free, and left alone while it supports the robot: E2 and E3 of Otani (23)."""

import numpy as np
import pinocchio as pin

from solvers.rows import Rows
from sot.control.contact import ARRIVAL_ACCELERATION_FADE_POWER
from sot.control.pose import PoseReference
from sot.control.tick import Tick
from tasks.operational_point import OperationalPoint

Array = np.ndarray

RELEASE_TIME = 0.04
"""Time within which a point's acceleration goes over from its contact's demand to its path's [s]: no torque steps."""

_NOTHING = np.zeros(0)


class FreePoint(OperationalPoint):
    """A point follows its reference while no contact with the world that it has is made; else it has no rows. If the
    contact that is off has a `path`, the point follows that one instead.

    What holds a thing is still led: the contact moves the thing along. A path may begin with an acceleration, and the
    point may be beside it: the demand begins with what the contact demanded.
    Arguments are an `OperationalPoint`'s.
    """

    _was_supporting = False
    _release = -np.inf, np.zeros(6)  # when the point left its support, and with which acceleration

    @property
    def reference(self) -> PoseReference:
        """Path of the free point, unless the contact has one."""
        return self._planned_path

    @reference.setter
    def reference(self, reference: PoseReference | Array | pin.SE3) -> None:
        self._planned_path = self._free_path = self._trajectory(reference)

    def rows(self, tick: Tick) -> Rows:
        """Acceleration rows while the point is free, none while it supports."""
        footings = [contact for contact in tick.contacts if contact.point == self.point and contact.is_footing]
        if any(contact.mode != "off" for contact in footings):
            self._was_supporting = True
            return self.no_rows(tick)
        if self._was_supporting:
            self._was_supporting, self._release = False, (tick.t, footings[0].acceleration(tick))
        self._reference = next((contact.path for contact in footings if contact.path is not None), self._free_path)
        return super().rows(tick)

    def no_rows(self, tick: Tick) -> Rows:
        """What the task asks for while it asks for nothing."""
        self.error = _NOTHING
        return self.make_rows(np.zeros((0, tick.system.nv)), _NOTHING, _NOTHING)

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
