"""Measures of how much a robot's legs do what a human's do: how straight they are, and how high feet get.

Lengths count in leg lengths of their owner, so that sizes do not matter.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects, label

from sot.motion.human.human import SIDES
from sot.motion.likeness import Points

Array = NDArray[np.float64]

STANDING_PERCENTILE = 10.0  # of the heights of a foot's point: where it is while it stands
CLEAR_HEIGHT = 0.03  # leg lengths above its standing height: a foot of which all is higher is in the air
MIN_LIFT = 0.06  # leg lengths above its standing height that an ankle gets to: less is no lift
MAX_LIFT_DELAY = 0.3  # s, by which a robot's lift may be off the human's


class Lift(NamedTuple):
    """A time in which a human lifts a foot: whose, its first and last frame, and how high the ankle gets [leg
    lengths]."""

    side: str
    first: int
    last: int
    height: float


def knee_bend_deg(human: Points, robot: Points) -> float:
    """By how much more the robot's knees are bent than the human's, mean over time and sides [deg]."""
    return float(np.degrees(np.mean([knee_bend(robot, side) - knee_bend(human, side) for side in SIDES])))


def knee_bend(body: Points, side: str) -> Array:
    """Angle (T,) by which a knee is bent, zero where the leg is straight [rad]."""
    hip, knee, ankle = (body[f"{side}_{joint}"] for joint in ("hip", "knee", "ankle"))
    thigh, shank = knee - hip, ankle - knee
    return np.arctan2(np.linalg.norm(np.cross(thigh, shank), axis=1), np.sum(thigh * shank, axis=1))


def foot_lift_ratio(human: Points, robot: Points, rate: float) -> float | None:
    """How high the robot's ankles get over how high the human's do, of the lifts that the human makes; None of none.

    A lift of the robot that is higher than the human's makes up for no other that is lower.

    rate: of the frames [Hz].
    """
    lifts = foot_lifts(human)
    if not lifts:
        return None
    return sum(
        min(height, lift.height) for height, lift in zip(robot_lifts(robot, lifts, rate), lifts, strict=True)
    ) / sum(lift.height for lift in lifts)


def foot_lifts(human: Points) -> list[Lift]:
    """The lifts of both feet: the times in which all of a foot is in the air, and its ankle gets to MIN_LIFT."""
    found = []
    for side in SIDES:
        ankle, toe = _heights(human, side, "ankle"), _heights(human, side, "toe")
        for (frames,) in find_objects(label(np.minimum(ankle, toe) > CLEAR_HEIGHT)[0]):
            height = float(ankle[frames].max())
            if height >= MIN_LIFT:
                found.append(Lift(side, frames.start, frames.stop - 1, height))
    return found


def robot_lifts(robot: Points, lifts: list[Lift], rate: float) -> list[float]:
    """How high the robot's ankle gets in each of the human's lifts, within MAX_LIFT_DELAY of it and nearer to it than
    to that foot's other ones [leg lengths]."""
    around, found = round(MAX_LIFT_DELAY * rate), []
    for lift in lifts:
        height = _heights(robot, lift.side, "ankle")
        first, last = max(0, lift.first - around), min(len(height) - 1, lift.last + around)
        for other in lifts:
            if other.side == lift.side and other.last < lift.first:
                first = max(first, (other.last + lift.first) // 2)
            elif other.side == lift.side and other.first > lift.last:
                last = min(last, (lift.last + other.first) // 2)
        found.append(float(height[first : last + 1].max()))
    return found


def _heights(body: Points, side: str, point: str) -> Array:
    """The heights (T,) of a point of a foot above where the lower of both feet's stands [leg lengths]."""
    level = min(float(np.percentile(body[f"{one}_{point}"][:, 2], STANDING_PERCENTILE)) for one in SIDES)
    bones = [
        np.median(np.linalg.norm(body[f"{one}_{far}"] - body[f"{one}_{near}"], axis=1))
        for one in SIDES
        for near, far in (("hip", "knee"), ("knee", "ankle"))
    ]
    return (body[f"{side}_{point}"][:, 2] - level) / (0.5 * float(np.sum(bones)))
