"""What a dancer's feet do: when each is fixed, slides or is free, and which of its moves are worth a step.

Heights and speeds count in leg lengths of the dancer, heights from where each foot usually stands, so that neither a
dancer's size nor a floor a little off matters.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.stance import LEAD, TAIL
from sot.motion.human.human import Human

Array = NDArray[np.float64]
Modes = NDArray[np.int8]
Flags = NDArray[np.bool_]

FREE, SLIDING, FIXED = 0, 1, 2
NEAR, FAR = 0.03, 0.06  # leg lengths above its standing height: lower, a foot may touch; higher, it does not
SLOW, FAST = 0.35, 0.6  # leg lengths/s: slower, a low foot touches; faster, it does not
CREEP = 0.15  # leg lengths/s, a touching foot that moves faster slides
PIVOT = 1.2  # rad/s, a touching foot that turns faster slides
STANDING = 20.0  # percentile, of the height of a slow foot, taken for standing
POINTED = 0.5  # of its length on the floor: a foot seen shorter has no heading to speak of
ASIDE = 1.6  # rad, from the pelvis' heading: beyond, a foot's is not to be believed
WORTH = 0.07, 0.13  # leg lengths, a shorter move of a free or a sliding foot is not worth a step
TURN = 0.3  # rad, a turn that is worth a step
LIFT = 0.12  # leg lengths, a height that is worth a step on the spot
AIRBORNE = 0.4  # s, in the lead-in and the tail, for a foot that a clip starts or ends with in the air
LANDED = 0.08  # s, a shorter touch between two moves is none


@dataclass(frozen=True)
class Ground:
    """Where a dancer's foot is on the floor: `place` (T, 2), under the ankle were the sole flat [m]; `heading` (T,),
    unwrapped [rad]; `lift` (T,), of its lowest point above standing [m]; `mode` (T,), FREE, SLIDING or FIXED."""

    place: Array
    heading: Array
    lift: Array
    mode: Modes


@dataclass(frozen=True)
class Stand:
    """A foot on the floor: x, y of the point below its ankle [m], and heading, unwrapped [rad]."""

    x: float
    y: float
    heading: float


@dataclass(frozen=True)
class Step:
    """A foot that leaves the floor at `lift` and is back at `land` [s]; both feet stand before the first step."""

    foot: str
    lift: float
    land: float


def ground(human: Human, side: str) -> Ground:
    """A foot of a human on the motion's time line; it stands through most of the lead-in and at the end of the tail."""
    ankle, toe = human.points[f"{side}_ankle"], human.points[f"{side}_toe"]
    leg, dt = human.leg, 1.0 / human.rate
    heights, speeds = [], []
    for point in (ankle, toe):
        speed = np.linalg.norm(np.gradient(point, dt, axis=0), axis=1)
        slow = speed <= max(SLOW * leg, float(np.percentile(speed, STANDING)))
        heights.append(point[:, 2] - np.percentile(point[slow, 2], STANDING))
        speeds.append(speed)
    height, speed = np.array(heights), np.array(speeds)

    along = (toe - ankle)[:, :2]
    reach = np.linalg.norm(along, axis=1)
    low = height.max(axis=0) < NEAR * leg
    flat = float(np.median(reach[low] if low.any() else reach))
    pelvis = np.unwrap(np.arctan2(human.frames["pelvis"][:, 1, 0], human.frames["pelvis"][:, 0, 0]))
    aside = np.angle(np.exp(1j * (np.arctan2(along[:, 1], along[:, 0]) - pelvis)))
    heading = pelvis + _held(aside, (reach > POINTED * flat) & (np.abs(aside) < ASIDE))
    place = toe[:, :2] - flat * np.column_stack([np.cos(heading), np.sin(heading)])

    touching = _hysteresis(
        np.any((height < NEAR * leg) & (speed < SLOW * leg), axis=0),
        np.any((height < FAR * leg) & (speed < FAST * leg), axis=0),
    )
    still = np.where(height < FAR * leg, speed, np.inf).min(axis=0) < CREEP * leg
    still &= np.abs(np.gradient(heading, dt)) < PIVOT
    mode = np.where(touching, np.where(still, FIXED, SLIDING), FREE).astype(np.int8)
    mode[: round((LEAD - AIRBORNE) * human.rate)] = FIXED
    mode[len(mode) - round((TAIL - AIRBORNE) * human.rate) :] = FIXED
    return Ground(place, heading, np.maximum(height.min(axis=0), 0.0), mode)


def steps(feet: Mapping[str, Ground], rate: float, leg: float) -> tuple[Step, ...]:
    """The moves of both feet that are worth a step, in order of their middles; moves of two feet may still overlap.

    A foot that ends up near where it stood, without having been lifted much, keeps standing there: what it drifts adds
    up until it is worth a step. Before the first and after the last frame both feet stand.
    """
    found = [
        Step(foot, first / rate, last / rate)
        for foot, track in feet.items()
        for first, last in _moves(track, round(LANDED * rate), leg)
    ]
    return tuple(sorted(found, key=lambda step: step.lift + step.land))


def stands(feet: Mapping[str, Ground], moves: Sequence[Step], rate: float) -> dict[str, list[Stand]]:
    """Where the dancer's feet stand before, between and after their steps."""
    return {
        foot: [_stand(track, frames) for frames in standing(track, [move for move in moves if move.foot == foot], rate)]
        for foot, track in feet.items()
    }


def standing(track: Ground, moves: Sequence[Step], rate: float) -> list[NDArray[np.int_]]:
    """The frames that count for where a foot stands before, between and after its moves: fixed ones where there are."""
    count = len(track.mode)
    edges = [0, *(round(t * rate) for move in moves for t in (move.lift, move.land)), count]
    return [
        _counting(track, min(first, count - 1), max(last, min(first, count - 1) + 1))
        for first, last in zip(edges[::2], edges[1::2], strict=True)
    ]


def _counting(track: Ground, first: int, last: int) -> NDArray[np.int_]:
    frames = np.arange(first, last)
    fixed = frames[track.mode[frames] == FIXED]
    return fixed if len(fixed) else frames


def _stand(track: Ground, frames: NDArray[np.int_]) -> Stand:
    """Median over frames."""
    x, y = np.median(track.place[frames], axis=0)
    return Stand(float(x), float(y), float(np.median(track.heading[frames])))


def _moves(track: Ground, shortest: int, leg: float) -> list[tuple[int, int]]:
    """First and last frame of the moves of a foot that are worth a step."""
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
            _stand(track, _counting(track, *span)) for span in ((stood, first), (last, max(until, last + 1)))
        )
        free = bool((track.mode[first:last] == FREE).any())
        moved = float(np.hypot(after.x - before.x, after.y - before.y))
        worth = moved > WORTH[0 if free else 1] * leg or abs(after.heading - before.heading) > TURN
        if worth or track.lift[first:last].max() > LIFT * leg:
            moves.append((first, last))
            stood = last
    return moves


def _runs(flags: Flags) -> list[tuple[int, int]]:
    """Start and end (exclusive) of the runs of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _hysteresis(on: Flags, stay: Flags) -> Flags:
    """True from where `on` is until `stay` is not any more."""
    state, result = True, np.empty_like(on)
    for k in range(len(on)):
        state = bool(on[k] or (state and stay[k]))
        result[k] = state
    return result


def _held(angle: Array, known: Flags) -> Array:
    """Angles (T,), linear through the times at which they are not known."""
    if not known.any():
        return np.zeros_like(angle)
    times = np.arange(len(angle))
    return np.interp(times, times[known], angle[known])
