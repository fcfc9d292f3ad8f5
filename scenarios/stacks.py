"""The stacks that come with the project. Copy one into a file of your own, change it, and give it to ``--stack``."""

from sot.contact import Contact
from sot.motion.trajectory import Motion
from sot.robot import Robot
from sot.stack import Stack
from tasks import Balance, JointBounds, LeastForces, OperationalPoint, Posture, TorqueBounds


def planted(robot: Robot, motion: Motion) -> Stack:
    """Both feet stand. Strict for what must hold, weights for what should look right."""
    return Stack(
        contacts=[Contact(foot, robot.sole(foot)) for foot in robot.feet],
        hard=[TorqueBounds(robot), JointBounds(robot)],
        levels={
            "balance": [Balance(motion.balance)],
            "waist": [OperationalPoint(robot, "waist", motion.pose("waist"), axes="RPY")],
            "body": [
                OperationalPoint(robot, "chest", motion.pose("chest"), axes="RPY", weight=2.0),
                OperationalPoint(robot, "head", motion.pose("head"), axes="RPY"),
                Posture(robot, motion.joints),
            ],
            "forces": [LeastForces()],
        },
    )
