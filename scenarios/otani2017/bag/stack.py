"""The stack that fetches the bag: balance among feet and hand, then the led points, then the smallest forces."""

from scenarios.otani2017.bag.scene import PALM_FRICTION, PALM_LEAST, PALM_MOST
from scenarios.otani2017.handling_stack import MAX_LYING_LOAD, MIN_LYING_LOAD
from sot.behaviours.manipulation.phases import PhasedSchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.gravity import GRAVITY
from sot.robots.system import System
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

PALM_RESERVE = 3.0
"""How much dearer the forces of the hand are than those of the feet."""
HOOK_FRICTION = 0.6
"""Coefficient that is relied upon between the hook's rubber and the handle."""
MIN_HOOK_LOAD, MAX_HOOK_LOAD, WISHED_HOOK_LOAD = 0.1, 3.0, 0.5
"""Least and greatest normal force of the hook on the handle, and what is wished for while the bag lies, in weights of
the bag."""


def bag_contacts(system: System) -> dict[str, Contact]:
    """The contacts: feet, the palm on the table, the hook below the handle, and the bag that lies."""
    robot, bag = system.robot, system.thing("bag").mass * GRAVITY
    weight, top = robot.mass * GRAVITY, system.surface("table/top")
    contacts = {foot: Contact(robot.surface(foot)) for foot in robot.feet}
    contacts["palm"] = Contact(
        robot.surface("right_palm"),
        top,
        friction=PALM_FRICTION,
        axes="xyzRP",  # flat; an arm of six joints is not held in all six
        least=PALM_LEAST * weight,
        most=PALM_MOST * weight,
        reserve=PALM_RESERVE,
    )
    contacts["hook"] = Contact(
        robot.surface("left_hook"),
        system.surface("bag/handle"),
        friction=HOOK_FRICTION,
        least=MIN_HOOK_LOAD * bag,
        most=MAX_HOOK_LOAD * bag,
        wish=WISHED_HOOK_LOAD * bag,
    )
    contacts["lying"] = Contact(
        system.surface("bag/bottom"),
        top,
        least=MIN_LYING_LOAD * bag,
        most=MAX_LYING_LOAD * bag,
        stiffness=0.0,  # it lies wherever the table is
    )
    for name in ("palm", "hook"):
        contacts[name].mode, contacts[name].load = "off", 0.0
    return contacts


def bag_stack(system: System, contacts: dict[str, Contact], schedule: PhasedSchedule) -> Stack:
    """The stack; its schedule leads the references."""
    robot, guides = system.robot, schedule.guides
    return Stack(
        contacts=list(contacts.values()),
        hard=[TorqueBounds(robot), TorqueRateBounds(robot), JointBounds(robot), SelfCollision(system)],
        levels={
            "balance": [Balance(schedule.balance, axes="xy")],
            "motion": [
                FreePoint(system, "left_foot", guides["left_foot"], kp=100.0, kd=20.0, weight=2.0),
                FreePoint(system, "left_hand", guides["left_hand"], kp=150.0, kd=24.0, weight=10.0),
                FreePoint(system, "right_hand", guides["right_hand"], kp=150.0, kd=24.0, weight=10.0),
                OperationalPoint(system, "waist", guides["waist"], axes="zRPY", kp=40.0, weight=1.0),
                OperationalPoint(system, "chest", guides["chest"], axes="RPY", kp=40.0, weight=1.0),
                Posture(robot, schedule.posture, kp=20.0, weight=0.3),
            ],
            "forces": [LeastForces()],
        },
    )
