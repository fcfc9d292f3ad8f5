"""What carries a human besides its feet on the floor: hands, knees, or something above the floor.

A human who climbs is put over level ground, and what each foot stood on is kept.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.motion.human.human import SIDES, Human
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

HAND_HEIGHT = 0.16  # leg lengths above the floor: a wrist is below while its hand is on it
KNEE_HEIGHT = 0.15  # the same of a knee
OFF_FLOOR_HEIGHT = 0.08  # leg lengths: the lower foot of who is off the floor is higher
MIN_STANCE_HEIGHT = 0.03  # leg lengths, above the floor, of a foot on its way up or down: less is on it
FLOOR_PERCENTILE = 10.0  # of an ankle's height: that of a standing one
STILL_SPEED = 0.2  # leg lengths/s, of a foot that stands on something
MIN_STANCE_DURATION = 0.5  # times √(leg / g): a foot that is still for less stands on nothing
MIN_FLIGHT_S = 0.2  # s, of both feet off the floor
MIN_RISE_SHARE = 0.5  # of g T²/8, by which the body of who leaps for T rises; legs that are drawn up hide some of it
MIN_ONE_LEG_SHARE = 0.9  # of the clip, on one leg


@dataclass(frozen=True)
class OffFloor:
    """A stretch of frames, start and end (exclusive), with both feet off the floor, that no leap explains.

    Attributes:
        stands: whether a foot stands on something there, most of the time.
        height: of the lower foot, at most [m].
        rise: of the body, over the way that it would take without gravity [m].
    """

    first: int
    end: int
    stands: bool
    height: float
    rise: float


def hands_down(human: Human) -> tuple[Flags, Flags]:
    """The frames (T,) with a hand on the floor, and those with both."""
    height = np.stack([human.points[f"{side}_wrist"][:, 2] for side in SIDES])
    low: Flags = height < HAND_HEIGHT * human.leg
    return low[0] | low[1], low[0] & low[1]


def kneeling(human: Human) -> Flags:
    """The frames (T,) with a knee on the floor."""
    height = np.min([human.points[f"{side}_knee"][:, 2] for side in SIDES], axis=0)
    low: Flags = height < KNEE_HEIGHT * human.leg
    return low


def stretches_off_floor(human: Human) -> list[OffFloor]:
    """Where both feet are off the floor for longer than gravity allows: a flight of T seconds rises by g T²/8."""
    foot = _foot_heights(human)
    lower = foot.min(axis=0)
    speed = np.min(
        [np.linalg.norm(np.gradient(human.points[f"{s}_ankle"], axis=0), axis=1) * human.rate for s in SIDES], axis=0
    )
    body = 0.5 * (human.points["waist"][:, 2] + human.points["neck"][:, 2])
    off = lower > OFF_FLOOR_HEIGHT * human.leg
    edges = np.flatnonzero(np.diff(off.astype(np.int8), prepend=0, append=0))
    found = []
    for first, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        flight = (end - first) / human.rate
        straight = np.linspace(body[first], body[end - 1], end - first)
        rise = float(np.max(body[first:end] - straight))
        if flight >= MIN_FLIGHT_S and rise < MIN_RISE_SHARE * GRAVITY * flight**2 / 8.0:
            stands = bool(np.mean(speed[first:end] < STILL_SPEED * human.leg) > 0.5)
            found.append(OffFloor(first, end, stands, float(lower[first:end].max()), rise))
    return found


def leg_stood_on(human: Human) -> str:
    """The leg that a human stands on all the time, the other foot in the air; empty if it uses both."""
    up = _foot_heights(human) > OFF_FLOOR_HEIGHT * human.leg
    alone = [bool(np.mean(up[1 - k] & ~up[k]) >= MIN_ONE_LEG_SHARE) for k in range(len(SIDES))]
    return next((side for side, only in zip(SIDES, alone, strict=True) if only), "")


def over_level_ground(human: Human, climbs: Sequence[OffFloor]) -> Human:
    """The human who climbs, each foot lowered by the height of what it stands on, and the body by the mean of both.

    `ground` has these heights added. From one stance of a foot to the next they change with least jerk.

    Args:
        human: the clip.
        climbs: stretches in which it stands above the floor.
    """
    levels = dict(zip(SIDES, _levels(human, climbs), strict=True))
    return human.lowered({f"{side}_{joint}": level for side, level in levels.items() for joint in ("ankle", "toe")})


def _levels(human: Human, climbs: Sequence[OffFloor]) -> list[Array]:
    """Height (T,) of what each foot stands on, from its last stance to its next one while it is in the air [m]."""
    frames, found = np.arange(human.count), []
    shortest = MIN_STANCE_DURATION * human.leg_time * human.rate
    for side, height in zip(SIDES, _foot_heights(human), strict=True):
        speed = np.linalg.norm(np.gradient(human.points[f"{side}_ankle"], axis=0), axis=1) * human.rate
        still = speed < STILL_SPEED * human.leg
        edges = np.flatnonzero(np.diff(still.astype(np.int8), prepend=0, append=0)).reshape(-1, 2)
        stances = edges[edges[:, 1] - edges[:, 0] >= shortest]
        heights = np.array([np.median(height[first:end]) for first, end in stances])
        level, last, now = np.zeros(human.count), 0, 0.0
        for (first, end), stance in zip(stances.tolist(), _climbed(stances, heights, climbs, human.leg), strict=True):
            level[last:] = now + (stance - now) * minimum_jerk((frames[last:] - last) / max(first - last, 1))
            last, now = end, stance
        found.append(level)
    return found


def _climbed(stances: NDArray[np.int_], heights: Array, climbs: Sequence[OffFloor], leg: float) -> Array:
    """The heights (n,) of a foot's stances where it climbs, 0 elsewhere.

    Its way up and down counts, in which the other foot may be on the floor: stances above it, one after the other, one
    of which is among the climbs.

    stances: their first frames and their ends (n, 2).
    """
    first, end = stances.T
    above = heights > MIN_STANCE_HEIGHT * leg
    stretch = np.cumsum(np.diff(above, prepend=False) != 0)
    during = np.any([(first < one.end) & (one.first < end) for one in climbs], axis=0)
    climbed = above & np.isin(stretch, stretch[during & (heights > OFF_FLOOR_HEIGHT * leg)])
    return np.where(climbed, heights, 0.0)


def _foot_heights(human: Human) -> Array:
    """(2, T) heights of the lowest point of each foot over that of a standing one [m]."""
    ankles = np.stack([human.points[f"{side}_ankle"][:, 2] for side in SIDES])
    toes = np.stack([human.points[f"{side}_toe"][:, 2] for side in SIDES])
    levels = [np.percentile(heights.min(axis=0), FLOOR_PERCENTILE) for heights in (ankles, toes)]
    heights: Array = np.minimum(ankles - levels[0], toes - levels[1])
    return heights
