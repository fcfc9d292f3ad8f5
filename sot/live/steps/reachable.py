"""The foothold that a leg reaches beside the foot that stands, nearest to a wanted one: one step of `footholds`."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.live.steps.foot_sense import wrapped
from sot.motion.feet.footholds import LegReach, body_axes, min_ankle_separation, toe_out_with_legs_apart
from sot.motion.feet.footwork import Foothold
from sot.polygon import Polygon
from sot.robots.leg_range import DIRECTION_COUNT, directions, normals
from sot.robots.robot import Robot

Array = NDArray[np.float64]

USABLE_STRIDE_SHARE = 0.95
"""Share of a stride's length that is used: the body is not always in the middle between the feet."""

USABLE_TOE_OUT_SHARE = 0.75
"""The same of the angle between both feet: a pelvis that turns late is not in the middle of it."""
CROUCH_EXTENSION = 0.5
"""Distance from hip to ankle with which legs have to stay apart over feet that point at each other, in leg lengths:
nobody knows how low the hips will be while these feet stand."""
MAX_SWING_ACCELERATION_G = 1.3
"""Bound of a swinging foot's acceleration, in g. The plan of the centre of mass knows of it, and would bear more; the
sole that stands does not bear the turn that comes with it, and knees are at their speed limit."""


@lru_cache
def live_reach(robot: Robot) -> LegReach:
    """What a robot's legs reach while hips may turn late and get low: feet stand at fewer angles to each other."""
    reach = LegReach.of(robot)
    apart = toe_out_with_legs_apart(reach, robot, CROUCH_EXTENSION)
    low, high = (USABLE_TOE_OUT_SHARE * end for end in reach.toe_out_range)
    return replace(reach, toe_out_range=(max(low, apart[0]), min(high, apart[1])))


def reachable_foothold(
    reach: LegReach, foot: str, wanted: Foothold, start: Foothold, beside: Foothold, span: float
) -> Foothold:
    """The foothold nearest to a wanted one.

    Within a stride of the foot that stands, on its own side and clear of it, and no farther from its start than a foot
    gets in the time [s]; turned no farther than both hips and that time allow.

    Args:
        reach: of the legs, as of `live_reach`.
        foot: which one steps.
        wanted, start: where it is to land, and where it stood.
        beside: where the other foot stands.
        span: time in the air [s].
    """
    sign = 1.0 if foot == "left_foot" else -1.0
    low, high = sorted(sign * end for end in reach.toe_out_range)
    most = reach.turn_speed * span
    turn = float(np.clip(wrapped(wanted.heading - start.heading), -most, most))
    apart = float(np.clip(wrapped(start.heading + turn - beside.heading), low, high))
    heading = start.heading + wrapped(beside.heading + apart - start.heading)
    yaws = (heading, beside.heading) if sign > 0.0 else (beside.heading, heading)
    axes = body_axes(*yaws)
    across, ways = axes[1], normals() @ axes
    least = min_ankle_separation(yaws, reach, across)
    stride = reach.standing["left_foot"] + np.roll(reach.standing["right_foot"], DIRECTION_COUNT)
    far = USABLE_STRIDE_SHARE * stride + reach.hip_width * ways @ across
    far = np.maximum(far, least * ways @ across)
    anchor, before = np.array([beside.x, beside.y]), np.array([start.x, start.y])
    rows = np.vstack([-sign * across, sign * ways])
    bounds = np.concatenate([[-least], far]) + rows @ anchor
    swing = reach.swing_length(span, MAX_SWING_ACCELERATION_G * GRAVITY)
    swung = Polygon(np.vstack([rows, directions()]), np.concatenate([bounds, swing + directions() @ before]))
    place = swung.nearest_point(np.array([wanted.x, wanted.y]))
    if swung.margin(place) < -1e-6:  # nothing is in reach of both: time is what gives way
        place = Polygon(rows, bounds).nearest_point(np.array([wanted.x, wanted.y]))
    return Foothold(float(place[0]), float(place[1]), heading)


def foothold_between(one: Foothold, other: Foothold, share: float) -> Foothold:
    """The foothold a share of the way from one to another one."""
    x, y, heading = (
        before + share * (after - before)
        for before, after in ((one.x, other.x), (one.y, other.y), (one.heading, other.heading))
    )
    return Foothold(x, y, heading)
