"""Heel rises: a foot that is left behind turns about the front edge of its sole, before and after it leaves the floor.

With both soles flat, the longer a step, the lower must the hips be from which both legs reach. A heel that rises brings
the ankle up and nearer.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.motion.feet.footholds import LEAST_JERK_PEAK, LegReach, standing_pairs
from sot.motion.feet.footwork import Foothold, Step
from sot.motion.feet.support import FORCE_RAMP_TIME
from sot.robots.leg_range import MAX_EXTENSION
from sot.robots.robot import Robot
from sot.smooth import MINIMUM_JERK_PEAK_SPEED, minimum_jerk

Array = NDArray[np.float64]

MAX_ANGLE = 0.6  # rad
MIN_ANGLE = 0.05  # rad: less is not worth it
SETTLING_TIME = 0.02  # s after another foot carries, in which the zero-moment point gets to the toes
MAX_STANDING_TIME = 0.8  # √(leg / g), before the foot leaves the floor, in which its heel rises
TOP_SHARE, FLAT_SHARE = 0.25, 0.85  # of a swing that are over when the heel is highest, and when the foot is flat again
SPEED_SHARE = 0.8  # of the legs' speed limit, that a heel rises with
ACCELERATION_SHARE = 0.9  # of the legs' acceleration limit, up
SWING_ACCELERATION_SHARE = 0.7  # of it, down: the swing takes the rest
ANGLES_TRIED = 31
MIN_PROFILE = 0.15  # share of a rise that is over: what is needed before comes too early


@dataclass(frozen=True)
class HeelRise:
    """A turn of a foot about its toes' edge by `angle` [rad]: up from `start` to `top`, and down until `flat` [s]."""

    start: float
    top: float
    flat: float
    angle: float

    def angles(self, times: Array) -> Array:
        """The angle at times (T,) [rad]."""
        return self.angle * self.profile(times)

    def profile(self, times: Array) -> Array:
        """The angle at times (T,) over the greatest."""
        up, down = (times - self.start) / (self.top - self.start), (self.flat - times) / (self.flat - self.top)
        return minimum_jerk(np.minimum(up, down))


@dataclass(frozen=True)
class Toes:
    """Where the front edge of a flat sole is ahead of its ankle, and how high the ankle is above it [m]."""

    ahead: float
    height: float

    @staticmethod
    def of(robot: Robot, foot: str) -> "Toes":
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, robot.rest)
        ankle, pose = data.oMf[robot.point(foot.replace("foot", "ankle"))].translation, data.oMf[robot.point(foot)]
        corners = np.array([pose.act(corner) for corner in robot.sole(foot)]) - ankle
        return Toes(float(corners[:, 0].max()), -float(corners[:, 2].min()))

    def ankle_shift(self, angles: Array) -> Array:
        """How far the ankle moves ahead and up (n, 2) as the foot turns about its toes by angles (n,) [m]."""
        cosine, sine = np.cos(angles), np.sin(angles)
        return np.column_stack(
            [self.ahead * (1.0 - cosine) + self.height * sine, self.ahead * sine - self.height * (1.0 - cosine)]
        )


def heel_rises(
    robot: Robot,
    stands: Mapping[str, Sequence[Foothold]],
    steps: Sequence[Step],
    hips: Array,
    heading: Array,
    times: Array,
    reach: LegReach,
) -> tuple[HeelRise | None, ...]:
    """The heel rise of each step, by the least angle with which the leg reaches its foothold from hips that are as high
    as the dancer's; None where it needs none or has no time for it.

    Args:
        robot: who steps.
        stands: foot -> its footholds.
        steps: in order of time.
        hips: (T, 3) of their middle, as they are to be [m].
        heading: (T,) of the pelvis [rad].
        times: (T,) [s].
        reach: of the robot's legs.
    """
    legs, unit = list(robot.groups["legs"]), float(np.sqrt(reach.leg_length / GRAVITY))
    speed = SPEED_SHARE * float(np.median(robot.velocity[legs]))
    acceleration = float(np.median(robot.acceleration[legs]))
    toes = {foot: Toes.of(robot, foot) for foot in stands}
    carries = dict.fromkeys(stands, -np.inf)  # since when, by foot
    found: list[HeelRise | None] = []
    for step, before in zip(steps, standing_pairs(steps), strict=False):
        here = stands[step.foot][before[robot.feet.index(step.foot)]]
        settled = max(carries.values()) + FORCE_RAMP_TIME + SETTLING_TIME
        start, swing = max(settled, step.lift - MAX_STANDING_TIME * unit), step.land - step.lift
        carries[step.foot] = step.land
        rise = HeelRise(start, step.lift + TOP_SHARE * swing, step.lift + FLAT_SHARE * swing, 1.0)
        rows = np.flatnonzero((times < rise.top) & (rise.profile(times) > MIN_PROFILE))
        if step.lift - start < FORCE_RAMP_TIME or not len(rows):
            found.append(None)
            continue
        side = 0.5 * reach.hip_width * (1.0 if step.foot == robot.feet[0] else -1.0)
        hip = hips[rows] + side * np.column_stack([-np.sin(heading[rows]), np.cos(heading[rows]), np.zeros(len(rows))])
        needed = _needed_angles(toes[step.foot], here, hip, MAX_EXTENSION * reach.leg_length)
        up, down = rise.top - rise.start, rise.flat - rise.top
        light = min(ACCELERATION_SHARE * up**2, SWING_ACCELERATION_SHARE * down**2) * acceleration / LEAST_JERK_PEAK
        most = min(MAX_ANGLE, speed * up / MINIMUM_JERK_PEAK_SPEED, light)
        angle = min(float((needed / rise.profile(times[rows])).max()), most)
        found.append(HeelRise(rise.start, rise.top, rise.flat, angle) if angle > MIN_ANGLE else None)
    return tuple(found)


def _needed_angles(toes: Toes, here: Foothold, hip: Array, length: float) -> Array:
    """The least angles (n,) at which the ankle of a foot is no farther than a length from hips (n, 3), or as near as
    MAX_ANGLE allows [rad]."""
    angles = np.linspace(0.0, MAX_ANGLE, ANGLES_TRIED)
    shift, forward = toes.ankle_shift(angles), np.array([np.cos(here.heading), np.sin(here.heading)])
    ankles = np.column_stack([[here.x, here.y] + shift[:, :1] * forward, toes.height + shift[:, 1]])
    far = np.linalg.norm(hip[:, None] - ankles, axis=2)
    enough = far <= length
    return angles[np.where(enough.any(axis=1), enough.argmax(axis=1), far.argmin(axis=1))]
