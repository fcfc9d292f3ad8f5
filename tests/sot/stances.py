"""Stances, and a stack like the shipped one for a robot that is to keep one of them."""

import numpy as np
import pinocchio as pin

from sot.control.contact import Contact, Form
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks import Balance, JointBounds, LeastForces, OperationalPoint, Posture, TorqueBounds

Array = np.ndarray


def leaning(robot: Robot, share: float) -> Array:
    """Configuration with both soles as at rest and the CoM at a share of the way from the left to the right foot."""
    tick = Tick(robot)
    left, right = (tick.frame(foot).position.copy() for foot in robot.feet)
    centre, q = (left + share * (right - left))[:2], robot.rest.copy()
    for _ in range(10):
        tick.update(0.0, q, np.zeros(robot.nv))
        jacobians, errors = [tick.com_jacobian[:2]], [centre - tick.com[:2]]
        for foot, place in zip(robot.feet, (left, right), strict=True):
            frame = tick.frame(foot)
            jacobians.append(frame.jacobian)
            errors.append(np.concatenate([place - frame.position, pin.log3(frame.rotation.T)]))
        q = pin.integrate(robot.model, q, np.linalg.pinv(np.vstack(jacobians), rcond=1e-6) @ np.concatenate(errors))
    return q


def standing_stack(
    robot: Robot, form: Form = "pyramid", fraction: float = 1.0, at: Array | None = None, over: Array | None = None
) -> Stack:
    """Both feet stand; balance, trunk, head and joints as in the configuration `at` (rest), with least forces.

    The centre of mass is wanted over the place `over` (2,), unless given over where it is.
    """
    q = robot.rest if at is None else at
    tick = Tick(robot).update(0.0, q, np.zeros(robot.nv))
    centre, still = tick.com.copy(), np.zeros(3)
    if over is not None:
        centre[:2] = over

    def upright(point: str) -> OperationalPoint:
        target = pin.SE3(tick.frame(point).rotation.copy(), still)
        return OperationalPoint(robot, point, target, axes="RPY")

    return Stack(
        contacts=[Contact(robot.surface(foot), form=form) for foot in robot.feet],
        hard=[TorqueBounds(robot, fraction), JointBounds(robot)],
        levels={
            "balance": [Balance(lambda t: (centre, still, still, centre[:2]))],
            "trunk": [upright("waist"), upright("chest")],
            "head": [upright("head")],
            "posture": [Posture(robot, q[7:])],
            "forces": [LeastForces()],
        },
    )
