"""A foot that swings from one foothold to the next."""

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from solvers.rows import Rows
from sot.behaviours.planned_swing import PlannedSwing
from sot.control.pose import PoseReference
from sot.control.tick import Tick
from sot.motion.feet.footfalls import Footfalls
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.system import System
from tasks.free_point import FreePoint

Array = np.ndarray


class SwingFoot(FreePoint):
    """Moves a foot along its path in a motion while its contact is off, as a `FreePoint`.

    Where the motion has the foot on the floor while the contact is still off, the foot is lowered at a steady speed.

    Args:
        robot: The robot.
        foot: One of its feet.
        motion: The motion of the robot.
        kp, kd, weight: As for `MotionTask`.
        clock: The motion's time at a time of the run [s], which goes as fast while a foot swings; unless given, the
            same.
    """

    def __init__(
        self,
        robot: Robot | System,
        foot: str,
        motion: Motion,
        kp: float = 200.0,
        kd: float = 28.0,
        weight: float = 1.0,
        clock: Callable[[float], float] | None = None,
    ) -> None:
        self._stances, self._clock = Footfalls(motion.phases, foot), clock
        super().__init__(robot, foot, motion.pose(foot), kp=kp, kd=kd, weight=weight, name=f"SwingFoot {foot}")

    @property
    def reference(self) -> PoseReference:
        """Planned path of the foot, the motion's unless replaced: from one foothold of the motion to the next."""
        return self._planned_path

    @reference.setter
    def reference(self, reference: PoseReference | Array | pin.SE3) -> None:
        self._planned_path = self._trajectory(reference)
        swing, clock = PlannedSwing(self._stances, self._planned_path), self._clock
        self._free_path = swing if clock is None else lambda t: swing(clock(t))

    def rows(self, tick: Tick) -> Rows:
        """Acceleration rows in all axes while the foot swings, none while it stands."""
        if all(contact.point != self.point for contact in tick.contacts):
            return self.no_rows(tick)
        return super().rows(tick)
