"""The centre of mass over the middle of a foot that stands alone for long, the other one high in the air.

The balance nearest to the dancer's keeps the zero-moment point at the inner edge of what a standing foot can hold. A
push to that side then finds no room, and a foot that is high in the air does not come down in time.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.motion.feet.contacts import Phase
from sot.motion.feet.support import support_over
from sot.motion.feet.swing import FootPath
from sot.polygon import Polygon
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

# In time constants of a pendulum of the leg's length: stances so long are centred not at all, fully.
LONG_STANCE = 4.5, 7.5
CENTRING_TIME = 2.5  # of these, from the beginning and to the end of a stance, in which the centre of mass moves
HIGH_LIFT_LEGS = 0.3, 0.5  # leg lengths of the other foot's lift: stances so high are centred not at all, fully
CENTRED_SHARE = 0.1  # of what the foot can hold, about its middle, within which the centre of mass is to be


def centred_on_long_stances(
    robot: Robot, phases: Sequence[Phase], feet: Mapping[str, FootPath], com: Array, period: float
) -> Array:
    """Places (T, 2) wanted of the centre of mass, moved over the middle of feet that stand alone for long [m].

    Args:
        robot: whose feet.
        phases: which stand where, when.
        feet: their paths.
        com: (T, 2) places that are wanted otherwise, at knots.
        period: time between knots [s].
    """
    leg = leg_length(robot)
    time_constant = float(np.sqrt(leg / GRAVITY))
    times, centred = period * np.arange(len(com)), com.copy()
    for phase in phases:
        inside = np.minimum(times - phase.start, phase.end - times)
        knots = np.flatnonzero(inside > 0.0)
        raised = [path.position[:, 2] for foot, path in feet.items() if foot not in phase.feet]
        if len(phase.feet) == 1 and len(raised) == 1 and len(knots):
            stood = raised[0][[max(knots[0] - 1, 0), min(knots[-1] + 1, len(com) - 1)]]
            lift = float(raised[0][knots].max() - stood.max()) / leg
            share = _rise((phase.end - phase.start) / time_constant, *LONG_STANCE) * _rise(lift, *HIGH_LIFT_LEGS)
            held = support_over(robot, phase, phase.start, 0.0).inset
            room = held.offsets - held.normals @ held.centre
            middle = Polygon(held.normals, held.offsets - (1.0 - CENTRED_SHARE) * room)
            for k in knots if share > 0.0 else ():
                near = share * minimum_jerk(inside[k] / (CENTRING_TIME * time_constant))
                centred[k] += near * (middle.nearest_point(com[k]) - com[k])
    return centred


def _rise(value: float, low: float, high: float) -> float:
    """From 0 at a low value to 1 at a high one."""
    return float(minimum_jerk(np.array((value - low) / (high - low))))
