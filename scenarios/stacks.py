"""The stacks that come with the project. Copy one into a file of your own, change it, and give it to ``--stack``."""

from sot.contact import Contact
from sot.motion.trajectory import Motion
from sot.robot import Robot
from sot.stack import Stack
from tasks import Balance, JointBounds, LeastForces, OperationalPoint, Posture, TorqueBounds


def planted(robot: Robot, motion: Motion) -> Stack:
    """Both feet stand; strict for what must hold, the joints share what is left."""
    return Stack(
        contacts=[Contact(foot, robot.sole(foot)) for foot in robot.feet],
        hard=[TorqueBounds(robot), JointBounds(robot)],
        levels={
            "balance": [Balance(motion.balance, motion.feet)],
            "waist": [OperationalPoint(robot, "waist", motion.pose("waist"), axes="RPY")],
            "posture": [Posture(robot, motion.joints)],
            "forces": [LeastForces()],
        },
    )
