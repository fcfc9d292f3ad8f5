"""A stack like the shipped one, for a robot that stands and is to come back to rest."""

import numpy as np
import pinocchio as pin

from sot.contact import Contact
from sot.robot import Robot
from sot.stack import Stack
from sot.tick import Tick
from tasks import Balance, JointBounds, LeastForces, OperationalPoint, Posture, TorqueBounds

Array = np.ndarray


def standing_stack(robot: Robot, form: str = "pyramid", fraction: float = 1.0, over: Array | None = None) -> Stack:
    """Both feet stand; balance over the place `over` (2,), trunk and head upright, joints at rest, least forces."""
    tick = Tick(robot)
    centre, still = tick.com.copy(), np.zeros(3)
    if over is not None:
        centre[:2] = over

    def upright(point: str) -> OperationalPoint:
        target = pin.SE3(tick.frame(point).rotation.copy(), still)
        return OperationalPoint(robot, point, target, axes="RPY")

    return Stack(
        contacts=[Contact(foot, robot.sole(foot), form=form) for foot in robot.feet],
        hard=[TorqueBounds(robot, fraction), JointBounds(robot)],
        levels={
            "balance": [Balance(lambda t: (centre, still, still, centre[:2]))],
            "trunk": [upright("waist"), upright("chest")],
            "head": [upright("head")],
            "posture": [Posture(robot, robot.rest[7:])],
            "forces": [LeastForces()],
        },
    )
