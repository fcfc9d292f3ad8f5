"""The stack of a robot that steps while its hands are led in the world."""

from collections.abc import Mapping, Sequence

from sot.control.contact import Contact
from sot.control.load import Load
from sot.control.pose import PoseReference
from sot.control.stack import Stack
from sot.motion.trajectory import Motion
from sot.robots.system import System
from tasks import (
    Balance,
    JointBounds,
    LeastForces,
    OperationalPoint,
    Posture,
    SelfCollision,
    SwingFoot,
    TorqueBounds,
    TorqueRateBounds,
)


def led_hands_stack(
    system: System,
    motion: Motion,
    hands: Mapping[str, PoseReference],
    touches: Sequence[Contact] = (),
    loads: Sequence[Load] = (),
) -> Stack:
    """The stack of a robot whose hands follow paths of their own.

    Args:
        system: The robot, and the things that it is told of.
        motion: Of the robot.
        hands: Hand -> its path.
        touches: Contacts besides those of the feet.
        loads: What is known to act on the robot.
    """
    robot = system.robot
    led = [OperationalPoint(system, point, path, kp=150.0, kd=24.0, weight=10.0) for point, path in hands.items()]
    return Stack(
        contacts=[*(Contact(robot.surface(foot)) for foot in robot.feet), *touches],
        hard=[TorqueBounds(robot), TorqueRateBounds(robot), JointBounds(robot), SelfCollision(system)],
        levels={
            "balance": [Balance(motion.balance, motion.feet, motion.angular_momentum, axes="xy")],
            "feet": [SwingFoot(system, foot, motion) for foot in robot.feet],
            "motion": [
                *led,
                OperationalPoint(system, "waist", motion.pose("waist"), axes="zRPY", kp=40.0, weight=1.0),
                OperationalPoint(system, "chest", motion.pose("chest"), axes="RPY", kp=40.0, weight=1.0),
                Posture(robot, motion.joints, kp=20.0, weight=0.3),
            ],
            "forces": [LeastForces()],
        },
        loads=loads,
    )
