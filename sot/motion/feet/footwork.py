"""The steps of a dancer: when each foot stands, slides or swings, and which of its moves become steps.

Heights and speeds count in leg lengths of the dancer, heights from where each foot usually stands, so that neither a
dancer's size nor a floor a little off matters.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.stance import LEAD_IN_TIME, TAIL_TIME
from sot.motion.human.human import SIDES, Human
from sot.robots.surface import FLOOR, Surface

Array = NDArray[np.float64]
Modes = NDArray[np.int8]
Flags = NDArray[np.bool_]

FREE, SLIDING, FIXED = 0, 1, 2
TOUCH_HEIGHT = 0.03  # leg lengths above its standing height: a lower foot may touch the floor
RELEASE_HEIGHT = 0.06  # leg lengths above its standing height: a higher foot does not touch the floor
TOUCH_SPEED = 0.35  # leg lengths/s: a slower low foot touches the floor
RELEASE_SPEED = 0.6  # leg lengths/s: a faster foot does not touch the floor
SLIDING_SPEED = 0.15  # leg lengths/s: a touching foot that moves faster slides
SLIDING_YAW_RATE = 1.2  # rad/s: a touching foot that turns faster slides
STANDING_PERCENTILE = 20.0  # of a slow foot's height: the height of a standing foot
MIN_SEEN_LENGTH = 0.5  # of a flat foot's length, seen from above: a shorter one points up or down, and has no heading
MAX_TOE_OUT = 1.6  # rad, between a foot's heading and the pelvis': more is a capture's error
MIN_STEP_LENGTH = 0.07, 0.13  # leg lengths: a shorter move of a free foot, of a sliding foot, makes no step
MIN_STEP_TURN = 0.3  # rad: a foot that turns by more makes a step
MIN_STEP_HEIGHT = 0.12  # leg lengths: a foot that is lifted higher makes a step, even on the spot
END_SWING_TIME = 0.4  # s of the lead-in and of the tail that a foot in the air at the clip's ends gets for its swing
MIN_TOUCH_TIME = 0.08  # s: a shorter touch between two moves does not part them


@dataclass(frozen=True)
class FootTrack:
    """A dancer's foot over time, seen on the floor.

    Attributes:
        place: (T, 2) under the ankle were the sole flat [m].
        heading: (T,) unwrapped [rad].
        toe_drop: (T,) by how much lower than as it stands its toes are, seen from the ankle [m].
        lift: (T,) height of its lowest point over standing [m].
        mode: (T,) FREE, SLIDING or FIXED.
    """

    place: Array
    heading: Array
    toe_drop: Array
    lift: Array
    mode: Modes


@dataclass(frozen=True)
class Foothold:
    """Where a foot stands.

    Attributes:
        x, y: of the point below its ankle [m].
        heading: unwrapped [rad].
        surface: under it.
        passed: height of what the foot comes over on its way there [m].
    """

    x: float
    y: float
    heading: float
    surface: Surface = FLOOR
    passed: float = 0.0

    @property
    def height(self) -> float:
        """Of the surface there [m]."""
        return float(self.surface.height_at(np.array([self.x, self.y])))


@dataclass(frozen=True)
class Step:
    """A step of one foot, which leaves the floor at `lift` and is back at `land` [s]."""

    foot: str
    lift: float
    land: float


def foot_track(human: Human, side: str) -> FootTrack:
    """The track of a human's foot on the motion's time line; it stands in most of the lead-in and of the tail."""
    ankle, toe = human.points[f"{side}_ankle"], human.points[f"{side}_toe"]
    leg, dt = human.leg, 1.0 / human.rate
    heights, speeds = [], []
    for point in ("ankle", "toe"):
        levels = {one: _standing_level(human.points[f"{one}_{point}"], human) for one in SIDES}
        lowest, own = min(level for level, _ in levels.values()), levels[side]
        # A foot that never gets down to where the other one stands never stands.
        floor = own[0] if own[0] - lowest < MIN_STEP_HEIGHT * leg else lowest
        heights.append(human.points[f"{side}_{point}"][:, 2] - floor)
        speeds.append(own[1])
    height, speed = np.array(heights), np.array(speeds)

    along = (toe - ankle)[:, :2]
    reach = np.linalg.norm(along, axis=1)
    low = height.max(axis=0) < TOUCH_HEIGHT * leg
    flat = float(np.median(reach[low] if low.any() else reach))
    pelvis = np.unwrap(np.arctan2(human.frames["pelvis"][:, 1, 0], human.frames["pelvis"][:, 0, 0]))
    aside = np.angle(np.exp(1j * (np.arctan2(along[:, 1], along[:, 0]) - pelvis)))
    heading = pelvis + _interpolated(aside, (reach > MIN_SEEN_LENGTH * flat) & (np.abs(aside) < MAX_TOE_OUT))
    place = toe[:, :2] - flat * np.column_stack([np.cos(heading), np.sin(heading)])

    touching = _hysteresis(
        np.any((height < TOUCH_HEIGHT * leg) & (speed < TOUCH_SPEED * leg), axis=0),
        np.any((height < RELEASE_HEIGHT * leg) & (speed < RELEASE_SPEED * leg), axis=0),
    )
    still = np.where(height < RELEASE_HEIGHT * leg, speed, np.inf).min(axis=0) < SLIDING_SPEED * leg
    still &= np.abs(np.gradient(heading, dt)) < SLIDING_YAW_RATE
    mode = np.where(touching, np.where(still, FIXED, SLIDING), FREE).astype(np.int8)
    mode[: round((LEAD_IN_TIME - END_SWING_TIME) * human.rate)] = FIXED
    mode[len(mode) - round((TAIL_TIME - END_SWING_TIME) * human.rate) :] = FIXED
    drop = ankle[:, 2] - toe[:, 2]
    drop -= np.median(drop[mode == FIXED])
    return FootTrack(place, heading, drop, np.maximum(height.min(axis=0), 0.0), mode)


def _standing_level(point: Array, human: Human) -> tuple[float, Array]:
    """The height [m] of a point (T, 3) of a foot while it stands, and its speed (T,) [m/s]."""
    speed = np.linalg.norm(np.gradient(point, 1.0 / human.rate, axis=0), axis=1)
    slow = speed <= max(TOUCH_SPEED * human.leg, float(np.percentile(speed, STANDING_PERCENTILE)))
    return float(np.percentile(point[slow, 2], STANDING_PERCENTILE)), speed


def find_steps(feet: Mapping[str, FootTrack], rate: float, leg: float) -> tuple[Step, ...]:
    """The steps of both feet, in order of their middles; steps of two feet may still overlap.

    A foot that ends up near where it stood, without having been lifted much, keeps standing there: its drift adds up
    until it makes a step. Before the first and after the last frame both feet stand.
    """
    found = [
        Step(foot, first / rate, last / rate)
        for foot, track in feet.items()
        for first, last in _worthwhile_moves(track, round(MIN_TOUCH_TIME * rate), leg)
    ]
    return tuple(sorted(found, key=lambda step: step.lift + step.land))


def footholds(feet: Mapping[str, FootTrack], moves: Sequence[Step], rate: float) -> dict[str, list[Foothold]]:
    """The footholds of both feet before, between and after their steps: foot -> one more than it has steps."""
    return {
        foot: [
            _median_foothold(track, frames)
            for frames in stance_frames(track, [move for move in moves if move.foot == foot], rate)
        ]
        for foot, track in feet.items()
    }


def stance_frames(track: FootTrack, moves: Sequence[Step], rate: float) -> list[NDArray[np.int_]]:
    """The frames in which a foot stands before, between and after its steps: those in which it is FIXED, if any."""
    count = len(track.mode)
    edges = [0, *(round(t * rate) for move in moves for t in (move.lift, move.land)), count]
    return [
        _stance_frames(track, min(first, count - 1), max(last, min(first, count - 1) + 1))
        for first, last in zip(edges[::2], edges[1::2], strict=True)
    ]


def _stance_frames(track: FootTrack, first: int, last: int) -> NDArray[np.int_]:
    frames = np.arange(first, last)
    fixed = frames[track.mode[frames] == FIXED]
    return fixed if len(fixed) else frames


def _median_foothold(track: FootTrack, frames: NDArray[np.int_]) -> Foothold:
    """The median foothold over some frames."""
    x, y = np.median(track.place[frames], axis=0)
    return Foothold(float(x), float(y), float(np.median(track.heading[frames])))


def _worthwhile_moves(track: FootTrack, shortest: int, leg: float) -> list[tuple[int, int]]:
    """First and last frame of each move of a foot that makes a step (see the MIN_STEP constants)."""
    moving = track.mode != FIXED
    candidates = [list(run) for run in _runs(moving)]
    joined: list[list[int]] = []
    for run in candidates:
        if joined and run[0] - joined[-1][1] < shortest:
            joined[-1][1] = run[1]
        else:
            joined.append(run)
    moves: list[tuple[int, int]] = []
    stood = 0
    for k, (first, last) in enumerate(joined):
        until = joined[k + 1][0] if k + 1 < len(joined) else len(moving)
        before, after = (
            _median_foothold(track, _stance_frames(track, *span))
            for span in ((stood, first), (last, max(until, last + 1)))
        )
        free = bool((track.mode[first:last] == FREE).any())
        moved = float(np.hypot(after.x - before.x, after.y - before.y))
        worth = moved > MIN_STEP_LENGTH[0 if free else 1] * leg or abs(after.heading - before.heading) > MIN_STEP_TURN
        if worth or track.lift[first:last].max() > MIN_STEP_HEIGHT * leg:
            moves.append((first, last))
            stood = last
    return moves


def _runs(flags: Flags) -> list[tuple[int, int]]:
    """Start and end (exclusive) of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _hysteresis(on: Flags, stay: Flags) -> Flags:
    """Flags (T,) that become True where `on` is True, and stay so as long as `stay` is True."""
    state, result = True, np.empty_like(on)
    for k in range(len(on)):
        state = bool(on[k] or (state and stay[k]))
        result[k] = state
    return result


def _interpolated(angle: Array, known: Flags) -> Array:
    """Angles (T,), interpolated linearly where they are not `known`."""
    if not known.any():
        return np.zeros_like(angle)
    times = np.arange(len(angle))
    return np.interp(times, times[known], angle[known])
