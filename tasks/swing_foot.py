"""A foot on its way from one foothold to the next."""

import numpy as np

from sot.motion.footfalls import Footfalls
from sot.motion.trajectory import Motion
from sot.robot import Robot
from sot.task import Pose
from sot.tick import Tick
from tasks.operational_point import OperationalPoint

Array = np.ndarray

DESCENT = 0.1
SPEED_UP = 0.03
"""Speed at which a foot looks for a floor that it should have reached [m/s], and how long it takes to get there [s]."""
UP = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


class SwingFoot(OperationalPoint):
    """Moves a foot along a motion for as long as its contact is off; a foot that stands is not asked for anything.

    Once the motion has the foot on the floor, and the contact is still off, it is lowered at a steady speed.

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
        self._none = np.zeros(0), np.zeros(0), np.zeros((0, robot.nv)), np.zeros(0), np.zeros(0)

    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """As an `OperationalPoint` in all axes while the foot swings; no rows while it stands."""
        swings = any(contact.point == self.point and contact.mode == "off" for contact in tick.contacts)
        return super().observe(tick) if swings else self._none

    def _lowered(self, t: float) -> Pose:
        pose = self._planned(t)
        stance = self._stances.nearest(t)
        if stance is None or not stance.start <= t < stance.end - 1e-9:
            return pose
        late = t - stance.start
        speed = DESCENT * min(late / SPEED_UP, 1.0)
        depth = 0.5 * speed * late if late < SPEED_UP else DESCENT * (late - 0.5 * SPEED_UP)
        return pose._replace(position=pose.position - depth * UP[:3], velocity=pose.velocity - speed * UP)
