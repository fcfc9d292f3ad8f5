"""The stacks that come with the project. Copy one into a file of your own, change it, and give it to ``--stack``."""

from collections.abc import Mapping

import numpy as np

from sot.behaviours.recovery import RecoverySchedule
from sot.behaviours.sliding import SlidingSchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface
from tasks import (
    Balance,
    FootSliding,
    JointBounds,
    LeastForces,
    OperationalPoint,
    Posture,
    SelfCollision,
    SwingFoot,
    TorqueBounds,
    TorqueRateBounds,
)
from tasks.bounds import RANGE_MARGIN

LEG_MARGIN_ON_SERVOS = 0.1
"""Distance that leg joints of a state that leads servos keep from the ends of their range [rad]: the servos' error, and
what a stabiliser does to the legs. A knee that met its stop before its foot met the floor had the robot on its toes."""


def planted_stack(robot: Robot, motion: Motion, on: Mapping[str, Surface] | None = None) -> Stack:
    """Stack for feet that stand: strict levels for what must hold, the posture takes the null space that is left.

    Args:
        robot: Who stands.
        motion: What it does.
        on: Foot -> surface of the world under it; what the motion stands on unless given.
    """
    under = dict.fromkeys(robot.feet, FLOOR) | dict(motion.phases[0].surfaces) | dict(on or {})
    return Stack(
        contacts=[Contact(robot.surface(foot), under[foot]) for foot in robot.feet],
        hard=[TorqueBounds(robot), TorqueRateBounds(robot), JointBounds(robot), SelfCollision(robot)],
        levels={
            "balance": [Balance(motion.balance, motion.feet, motion.angular_momentum)],
            "waist": [OperationalPoint(robot, "waist", motion.pose("waist"), axes="RPY")],
            "posture": [Posture(robot, motion.joints)],
            "forces": [LeastForces()],
        },
    )


def stepping_stack(robot: Robot, motion: Motion, on: Mapping[str, Surface] | None = None) -> Stack:
    """Stack for feet that stand and swing by `stepping_schedule`; a swinging foot comes next to balance.

    Args:
        robot: Who steps.
        motion: What it does.
        on: Foot -> surface of the world under it at the start; what the motion stands on unless given.
    """
    stack = planted_stack(robot, motion, on)
    for foot in robot.feet:
        stack.add(SwingFoot(robot, foot, motion), level="feet", before="waist")
    return stack


def catching_stack(robot: Robot, motion: Motion) -> Stack:
    """`stepping_stack` for a state that leads a robot on servos: its legs keep off the ends of their range."""
    stack, margin = stepping_stack(robot, motion), np.full(robot.na, RANGE_MARGIN)
    margin[list(robot.groups["legs"])] = LEG_MARGIN_ON_SERVOS
    stack.hard = [JointBounds(robot, margin) if isinstance(one, JointBounds) else one for one in stack.hard]
    return stack


def stepping_schedule(robot: Robot, motion: Motion) -> RecoverySchedule:
    """Schedule of `stepping_stack`: the motion's contact phases, the measured loads, and steps that a push needs."""
    return RecoverySchedule.of(motion)


def sliding_stack(robot: Robot, motion: Motion) -> Stack:
    """Stack for feet that stand and slide by `sliding_schedule`; a sliding foot's path comes next to balance."""
    stack = planted_stack(robot, motion)
    for foot in robot.feet:
        if any(foot in phase.sliding for phase in motion.phases):
            stack.contact(foot).path = path = motion.pose(foot)
            stack.add(FootSliding(robot, foot, path), level="feet", before="waist")
    return stack


def sliding_schedule(robot: Robot, motion: Motion) -> SlidingSchedule:
    """Schedule of `sliding_stack`: the contacts that the motion has slide."""
    return SlidingSchedule(motion.phases)
