"""The stacks that come with the project. Copy one into a file of your own, change it, and give it to ``--stack``."""

from sot.behaviours.recovery import Recovery
from sot.behaviours.sliding import Sliding
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
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
)


def planted(robot: Robot, motion: Motion) -> Stack:
    """Both feet stand; strict for what must hold, the joints share what is left."""
    return Stack(
        contacts=[Contact(foot, robot.sole(foot)) for foot in robot.feet],
        hard=[TorqueBounds(robot), JointBounds(robot), SelfCollision(robot)],
        levels={
            "balance": [Balance(motion.balance, motion.feet, motion.angular_momentum)],
            "waist": [OperationalPoint(robot, "waist", motion.pose("waist"), axes="RPY")],
            "posture": [Posture(robot, motion.joints)],
            "forces": [LeastForces()],
        },
    )


def steps(robot: Robot, motion: Motion) -> Stack:
    """Feet stand and swing as its schedule, `stepping`, has it; a swinging foot comes next to balance."""
    stack = planted(robot, motion)
    for foot in robot.feet:
        stack.add(SwingFoot(robot, foot, motion), level="feet", before="waist")
    return stack


def stepping(robot: Robot, motion: Motion) -> Recovery:
    """The schedule that goes with `steps`: the motion's contact phases, what the feet feel, steps that a push needs."""
    return Recovery(robot, motion)


def slides(robot: Robot, motion: Motion) -> Stack:
    """Feet stand and slide as its schedule, `sliding`, has it; a sliding foot's way comes next to balance."""
    stack = planted(robot, motion)
    for foot in robot.feet:
        if any(foot in phase.sliding for phase in motion.phases):
            stack.contact(foot).path = path = motion.pose(foot)
            stack.add(FootSliding(robot, foot, path), level="feet", before="waist")
    return stack


def sliding(robot: Robot, motion: Motion) -> Sliding:
    """The schedule that goes with `slides`."""
    return Sliding(motion.phases)
