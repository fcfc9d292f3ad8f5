"""A walk straight ahead and back, on the floor or on a slope, without a human to follow."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.balance.feet_led import feet_led
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import Foothold, Step
from sot.motion.feet.swing import contact_phases, foot_paths
from sot.motion.ground import Ground
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.surface import FLOOR, Surface

KNOT_PERIOD = 0.02  # s, between knots
MAX_STEP = 0.18  # leg lengths, from one foot to where the other one lands beside or ahead of it
STEP_HEIGHT = 0.09  # leg lengths
SWING_TIME, STANDING_TIME = 2.4, 1.2  # √(leg / g): of a step, and on both feet before the next one
WAITING_TIME = 4.8  # √(leg / g) on both feet at the start, at each turn and at the end


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
    leg = leg_length(robot)
    unit = float(np.sqrt(leg / GRAVITY))
    stands, steps, now = {foot: [place] for foot, place in _standing(robot).items()}, list[Step](), WAITING_TIME * unit
    for way in ways:
        feet = robot.feet if len(steps) % 2 else robot.feet[::-1]
        count = int(np.ceil(abs(way) / (MAX_STEP * leg) - 1e-9))
        start = {foot: stands[foot][-1] for foot in feet}
        for k in range(count + 1):
            foot, share = feet[k % 2], min(k + 1, count) / count
            here = start[foot]
            steps.append(Step(foot, now, now + SWING_TIME * unit))
            stands[foot].append(
                Foothold(
                    here.x + share * way * np.cos(here.heading),
                    here.y + share * way * np.sin(here.heading),
                    here.heading,
                )
            )
            now += (SWING_TIME + STANDING_TIME) * unit
        now += (WAITING_TIME - STANDING_TIME) * unit
    times = KNOT_PERIOD * np.arange(np.ceil(now / KNOT_PERIOD) + 1)
    phases = contact_phases(robot, stands, steps, float(times[-1]))
    paths = foot_paths(robot, stands, steps, [STEP_HEIGHT * leg] * len(steps), LegReach.of(robot), times)
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


def _standing(robot: Robot) -> dict[str, Foothold]:
    """Where the feet stand at rest; headings count from there."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    ankles = {foot: data.oMf[robot.point(foot.replace("foot", "ankle"))].translation for foot in robot.feet}
    return {foot: Foothold(float(place[0]), float(place[1]), 0.0) for foot, place in ankles.items()}
