"""A person's feet as they come: which of them touch the floor, where they stand, and where a foot in the air is going.

The causal form of `sot.motion.feet.footwork.foot_track`, with the same heights and speeds.
"""

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import atan2, cos, sin

import numpy as np
from numpy.typing import NDArray

from sot.live.person import Moment
from sot.motion.feet.footwork import (
    MIN_SEEN_LENGTH,
    RELEASE_HEIGHT,
    RELEASE_SPEED,
    SLIDING_SPEED,
    STANDING_PERCENTILE,
    TOUCH_HEIGHT,
    TOUCH_SPEED,
    Foothold,
)
from sot.motion.human.human import SIDES

Array = NDArray[np.float64]

LEVEL_SAMPLES = 400
"""Heights of slow points that are remembered: their low ones are the floor's."""
MIN_ELAPSED = 1e-3
"""Time between two moments below which no speed is told [s]."""
POINTS = ("ankle", "toe")


@dataclass
class FootState:
    """What is known of a person's foot at one time.

    Attributes:
        place: where it stands, or is over the floor.
        touches: whether it touches the floor.
        is_still: whether it touches and does not slide.
        height: of its lowest point over standing [m].
        speed: of its slowest point [m/s].
    """

    place: Foothold
    touches: bool = True
    is_still: bool = True
    height: float = 0.0
    speed: float = 0.0


@dataclass
class _Track:
    """What is remembered of one foot."""

    points: dict[str, Array] | None = None
    aside: float = 0.0
    flat: float = 0.0
    touches: bool = True
    flat_seen: deque[float] = field(default_factory=lambda: deque(maxlen=LEVEL_SAMPLES))


class FootSense:
    """Tells of each moment what the feet do.

    Args:
        leg: length of the person's legs [m].

    Attributes:
        level: height of a standing ankle [m].
    """

    def __init__(self, leg: float) -> None:
        self._leg = leg
        self._tracks = {side: _Track() for side in SIDES}
        self._slow: dict[str, deque[float]] = {point: deque(maxlen=LEVEL_SAMPLES) for point in POINTS}
        self._levels = dict.fromkeys(POINTS, 0.0)
        self._at = -np.inf

    @property
    def level(self) -> float:
        """Height of a standing ankle [m]."""
        return self._levels["ankle"]

    def __call__(self, moment: Moment, t: float) -> Mapping[str, FootState]:
        """Foot -> what it does at a time [s]."""
        elapsed, self._at = t - self._at, t
        speeds = {side: self._point_speeds(side, moment, elapsed) for side in SIDES}
        for point in POINTS:
            for side in SIDES:
                if not self._slow[point] or speeds[side][point] < TOUCH_SPEED * self._leg:
                    self._slow[point].append(float(moment.points[f"{side}_{point}"][2]))
            self._levels[point] = percentile(self._slow[point], STANDING_PERCENTILE)
        return {f"{side}_foot": self._state(side, moment, speeds[side]) for side in SIDES}

    def _point_speeds(self, side: str, moment: Moment, elapsed: float) -> dict[str, float]:
        track = self._tracks[side]
        now = {point: moment.points[f"{side}_{point}"] for point in POINTS}
        before, track.points = track.points, now
        if before is None or elapsed < MIN_ELAPSED:
            return dict.fromkeys(POINTS, 0.0)
        return {point: float(np.linalg.norm(now[point] - before[point])) / elapsed for point in POINTS}

    def _state(self, side: str, moment: Moment, speeds: Mapping[str, float]) -> FootState:
        track, leg = self._tracks[side], self._leg
        heights = {point: float(moment.points[f"{side}_{point}"][2]) - self._levels[point] for point in POINTS}
        touch = any(heights[p] < TOUCH_HEIGHT * leg and speeds[p] < TOUCH_SPEED * leg for p in POINTS)
        stay = any(heights[p] < RELEASE_HEIGHT * leg and speeds[p] < RELEASE_SPEED * leg for p in POINTS)
        track.touches = touch or (track.touches and stay)
        slowest = min((speeds[p] for p in POINTS if heights[p] < RELEASE_HEIGHT * leg), default=np.inf)
        place = self._place(track, side, moment, max(heights.values()))
        still = track.touches and slowest < SLIDING_SPEED * leg
        return FootState(place, track.touches, still, max(min(heights.values()), 0.0), min(speeds.values()))

    def _place(self, track: _Track, side: str, moment: Moment, highest: float) -> Foothold:
        """The place under the ankle, were the sole flat, and the heading, as far as the foot shows one."""
        ankle, toe = (moment.points[f"{side}_{point}"][:2] for point in POINTS)
        forward = moment.frames["pelvis"][:, 0]
        pelvis = float(np.arctan2(forward[1], forward[0]))
        along = toe - ankle
        seen = float(np.linalg.norm(along))
        if not track.flat_seen or highest < TOUCH_HEIGHT * self._leg:
            track.flat_seen.append(seen)
        flat = percentile(track.flat_seen, 50.0)
        aside = wrapped(float(np.arctan2(along[1], along[0])) - pelvis)
        if seen > MIN_SEEN_LENGTH * flat and abs(aside) < 0.5 * np.pi:
            track.aside = aside
        heading = pelvis + track.aside
        x, y = toe - flat * np.array([np.cos(heading), np.sin(heading)])
        return Foothold(float(x), float(y), heading)


def wrapped(angle: float) -> float:
    """The angle within ±π [rad]."""
    return atan2(sin(angle), cos(angle))


def percentile(values: Iterable[float], percent: float) -> float:
    """A percentile of some values, linear between them: numpy's takes ten times as long for so few."""
    ordered = sorted(values)
    place = 0.01 * percent * (len(ordered) - 1)
    k = min(int(place), len(ordered) - 2) if len(ordered) > 1 else 0
    return ordered[k] + (place - k) * (ordered[min(k + 1, len(ordered) - 1)] - ordered[k])
