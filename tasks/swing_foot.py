"""A foot on its way from one foothold to the next."""

import numpy as np

from solvers.rows import Rows
from sot.behaviours.stride import lowered_pose, raised_pose
from sot.control.contact import LEAD
from sot.control.pose import Pose
from sot.control.tick import Tick
from sot.motion.feet.footfalls import Footfalls
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from tasks.operational_point import OperationalPoint

Array = np.ndarray

RELEASE = 0.04
"""Time within which a foot is led over from what its contact asked for to its path [s]: no joint's torque steps."""


class SwingFoot(OperationalPoint):
    """Moves a foot along a motion for as long as its contact is off; a foot that stands is not asked for anything. The
    `way` of the contact, if it has one, goes before the motion's.

    A path may leave the floor with an acceleration, and a foot not be where the path has it: what the foot is asked for
    begins with what its contact asked for. Once the motion has the foot on the floor, and the contact is still off, it
    is lowered at a steady speed.

    Args:
        robot: The robot.
        foot: One of its feet.
        motion: What it does.
        kp, kd, weight: As for `MotionTask`.
    """

    def __init__(
        self, robot: Robot, foot: str, motion: Motion, kp: float = 200.0, kd: float = 28.0, weight: float = 1.0
    ) -> None:
        super().__init__(robot, foot, motion.pose(foot), kp=kp, kd=kd, weight=weight, name=f"SwingFoot {foot}")
        self._planned = self._reference
        self._reference = self._lowered
        self._stances = Footfalls(motion.phases, foot)
        # Half a millimetre by which a fitted path ends above the floor makes a foot late by tens of milliseconds.
        heights = [(stance.start, float(stance.pose.translation[2])) for stance in self._stances.stances]
        self._missing = {start: height - float(self._planned(start).position[2]) for start, height in heights}
        self._stood, self._left = False, (-np.inf, np.zeros(6))  # when it left, with which acceleration
        self._none, self._no_rows = np.zeros(0), np.zeros((0, robot.nv))

    def rows(self, tick: Tick) -> Rows:
        """Acceleration rows in all axes while the foot swings, none while it stands."""
        contact = next((contact for contact in tick.contacts if contact.point == self.point), None)
        if contact is None or contact.mode != "off":
            self._stood, self.error = contact is not None, self._none
            return self._rows(self._no_rows, self._none, self._none)
        if self._stood:
            self._stood, self._left = False, (tick.t, contact.acceleration(tick))
        self._reference = contact.way or self._lowered
        return super().rows(tick)

    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """As an `OperationalPoint`, led over from what the contact asked for."""
        error, rate, J, drift, feedforward = super().observe(tick)
        start, left = self._left
        share = 1.0 - (tick.t - start) / RELEASE
        if share > 0.0:
            feedforward = feedforward + share**LEAD * (left - feedforward - self.kp * error - self.kd * rate)
        return error, rate, J, drift, feedforward

    def _lowered(self, t: float) -> Pose:
        pose = self._planned(t)
        before, after = self._stances.around(t)
        if before is None or after is None:
            return pose
        late, span = t - after.start, after.start - before.end
        return lowered_pose(raised_pose(pose, self._missing[after.start], span + late, span), late)
