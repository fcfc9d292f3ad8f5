"""A walk straight ahead and back, on the floor or on a slope, without a human to follow."""

from collections.abc import Sequence

import numpy as np

from sot.errors import InputError
from sot.motion.balance.feet_led import feet_led
from sot.motion.feet.footwork import Foothold
from sot.motion.ground import Ground
from sot.motion.trajectory import Motion
from sot.motion.way import footsteps_along
from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface

KNOT_PERIOD = 0.02  # s, between knots


def walk(robot: Robot, ways: Sequence[float], rate: float = 1000.0, ground: Surface = FLOOR) -> Motion:
    """The motion of a robot that walks straight, without turning, and ends at rest.

    Args:
        robot: who walks.
        ways: how far, one way after the other, seen from above; negative ones backward [m].
        rate: samples per second of the motion [Hz].
        ground: surface of the world that it stands and walks on, level or not.

    Raises:
        InputError: there is no way to walk, or legs and soles do not reach on that ground.
    """
    if not len(ways) or not all(np.isfinite(way) and way for way in ways):
        raise InputError(f"a walk needs one way or more, each of some length [m], not {list(ways)}")
    stops = [Foothold(float(x), 0.0, 0.0) for x in np.cumsum(ways)]
    walked = footsteps_along(robot, stops)
    times = KNOT_PERIOD * np.arange(np.ceil(walked.end / KNOT_PERIOD) + 1)
    phases, paths = walked.feet_at(robot, times)
    plane = Ground(ground)
    return feet_led(
        robot,
        plane.laid_phases(robot, phases),
        plane.laid_paths(paths),
        KNOT_PERIOD,
        rate,
        lambda _, places: plane.height(places),
        ground.name,
    )
