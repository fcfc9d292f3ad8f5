"""The stack for a reference without a future."""

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from sot.control.contact import Contact
from sot.control.pose import PoseReference
from sot.control.stack import Stack
from sot.gravity import GRAVITY
from sot.motion.trajectory import Reference
from sot.robots.robot import Robot
from tasks import (
    Balance,
    FreePoint,
    JointBounds,
    LeastForces,
    OperationalPoint,
    Posture,
    SelfCollision,
    TorqueBounds,
    TorqueRateBounds,
)

HEIGHT_STIFFNESS_PER_OMEGA_SQUARED = 1.32
"""Stiffness of the centre of mass' height in g / height: one that is followed at once makes the robot bounce."""
SOLE_MARGIN_SHARE = 0.055
"""Distance in lengths of a sole by which the soles that the controller counts on are smaller on all sides."""
SWING_STIFFNESS, SWING_DAMPING = 200.0, 28.0
"""Gains of a swinging foot on its path [1/s², 1/s]."""
WAIST_WEIGHT_STANDING, WEIGHT_STEPPING = 2.0, 20.0
"""Weight of the waist's orientation against the upper body's posture, and of waist and swinging foot where feet step.

On one foot a waist that gives way tilts all. A strict foot whose knee is at its speed limit would swing the whole body
so as to be in time: it may be late.
"""
UPPER_BODY_GROUPS = ("chest", "head", "arms")


def live_stack(robot: Robot, reference: Reference, swings: Mapping[str, PoseReference] | None = None) -> Stack:
    """Stack for a live reference.

    It differs from `planted_stack` in what a plan makes possible and a stream does not: waist and posture share one
    level, since a strict waist leaves the posture nothing where both cannot be had; the posture is that of chest, head
    and arms, since the legs' rows would pull the pelvis; and the height is followed softly. Soles are a little smaller
    than they are: a motion that nobody foresaw takes the zero-moment point to their edge now and then.

    Args:
        robot: Who follows.
        reference: What it does.
        swings: Foot -> its path while its contact is off, for feet that step.
    """
    height = float(pin.centerOfMass(robot.model, robot.model.createData(), robot.rest)[2])
    upper_body = [robot.joints[joint] for group in UPPER_BODY_GROUPS for joint in robot.groups[group]]
    waist_weight = WEIGHT_STEPPING if swings else WAIST_WEIGHT_STANDING
    stack = Stack(
        contacts=[
            Contact(robot.surface(foot), inset=SOLE_MARGIN_SHARE * float(np.ptp(robot.sole(foot)[:, 0])))
            for foot in robot.feet
        ],
        hard=[TorqueBounds(robot), TorqueRateBounds(robot), JointBounds(robot), SelfCollision(robot)],
        levels={
            "balance": [
                Balance(
                    reference.balance,
                    reference.feet,
                    reference.angular_momentum,
                    kp=HEIGHT_STIFFNESS_PER_OMEGA_SQUARED * GRAVITY / height,
                ),
            ],
            "posture": [
                OperationalPoint(robot, "waist", reference.pose("waist"), axes="RPY", weight=waist_weight),
                Posture(robot, reference.joints, joints=upper_body, name="Posture"),
            ],
            "forces": [LeastForces()],
        },
    )
    for foot, path in (swings or {}).items():
        stack.add(
            FreePoint(robot, foot, path, kp=SWING_STIFFNESS, kd=SWING_DAMPING, weight=WEIGHT_STEPPING), level="posture"
        )
    return stack
