"""A box taken from a stand, carried along a way on the robot's own steps, and set down: a motion without a human."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sot.gravity import GRAVITY
from sot.motion.balance.feet_led import feet_led
from sot.motion.balance.held_load import HeldLoad
from sot.motion.carrying.arms import Arms, palm_places
from sot.motion.carrying.handling_times import CLOSING_TIME, KNOT_PERIOD, REACHING_TIME, HandlingTimes
from sot.motion.feet.footwork import Foothold
from sot.motion.trajectory import Motion
from sot.motion.way import footsteps_along
from sot.robots.robot import Robot
from sot.robots.size import leg_length

Array = np.ndarray

HELD_AHEAD, HELD_HEIGHT = 0.62, 0.3  # leg lengths, of the box's middle from the waist, ahead and up, while it is held
LIFT = 0.12  # leg lengths, from where the box lies to where it is carried
HANDS_PITCH = 0.3  # rad, by which the fingers point down
STANDOFF = 0.16  # leg lengths, of the palms from the box before they touch it and when they have let go
LIFTING_TIME = 6.0  # √(leg / g), of lifting it


@dataclass(frozen=True)
class CarryPlan:
    """A motion with a box, and when it is what.

    Attributes:
        motion: of the robot; centre of mass, momentum and ZMP count the box while it is carried.
        box: its place at times `knots` (T,), in the world; where it lies before and after.
        knots: [s].
        gripped, lifted, placed, released: when hands take it, it leaves its stand, is set down, and hands let go [s].
        arrived: when the walk is over, and the box is lowered [s].
        hands: hand -> its place in the box's axes while it holds it.
        size: of the box, ahead, to the side and up [m].
    """

    motion: Motion
    box: Sequence[pin.SE3]
    knots: Array
    gripped: float
    lifted: float
    arrived: float
    placed: float
    released: float
    hands: dict[str, pin.SE3]
    size: tuple[float, float, float]

    @staticmethod
    def of(
        motion: Motion,
        box: Sequence[pin.SE3],
        knots: Array,
        times: HandlingTimes,
        hands: dict[str, pin.SE3],
        size: tuple[float, float, float],
    ) -> "CarryPlan":
        """The plan with the times at which the box is handled."""
        t = times
        return CarryPlan(motion, box, knots, t.gripped, t.lifted, t.arrived, t.placed, t.released, hands, size)


def carry(
    robot: Robot, size: tuple[float, float, float], mass: float, stops: Sequence[Foothold], rate: float = 1000.0
) -> CarryPlan:
    """The motion of a robot that takes a box from where it stands, carries it from stop to stop, and sets it down.

    The arms hold the box before the chest and stay as they are while the robot walks.

    Args:
        robot: who carries; it has surfaces "left_palm" and "right_palm".
        size: of the box, ahead, to the side, where the palms are, and up [m].
        mass: of the box [kg].
        stops: of the body, see `footsteps_along`.
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: arms or legs do not reach.
    """
    leg = leg_length(robot)
    unit = float(np.sqrt(leg / GRAVITY))
    raised = (1.0 + REACHING_TIME + CLOSING_TIME + LIFTING_TIME) * unit
    walked = footsteps_along(robot, stops, raised + unit)
    times = HandlingTimes.of(unit, walked.end, LIFTING_TIME, unit)
    knots = times.knots()
    arms = Arms(robot)
    kept = np.setdiff1d(np.arange(robot.na), robot.joint_numbers("legs"))
    height = HELD_HEIGHT * leg - LIFT * leg * (1.0 - times.raised_share(knots))

    def palms(height: float, gap: float = 0.0) -> dict[str, pin.SE3]:
        return palm_places(robot, size[1] + 2.0 * gap, HANDS_PITCH, np.array([HELD_AHEAD * leg, 0.0, height]))

    held = np.tile(low := arms.reaching(palms(height[0])), (len(knots), 1))
    for k in range(1, len(knots)):
        held[k] = held[k - 1] if height[k] == height[k - 1] else arms.reaching(palms(height[k]), held[k - 1])
    beside = arms.reaching(palms(height[0], STANDOFF * leg), low)
    rest = robot.rest[7 + arms.joints]
    reach, close = times.reach_share(knots)[:, None], times.close_share(knots)[:, None]
    angles = rest + reach * (beside - rest) + close * (held - beside)
    before = np.tile([HELD_AHEAD * leg, 0.0, 0.0], (len(knots), 1))
    before[:, 2] = height
    upper = np.tile(robot.rest[7 + kept], (len(knots), 1))
    upper[:, np.searchsorted(kept, arms.joints)] = angles
    load = HeldLoad(kept, upper, mass * times.carried_share(knots, times.raised), "chest", before - arms.chest)
    phases, paths = walked.feet_at(robot, knots)
    motion = feet_led(robot, phases, paths, KNOT_PERIOD, rate, where="its way", load=load)
    box = _box_path(motion, load, knots, times.lifted, times.placed)
    return CarryPlan.of(motion, box, knots, times, palm_places(robot, size[1], HANDS_PITCH), size)


def _box_path(motion: Motion, load: HeldLoad, knots: Array, lifted: float, placed: float) -> list[pin.SE3]:
    """Where the box is at the knots: before the chest while it is carried, else where it lies."""
    chest = motion.pose(load.point)
    found = []
    for t in np.clip(knots, lifted, placed):
        pose, k = chest(float(t)), int(np.searchsorted(knots, t))
        upright = pose.rotation @ chest(0.0).rotation.T
        place = pose.position + pose.rotation @ load.place[min(k, len(knots) - 1)]
        found.append(pin.SE3(upright, place))
    return found
