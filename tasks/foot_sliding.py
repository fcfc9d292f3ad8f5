"""A foot that slides on the floor, Ramos IV-C."""

from sot.robot import Robot
from tasks.operational_point import OperationalPoint, PoseReference


class FootSliding(OperationalPoint):
    """Moves a foot in x, y and yaw while its contact, in mode "sliding", holds its height, roll and pitch.

    Args:
        robot: The robot.
        foot: One of its feet; set its contact to "sliding" for as long as this task is in the stack.
        reference: Trajectory ``t -> Pose`` of the foot's point; its x, y and yaw count.
        kp, kd, weight: As for `MotionTask`.
    """

    def __init__(
        self,
        robot: Robot,
        foot: str,
        reference: PoseReference,
        kp: float = 100.0,
        kd: float | None = None,
        weight: float = 1.0,
    ) -> None:
        super().__init__(robot, foot, reference, "xyY", kp, kd, weight, name=f"FootSliding {foot}")
