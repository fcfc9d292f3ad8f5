"""Faults of a tracker, found and mended: frames that jump, and a floor that drifts or slopes."""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import interp1d
from scipy.spatial.transform import Rotation, Slerp

from sot.gravity import GRAVITY
from sot.motion.human.human import SIDES, Human, Remark

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

JUMP_FROUDE = 3.0  # speed over √(g leg) that no joint reaches for a single frame, at rest before and after
JUMP_CONTRAST = 4.0  # between the speed of a jump and those of the frames around it
RETURN_TIME = 0.7  # times √(leg / g): a tracker that is back within it was away
RETURN_SHARE = 0.5  # of its jump, that a joint may be off when it is back
PLANTED_SPEED = 0.15  # leg lengths/s, along the floor, of a foot that stands on it
NOISE_HZ = 6.0  # faster than this, a capture is noise
DRIFT_WINDOW = 2.0  # s, over which a drifting floor is taken for an even slope
DRIFT_KNOTS = 4  # in a window
MIN_DRIFT = 0.1  # leg lengths: what drifts less is left alone
MAX_DRIFT_SCATTER = 0.05  # leg lengths, of most standing feet about the floor that they stand on
MIN_SLOPE_SPREAD, MAX_SLOPE = 0.4, 0.25  # leg lengths, of places where feet stand about their mean; of a ramp
MAX_SLOPE_SCATTER = 0.15  # of the height of a slope, of most standing feet about it: stairs are steps, not a plane
MIN_DRIFT_SHARE = 0.6  # of the floor's slope, that feet which stand on it have to share: on stairs they do not


def without_jumps(human: Human) -> Human:
    """The human with the frames bridged in which its tracker was away, and a remark for each such place.

    A joint jumps if it moves faster than a joint can for one frame alone. Frames between a jump away and a jump back
    are interpolated; a jump of the whole body that nothing takes back stays, and has its remark.
    """
    rate = human.rate
    points = np.stack(list(human.points.values()), axis=1)
    moves = np.linalg.norm(np.diff(points, axis=0), axis=2)
    fast = moves > JUMP_FROUDE * GRAVITY * human.leg_time / rate
    if not fast.any():
        return human
    longest = max(1, round(RETURN_TIME * human.leg_time * rate))
    away = np.zeros(human.count, dtype=bool)
    cuts: list[int] = []
    for joint, name in enumerate(human.points):
        for first, back in _jumps(points[:, joint], moves[:, joint], fast[:, joint], longest):
            if back is not None:
                away[first + 1 : back + 1] = True
            elif name == "waist":
                cuts.append(first)
    remarks = [
        Remark(
            human.start + first / rate,
            human.start + end / rate,
            f"The tracker jumps by {moves[first - 1].max():.2f} m at {human.start + first / rate:.2f} s and is back"
            f" after {(end - first) / rate:.2f} s: the recording is bridged there.",
        )
        for first, end in _runs(away)
    ]
    for first in cuts:
        when = human.start + (first + 1) / rate
        size = moves[first].max()
        remarks.append(Remark(when, when, f"The recording jumps by {size:.2f} m at {when:.2f} s: is it cut there?"))
    mended = bridged(human, away) if away.any() else human
    return replace(mended, remarks=(*human.remarks, *remarks)) if remarks else human


def _jumps(points: Array, moves: Array, fast: Flags, longest: int) -> Iterator[tuple[int, int | None]]:
    """Moves, each by the frame before it, with which a joint (T, 3) jumps away and those with which it jumps back.

    None stands for a jump that nothing takes back.
    """
    around = np.concatenate([[0.0], moves, [0.0]])  # around[k + 1] is moves[k]
    waiting = np.flatnonzero(fast).tolist()
    while waiting:
        first = waiting.pop(0)
        if moves[first] < JUMP_CONTRAST * around[first]:
            continue
        for back in [other for other in waiting if other - first <= longest]:
            size = min(moves[first], moves[back])
            inside = moves[first + 1 : back].max(initial=0.0)
            off = float(np.linalg.norm(points[back + 1] - points[first]))
            if off < RETURN_SHARE * size and size > JUMP_CONTRAST * max(inside, around[first], around[back + 2]):
                waiting = [other for other in waiting if other > back]
                yield first, back
                break
        else:
            if moves[first] > JUMP_CONTRAST * around[first + 2]:
                yield first, None


def bridged(human: Human, away: Flags) -> Human:
    """The human with the flagged frames interpolated from those beside them, or held at an end of the clip."""
    kept = np.flatnonzero(~away)
    times = np.clip(np.arange(human.count), kept[0], kept[-1])

    def between(values: Array) -> Array:
        result: Array = interp1d(kept, values[kept], axis=0)(times)
        return result

    return replace(
        human,
        points={name: np.where(away[:, None], between(place), place) for name, place in human.points.items()},
        frames={
            body: np.where(
                away[:, None, None],
                Slerp(kept, Rotation.from_matrix(rotation[kept]))(times).as_matrix(),
                rotation,
            )
            for body, rotation in human.frames.items()
        },
    )


def on_level_floor(human: Human) -> Human:
    """The human above a level floor, with a remark, where its tracker's drifts up or down, or where it slopes.

    A floor drifts if the feet that stand on it, still along the floor, rise or fall together with it all the time: on
    stairs and ramps a foot stays at its height while it stands. It slopes if the places at which they stand lie in a
    plane that does.
    """
    end = human.start + human.duration
    drift = _floor_drift(human)
    if drift is not None:
        rise = float(drift[-1] - drift[0]) if abs(drift[-1] - drift[0]) > 0.5 * np.ptp(drift) else 0.0
        way = f"{'up ' if rise > 0.0 else 'down ' if rise else ''}by {100 * (abs(rise) or np.ptp(drift)):.0f} cm"
        words = (
            f"The recorded floor drifts {way} from {human.start:.2f} to {end:.2f} s; the robot dances on a level one."
        )
        return _lowered(human, drift, Remark(human.start, end, words))
    plane = _floor_slope(human)
    return human if plane is None else _over_slope(human, plane)


def _lowered(human: Human, height: Array, remark: Remark) -> Human:
    level = np.column_stack([np.zeros((human.count, 2)), height])
    return replace(
        human,
        points={name: place - level for name, place in human.points.items()},
        remarks=(*human.remarks, remark),
    )


class _Plane(NamedTuple):
    """A sloping floor: its gradient (2,), and a place (2,) at which its height counts as zero [m]."""

    gradient: Array
    origin: Array

    def height(self, places: Array) -> Array:
        """Its height (T,) at places (T, 2 or more) [m]."""
        found: Array = (places[:, :2] - self.origin) @ self.gradient
        return found


def _over_slope(human: Human, plane: _Plane) -> Human:
    """The human over a level floor instead of a sloping one, each foot lowered by as much as is under it.

    `ground` keeps these heights.
    """
    under = {name: plane.height(place) for name, place in human.points.items() if name.endswith(("ankle", "toe"))}
    end = human.start + human.duration
    way = float(np.ptp(0.5 * (under["left_ankle"] + under["right_ankle"])))
    words = (
        f"The recorded floor slopes by {100 * np.linalg.norm(plane.gradient):.0f} %, {way:.2f} m over the way from"
        f" {human.start:.2f} to {end:.2f} s; the robot dances on a level one."
    )
    remark = Remark(human.start, end, words, climbed=way)
    return replace(human.lowered(under), remarks=(*human.remarks, remark))


def _floor_slope(human: Human) -> _Plane | None:
    """The sloping floor that a human is on; None if it is level."""
    leg, rate = human.leg, human.rate
    smooth = human.low_passed(NOISE_HZ)
    stands, places = [], []
    for side in SIDES:
        toe = smooth.points[f"{side}_toe"]
        speed = np.linalg.norm(np.gradient(toe, axis=0), axis=1) * rate
        stands.append(speed < PLANTED_SPEED * leg)
        places.append(toe)
    ground = np.concatenate([place[still] for place, still in zip(places, stands, strict=True)])
    if len(ground) < 0.25 * human.count:
        return None
    middle = ground.mean(axis=0)
    columns = ground[:, :2] - middle[:2]
    spreads, ways = np.linalg.eigh(columns.T @ columns / len(columns))
    ways = ways[:, spreads > (MIN_SLOPE_SPREAD * leg) ** 2]  # where feet were hardly apart, they tell no slope
    if not ways.size:
        return None
    trust = np.ones(len(ground))
    for _ in range(3):  # feet that are held in the air do not count
        gradient = ways @ np.linalg.lstsq(trust[:, None] * (columns @ ways), trust * (ground[:, 2] - middle[2]))[0]
        off = np.abs(ground[:, 2] - middle[2] - columns @ gradient)
        trust = np.clip(1.0 - (off / (6.0 * max(float(np.median(off)), 1e-4))) ** 2, 0.0, None)
    slope = float(np.linalg.norm(gradient))
    along = columns @ gradient
    scatter = float(np.percentile(off, 80.0))
    spread = np.ptp(np.percentile(along, [2.0, 98.0]))
    if (
        spread < MIN_DRIFT * leg
        or slope > MAX_SLOPE
        or scatter > min(MAX_DRIFT_SCATTER * leg, MAX_SLOPE_SCATTER * spread)
    ):
        return None
    return _Plane(gradient, middle[:2])


def _floor_drift(human: Human) -> Array | None:
    """Height (T,) of a drifting floor [m]; None if it does not drift, or by too little to matter."""
    leg, rate, smooth = human.leg, human.rate, human.low_passed(NOISE_HZ)
    heights = np.full((len(SIDES), human.count), np.inf)
    rises = np.zeros_like(heights)
    for k, side in enumerate(SIDES):
        velocity = {joint: np.gradient(smooth.points[f"{side}_{joint}"], axis=0) * rate for joint in ("ankle", "toe")}
        along = np.max([np.linalg.norm(v[:, :2], axis=1) for v in velocity.values()], axis=0)
        toe = smooth.points[f"{side}_toe"][:, 2]
        heights[k], rises[k] = np.where(along < PLANTED_SPEED * leg, toe, np.inf), velocity["toe"][:, 2]
    lower, frames = heights.argmin(axis=0), np.arange(human.count)
    height, rise = heights[lower, frames], rises[lower, frames]
    stands = np.isfinite(height)
    if np.count_nonzero(stands) < 0.25 * human.count or np.ptp(height[stands]) < MIN_DRIFT * leg:
        return None
    drift = _local_lines(human.times, stands, height)
    scatter = float(np.percentile(np.abs(height - drift)[stands], 80.0))
    slope = np.gradient(drift) * rate
    shared = float(np.sum((rise * slope)[stands]) / max(np.sum(slope[stands] ** 2), 1e-12))
    if np.ptp(drift) < MIN_DRIFT * leg or scatter > MAX_DRIFT_SCATTER * leg or shared < MIN_DRIFT_SHARE:
        return None
    return drift


def _local_lines(times: Array, known: Flags, values: Array) -> Array:
    """A curve (T,) through known values (T,), locally a line: weighted over a window, twice, outliers less (Cleveland).

    Values of frames that are not known do not matter.
    """
    knots = np.linspace(times[0], times[-1], max(2, round(DRIFT_KNOTS * (times[-1] - times[0]) / DRIFT_WINDOW) + 1))
    t, y = times[known], values[known]
    trust = np.ones(len(t))
    curve = np.zeros(len(times))
    for _ in range(3):
        at_knots = []
        for knot in knots:
            near = np.abs(t - knot) / (max(0.5 * DRIFT_WINDOW, 2.0 * float(np.abs(t - knot).min())))
            weight = trust * np.clip(1.0 - near**3, 1e-9, None) ** 3
            x = t - knot
            total, first, second = weight.sum(), weight @ x, weight @ x**2
            spread = total * second - first**2
            mean = weight @ y / total
            at_knots.append(
                (second * (weight @ y) - first * (weight @ (x * y))) / spread if spread > 1e-9 * total**2 else mean
            )
        curve = np.interp(times, knots, at_knots)
        off = np.abs(y - curve[known])
        trust = np.clip(1.0 - (off / (6.0 * max(float(np.median(off)), 1e-6))) ** 2, 0.0, None) ** 2 + 1e-9
    return curve


def _runs(flags: Flags) -> list[tuple[int, int]]:
    """Start and end (exclusive) of the runs of True."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
