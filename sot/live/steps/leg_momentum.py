"""What a swinging leg does to the zero-moment point."""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.robots.robot import Robot

Array = NDArray[np.float64]


def zmp_shift_per_foot_acceleration(robot: Robot) -> float:
    """How far one foot's acceleration against the pelvis moves the zero-moment point along with it [m per m/s²].

    A leg hangs below the centre of mass, so that its foot's velocity v has the angular momentum L = κ (v_y, −v_x), the
    change of which moves z by κ/(m g) v̇. At rest, the mean of both feet and both directions.
    """
    model, data = robot.model, robot.model.createData()
    pin.computeCentroidalMap(model, data, robot.rest)
    momentum, found = data.Ag[3:5].copy(), []
    for foot in robot.feet:
        J = pin.computeFrameJacobian(model, data, robot.rest, robot.point(foot), pin.LOCAL_WORLD_ALIGNED)
        J[:, :6] = 0.0
        for way, turned, sign in ((0, 1, -1.0), (1, 0, 1.0)):
            foot_velocity = np.zeros(6)
            foot_velocity[way] = 1.0
            v = np.linalg.pinv(J) @ foot_velocity
            found.append(sign * float(momentum[turned] @ v))
    return float(np.mean(found)) / (robot.mass * GRAVITY)
