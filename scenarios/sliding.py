"""A foot that slides on the floor and back while the other one stands, Ramos IV-C: forward, aside and turned."""

import numpy as np
import pinocchio as pin

from scenarios import stacks
from sot.motion.contacts import Phase, planted
from sot.motion.feet_led import feet_led
from sot.motion.smooth import ease
from sot.motion.swing import FootPath, standing
from sot.motion.trajectory import Motion
from sot.robot import Robot
from sot.schedule import Schedule
from sot.stack import Stack
from tasks import FootSliding

Array = np.ndarray

PERIOD = 0.02  # s, between knots
FOOT = "right_foot"
STANDS, SLIDES, RESTS = 1.5, 1.6, 0.4  # s: before the first way, a way, and after each of them
LAST = 1.5  # s, on both feet at the end
WAYS = ((0.12, 0.0, 0.0), (0.06, -0.08, -0.35), (0.0, 0.0, 0.0))
"""Where the foot slides to, one after the other: forward and left of its start [m], turned to the left [rad]."""


def motion(robot: Robot, rate: float) -> Motion:
    """The robot shifts its weight, slides its foot along `WAYS`, and stands on both feet again."""
    begin, end = STANDS, STANDS + len(WAYS) * (SLIDES + RESTS)
    feet = planted(robot, 0.0)[0].feet
    alone = {foot: pose for foot, pose in feet.items() if foot != FOOT}
    phases = (Phase(0.0, begin, feet), Phase(begin, end, alone), Phase(end, end + LAST, feet))
    times = np.arange(round(phases[-1].end / PERIOD) + 1) * PERIOD
    paths = standing(phases[0], len(times))
    paths[FOOT] = _path(feet[FOOT], times)
    return feet_led(robot, phases, paths, PERIOD, rate)


def stack(robot: Robot, motion: Motion) -> Stack:
    """The planted stack, and the foot's way next to balance."""
    made, way = stacks.planted(robot, motion), motion.pose(FOOT)
    made.contact(FOOT).way = way
    made.add(FootSliding(robot, FOOT, way), level="feet", before="waist")
    return made


def schedule(robot: Robot, motion: Motion) -> Schedule:
    """The foot's contact slides while the motion has the other foot alone carry."""
    alone = next(phase for phase in motion.phases if FOOT not in phase.feet)
    return Schedule().mode(alone.start, FOOT, "sliding").mode(alone.end, FOOT, "fixed")


def _path(start: pin.SE3, times: Array) -> FootPath:
    """From place to place at rest and without acceleration at both ends."""
    place = np.zeros((len(times), 3))
    for k, way in enumerate(WAYS):
        share = (times - STANDS - k * (SLIDES + RESTS) - 0.5 * RESTS) / SLIDES
        before = WAYS[k - 1] if k else (0.0, 0.0, 0.0)
        place += ease(share)[:, None] * (np.array(way) - before)
    shift = np.column_stack([place[:, :2], np.zeros(len(times))])
    turns = np.array([pin.utils.rotate("z", yaw) for yaw in place[:, 2]])
    return FootPath(start.translation + shift, turns @ start.rotation)
