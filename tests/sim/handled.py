"""A made-up run with a box and a door: the robot stands still, the box rises and tilts, the door opens."""

import numpy as np
import pinocchio as pin

from sim.log import FOOT_FIXED, RunLog
from sot.motion.objects.events import ContactSets, SurfaceName, SurfacePair, contact_sets
from sot.robots import Robot, System, Thing
from tests.sim.runs import PERIOD

TICKS = 200
HELD = slice(50, 101)
"""Rows in which the right palm holds the box with all its load."""
RISE_M, SLIP_M, TILT_DEG, OPEN_DEG = 0.2, 0.003, 10.0, 25.0
HAND_FORCE_N = 40.0
CONTACTS = ("left_foot", "right_palm on box/right", "box/bottom on table/top")


def handled_system() -> System:
    """The robot with a box, a door and a table that does not move."""
    box, table = Thing.load("box", placement=(0.5, 0.0, 0.9)), Thing.load("table", placement=(0.6, 0.0, 0.0))
    return System(Robot.load("hrp2"), [box, table, Thing.load("door", placement=(0.8, 1.0, 0.0))])


def handled_log(system: System) -> RunLog:
    """The box rises by SLIP_M while it is held, by RISE_M in all, and tilts about its x axis; the door opens evenly."""
    log = RunLog.allocate(system, TICKS + 3, contact_names=CONTACTS)
    log.ticks, rows = TICKS, slice(0, TICKS)
    log.time[rows] = PERIOD * np.arange(TICKS)
    log.q[rows], log.v[rows] = system.robot.rest, 0.0
    log.thing_q[rows] = system.rest[system.robot.nq :]
    box, door = (slice(at.start - system.robot.nq, at.stop - system.robot.nq) for at in system.coordinates.values())
    rise = np.interp(np.arange(TICKS), [HELD.start, HELD.stop - 1, TICKS - 1], [0.0, SLIP_M, RISE_M])
    tilt = np.radians(np.interp(np.arange(TICKS), [HELD.stop, TICKS - 1], [0.0, TILT_DEG]))
    for row in range(TICKS):
        place = pin.SE3(pin.exp3(np.array([tilt[row], 0.0, 0.0])), np.array([0.5, 0.0, 0.9 + rise[row]]))
        log.thing_q[row, box] = pin.SE3ToXYZQUAT(place)
    log.thing_q[rows, door] = np.radians(np.linspace(0.0, OPEN_DEG, TICKS))[:, None]
    hand = CONTACTS.index("right_palm on box/right")
    log.contact_normal[rows, hand], log.contact_force[rows, hand] = 0.0, 0.0
    log.contact_mode[HELD, hand], log.contact_ramp[HELD, hand] = FOOT_FIXED, 1.0
    log.contact_normal[HELD, hand] = np.linspace(0.0, HAND_FORCE_N, HELD.stop - HELD.start)
    log.contact_force[HELD, hand, 1] = -HAND_FORCE_N
    return log


def sets_of(*contacts: str) -> ContactSets:
    """The sets of contacts like "robot/left_foot world/floor", with the right palm led while it is free."""
    pairs = [SurfacePair.of(*map(SurfaceName.parse, contact.split())) for contact in contacts]
    return contact_sets(pairs, {"right_palm"})
