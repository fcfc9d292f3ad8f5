"""A foot that slides on the floor, Ramos IV-C."""

import numpy as np

from sot.control.pose import PoseReference
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.operational_point import OperationalPoint

Array = np.ndarray


class FootSliding(OperationalPoint):
    """Moves a foot in x, y and yaw for as long as its contact is "sliding", which holds its height, roll and pitch.

    Args:
        robot: The robot.
        foot: One of its feet; its contact's `path` should be the reference: friction acts against its velocity.
        reference: Trajectory ``t -> Pose`` of the foot's point; its x, y and yaw count.
        kp, kd, weight: As for `MotionTask`.
    """

    def __init__(
        self,
        robot: Robot,
        foot: str,
        reference: PoseReference,
        kp: float = 1000.0,
        kd: float | None = None,
        weight: float = 1.0,
    ) -> None:
        super().__init__(robot, foot, reference, "xyY", kp, kd, weight, name=f"FootSliding {foot}")
        self._no_rows = np.zeros(0), np.zeros(0), np.zeros((0, robot.nv)), np.zeros(0), np.zeros(0)

    def observe(self, tick: Tick) -> tuple[Array, Array, Array, Array, Array]:
        """As an `OperationalPoint` while the contact slides; no rows otherwise."""
        slides = any(contact.point == self.point and contact.mode == "sliding" for contact in tick.contacts)
        return super().observe(tick) if slides else self._no_rows
