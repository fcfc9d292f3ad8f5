"""A cart pushed ahead with both hands, on the robot's own steps: a motion without a human."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.ndimage import convolve1d

from sot.gravity import GRAVITY
from sot.motion.balance.feet_led import feet_led
from sot.motion.balance.held_load import HeldLoad
from sot.motion.carrying.arms import Arms, fist_places
from sot.motion.feet.footwork import Foothold
from sot.motion.feet.support import FORCE_RAMP_TIME
from sot.motion.feet.swing import feet_middle
from sot.motion.trajectory import Motion
from sot.motion.way import Gait, footsteps_along
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.smooth import minimum_jerk

Array = np.ndarray

KNOT_PERIOD = 0.02  # s, between knots
STEP = 0.27  # leg lengths, of the body in a step
SWING_SHARE = 0.83  # of the time of a step, that its foot is in the air
MIN_STANDING_RAMPS = 2.5  # times that feet give their load away or take it: both need one while both feet stand
HANDS_AHEAD, HANDS_HEIGHT, HANDS_APART = (
    0.6,
    0.5,
    0.75,
)  # leg lengths, of the hands' ends from the waist while they push
REACHING_TIME, PRESSING_TIME = 8.0, 6.0  # √(leg / g): of the arms from rest, and in which the push comes and goes


@dataclass(frozen=True)
class PushPlan:
    """A motion with a cart, and when it is what.

    Attributes:
        motion: of the robot; its ZMP counts the push.
        wall: place of the cart's wall at the start, ahead of the origin [m].
        hands: hand -> place of its frame from the wall's foot while it pushes.
        knots: times (T,) [s].
        way: of the cart at these times (T,) [m].
        force: of the hands on the cart at these times (T,) [N].
        pressed, released: when hands touch it, and when they let go [s].
    """

    motion: Motion
    wall: float
    hands: dict[str, pin.SE3]
    knots: Array
    way: Array
    force: Array
    pressed: float
    released: float


def push(robot: Robot, way: float, speed: float, drag: float, rate: float = 1000.0) -> PushPlan:
    """The motion of a robot that pushes a cart straight ahead.

    The robot leans against the drag: its balance is planned with the force on its hands. The cart goes as the middle of
    the feet does, without their steps.

    Args:
        robot: who pushes; it has surfaces "left_hand_end" and "right_hand_end".
        way: how far [m].
        speed: of the cart on the way [m/s].
        drag: level force that the cart takes while it rolls [N].
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: arms or legs do not reach.
    """
    leg = leg_length(robot)
    unit = float(np.sqrt(leg / GRAVITY))
    step_time = way / np.ceil(way / (STEP * leg)) / speed / unit
    standing = max((1.0 - SWING_SHARE) * step_time, MIN_STANDING_RAMPS * FORCE_RAMP_TIME / unit)
    gait = Gait(STEP, step_time - standing, standing)
    window = 2.0 * step_time * unit
    pressed = (REACHING_TIME + 1.0) * unit
    begin = pressed + (PRESSING_TIME + 1.0) * unit + window
    walked = footsteps_along(robot, [Foothold(way, 0.0, 0.0)], begin, gait)
    released = walked.end + (PRESSING_TIME + 1.0) * unit
    end = released + (REACHING_TIME + 1.0) * unit
    knots = KNOT_PERIOD * np.arange(np.ceil(end / KNOT_PERIOD) + 1)

    def share(start: float, end: float) -> Array:
        return np.asarray(minimum_jerk((knots - start) / (end - start)))

    phases, paths = walked.feet_at(robot, knots)
    force = drag * (share(pressed, pressed + PRESSING_TIME * unit) - share(walked.end, released - unit))
    arms = Arms(robot)
    middle = leg * np.array([HANDS_AHEAD, 0.0, HANDS_HEIGHT])
    pushing, rest = arms.reaching(fist_places(robot, HANDS_APART * leg, middle)), robot.rest[7 + arms.joints]
    reach = share(unit, pressed) - share(released, end - unit)
    kept = np.setdiff1d(np.arange(robot.na), robot.joint_numbers("legs"))
    upper = np.tile(robot.rest[7 + kept], (len(knots), 1))
    upper[:, np.searchsorted(kept, arms.joints)] += reach[:, None] * (pushing - rest)
    back = np.column_stack([-force, np.zeros((len(knots), 2))])
    place = np.tile(middle - arms.chest, (len(knots), 1))
    load = HeldLoad(kept, upper, np.zeros(len(knots)), "chest", place, back)
    motion = feet_led(robot, phases, paths, KNOT_PERIOD, rate, where="its way", load=load)
    waist = motion.pose("waist")(0.0).position
    lean = float(load.com_shift(waist[2] + middle[2], robot.mass * GRAVITY)[:, 0].max())
    wall = float(waist[0] + middle[0] + lean)
    hands = fist_places(robot, HANDS_APART * leg, np.array([0.0, 0.0, waist[2] + middle[2]]))
    return PushPlan(motion, wall, hands, knots, _smoothed(feet_middle(paths)[:, 0], window), force, pressed, released)


def _smoothed(way: Array, window: float) -> Array:
    """A way (T,) from its start, without what is faster than a window [s]."""
    count = 2 * round(0.5 * window / KNOT_PERIOD) + 1
    weights = np.hanning(count + 2)[1:-1]
    smooth: Array = convolve1d(way - way[0], weights / weights.sum(), mode="nearest")
    return smooth
