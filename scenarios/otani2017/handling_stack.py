"""The stack of Otani (23): what supports, what is free, what holds, and the centre of mass of what is carried."""

import numpy as np

from sot.behaviours.manipulation.schedule import ManipulationSchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.gravity import GRAVITY
from sot.motion.objects.events import SurfacePair
from sot.motion.objects.retarget import RobotDemonstration
from tasks import (
    CenterOfMass,
    FreePoint,
    JointBounds,
    LeastForces,
    OperationalPoint,
    Posture,
    SelfCollision,
    TorqueBounds,
    TorqueRateBounds,
)

HAND_FRICTION = 0.6
"""Coefficient that is relied upon between a palm's rubber and a thing."""
GRIP_MARGIN = 1.6
"""Times the squeeze that just holds a thing between hands."""
MIN_GRIP_WEIGHTS = 0.05
"""Least wish of a hand's normal force, in weights of the robot."""
MAX_GRIP = 3.0
"""Times the squeeze that is wished for that a hand may press at most: the robot is not to lean on what it holds."""
MIN_LYING_LOAD, MAX_LYING_LOAD = 0.1, 1.5
"""Least and greatest normal force on a thing that lies on a surface, in weights of the thing."""


def contacts_of(demonstration: RobotDemonstration) -> dict[SurfacePair, Contact]:
    """A contact for each pair of surfaces that touches at some time; those at the start are made, the others off."""
    contacts = {}
    for pair in demonstration.contacts.pairs():
        surface, on = demonstration.surface(pair.first), demonstration.surface(pair.second)
        if pair.kind == "robot-thing":
            wish = _grip(demonstration, pair)
            contact = Contact(surface, on, friction=HAND_FRICTION, least=0.5 * wish, most=_most(wish), wish=wish)
        elif pair.kind == "thing-world":
            weight = demonstration.system.thing(pair.first.entity).mass * GRAVITY
            contact = Contact(surface, on, least=MIN_LYING_LOAD * weight, most=MAX_LYING_LOAD * weight)
        else:
            contact = Contact(surface, on)
        contact.mode = "fixed" if pair in demonstration.contacts.initial else "off"
        contacts[pair] = contact
    return contacts


def handling_stack(
    demonstration: RobotDemonstration, contacts: dict[SurfacePair, Contact], schedule: ManipulationSchedule
) -> Stack:
    """The stack of a demonstration; its schedule leads the references."""
    system, robot, motion = demonstration.system, demonstration.system.robot, demonstration.motion
    clock = schedule.clock
    links = []
    for point, guide in schedule.guides.items():
        if point in robot.feet:
            links.append(FreePoint(system, point, guide, kp=100.0, kd=20.0, weight=2.0))
        else:
            links.append(FreePoint(system, point, guide, kp=150.0, kd=24.0, weight=10.0))
    waist, chest = clock.pose(motion.pose("waist")), clock.pose(motion.pose("chest"))
    return Stack(
        contacts=list(contacts.values()),
        hard=[TorqueBounds(robot), TorqueRateBounds(robot), JointBounds(robot), SelfCollision(system)],
        levels={
            "balance": [CenterOfMass(schedule.com, axes="xy", kp=60.0)],
            "motion": [
                *links,
                OperationalPoint(system, "waist", waist, axes="zRPY", kp=40.0, weight=1.0),
                OperationalPoint(system, "chest", chest, axes="RPY", kp=40.0, weight=1.0),
                Posture(robot, clock.vector(motion.joints), kp=20.0, weight=0.3),
            ],
            "forces": [LeastForces()],
        },
    )


def _most(wish: float) -> float:
    """Greatest normal force of a hand that wishes for one [N]; no bound where there is no wish."""
    return MAX_GRIP * wish if wish else np.inf


def _grip(demonstration: RobotDemonstration, pair: SurfacePair) -> float:
    """Normal force that is asked of a hand [N]: what carries a free thing's share; none on what a hinge carries."""
    robot, thing = demonstration.system.robot, demonstration.system.thing(pair.second.entity)
    if not thing.is_free:
        return 0.0
    hands = sum(
        other.kind == "robot-thing" and other.second.entity == thing.name for other in demonstration.contacts.pairs()
    )
    needed = GRIP_MARGIN * thing.mass * GRAVITY / (hands * HAND_FRICTION)
    return max(needed, MIN_GRIP_WEIGHTS * robot.mass * GRAVITY)
