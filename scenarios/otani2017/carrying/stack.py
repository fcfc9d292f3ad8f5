"""The stack of a robot that walks with what it holds."""

from sot.behaviours.manipulation.walking import WalkingManipulation
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.motion.objects.events import SurfacePair
from sot.motion.objects.retarget import RobotDemonstration
from tasks import (
    Balance,
    FreePoint,
    JointBounds,
    LeastForces,
    OperationalPoint,
    Posture,
    SelfCollision,
    SwingFoot,
    TorqueBounds,
    TorqueRateBounds,
)


def carry_stack(
    demonstration: RobotDemonstration, contacts: dict[SurfacePair, Contact], schedule: WalkingManipulation
) -> Stack:
    """The stack of a robot that walks with what it holds; its schedule leads the references."""
    system, motion, clock = demonstration.system, demonstration.motion, schedule.clock
    robot = system.robot
    feet = {foot: lambda t, foot=foot: schedule.foothold(foot, t) for foot in robot.feet}
    swings = [SwingFoot(system, foot, motion, clock=lambda t: clock.time) for foot in robot.feet]
    hands = [
        FreePoint(system, point, guide, kp=150.0, kd=24.0, weight=10.0) for point, guide in schedule.guides.items()
    ]
    waist, chest = clock.pose(motion.pose("waist")), clock.pose(motion.pose("chest"))
    return Stack(
        contacts=list(contacts.values()),
        hard=[TorqueBounds(robot), TorqueRateBounds(robot), JointBounds(robot), SelfCollision(system)],
        levels={
            "balance": [Balance(schedule.balance, feet, schedule.angular_momentum, axes="xy")],
            "feet": swings,
            "motion": [
                *hands,
                OperationalPoint(system, "waist", waist, axes="zRPY", kp=40.0, weight=1.0),
                OperationalPoint(system, "chest", chest, axes="RPY", kp=40.0, weight=1.0),
                Posture(robot, clock.vector(motion.joints), kp=20.0, weight=0.3),
            ],
            "forces": [LeastForces()],
        },
    )
