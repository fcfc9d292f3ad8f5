"""What a swinging leg does to the zero-moment point."""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sot.gravity import GRAVITY
from sot.robots.robot import Robot


class ZmpShift(NamedTuple):
    """How far one foot's acceleration against the pelvis moves the zero-moment point [m per m/s²].

    Args:
        along: A horizontal one, along itself: the leg hangs below the centre of mass.
        ahead: One up, ahead: the knee goes forward when it bends.
    """

    along: float
    ahead: float


def zmp_shift_of_swing(robot: Robot) -> ZmpShift:
    """The shift at rest, the mean of both feet: the change of L moves z by (−L̇_y, L̇_x) / (m g)."""
    model, data = robot.model, robot.model.createData()
    pin.computeCentroidalMap(model, data, robot.rest)
    momentum, along, ahead = data.Ag[3:5].copy(), [], []
    for foot in robot.feet:
        J = pin.computeFrameJacobian(model, data, robot.rest, robot.point(foot), pin.LOCAL_WORLD_ALIGNED)
        J[:, :6] = 0.0
        about_x, about_y = momentum @ np.linalg.pinv(J)
        along += [-about_y[0], about_x[1]]
        ahead.append(-about_y[2])
    return ZmpShift(*(float(np.mean(values)) / (robot.mass * GRAVITY) for values in (along, ahead)))
