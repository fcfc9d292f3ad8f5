"""How large a robot is: what the lengths of a plan scale with."""

from functools import lru_cache

import numpy as np
import pinocchio as pin

from sot.robots.robot import Robot


@lru_cache
def leg_length(robot: Robot) -> float:
    """The length of a robot's legs from hip over knee to ankle, the mean of both [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)

    def length(side: str) -> float:
        hip, knee, ankle = (data.oMf[robot.point(f"{side}_{point}")].translation for point in ("hip", "knee", "ankle"))
        return float(np.linalg.norm(hip - knee) + np.linalg.norm(knee - ankle))

    return 0.5 * (length("left") + length("right"))
