"""How large and how strong a robot's legs are."""

from functools import lru_cache

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.polygon import Polygon
from sot.robots.robot import Robot

Array = NDArray[np.float64]

MAX_ANKLE_EFFORT_SHARE = (
    0.8  # of an ankle's effort, that holds the weight: the rest is for the motion and the closed loop
)
MIN_HORIZONTAL_AXIS_PART = 0.2  # of an axis' length, its part in the floor's plane: a more upright one holds no weight
ROUNDING_M = 1e-9


@lru_cache
def leg_length(robot: Robot) -> float:
    """The length of a robot's legs from hip over knee to ankle, the mean of both [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)

    def length(side: str) -> float:
        hip, knee, ankle = (data.oMf[robot.point(f"{side}_{point}")].translation for point in ("hip", "knee", "ankle"))
        return float(np.linalg.norm(hip - knee) + np.linalg.norm(knee - ankle))

    return 0.5 * (length("left") + length("right"))


@lru_cache
def held_sole(robot: Robot, foot: str) -> Array:
    """Corners (n, 3), in the foot's frame, of the part of its sole over which its ankle holds the weight [m].

    With the weight W at a place r of the sole, a joint about an axis a through o between knee and foot has the torque
    W (a_x (r - o)_y - a_y (r - o)_x).
    """
    model, data, side = robot.model, robot.model.createData(), foot.removesuffix("_foot")
    pin.computeJointJacobians(model, data, robot.rest)
    pin.updateFramePlacements(model, data)
    chains = [list(model.supports[model.frames[robot.point(f"{side}_{end}")].parentJoint]) for end in ("foot", "knee")]
    place, corners = data.oMf[robot.point(foot)].translation, robot.sole(foot)
    sole = Polygon.hull(corners[:, :2])
    normals, offsets = list(sole.normals), list(sole.offsets)
    for joint in [joint for joint in chains[0] if joint not in chains[1]]:
        column = model.joints[joint].idx_v
        axis, origin = data.J[3:, column], data.oMi[joint].translation - place
        lever = np.array([-axis[1], axis[0]])
        length = float(np.linalg.norm(lever))
        if length < MIN_HORIZONTAL_AXIS_PART:
            continue
        most = MAX_ANKLE_EFFORT_SHARE * robot.effort[column - 6] / (robot.mass * GRAVITY)
        for normal in (lever / length, -lever / length):
            normals.append(normal)
            offsets.append(float(normal @ origin[:2]) + most / length)
    held = Polygon(np.array(normals), np.array(offsets))
    if held.margin(corners[:, :2]).min() >= -ROUNDING_M:
        return corners
    vertices = held.vertices
    return np.column_stack([vertices, np.full(len(vertices), corners[:, 2].mean())])


def standing_height(robot: Robot) -> float:
    """From the soles to the top of the head, on straight legs [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    hips, ankles = (
        0.5 * sum(data.oMf[robot.point(f"{side}_{point}")].translation[2] for side in ("left", "right"))
        for point in ("hip", "ankle")
    )
    return float(data.oMf[robot.point("head_top")].translation[2] - hips + leg_length(robot) + ankles)
