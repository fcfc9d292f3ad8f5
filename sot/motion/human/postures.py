"""Where a human does not stand on its feet: it lies, sits, crawls or climbs. The robot stands, and says so."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.gravity import GRAVITY
from sot.motion.human.carried import (
    OffFloor,
    hands_down,
    kneeling,
    leg_stood_on,
    over_level_ground,
    stretches_off_floor,
)
from sot.motion.human.human import SIDES, Human, Remark
from sot.smooth import low_passed, minimum_jerk

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

MIN_RECLINED_TILT = np.radians(60.0)  # tilt of a trunk that lies, and of the thighs of who sits
MIN_UPSIDE_DOWN_TILT = np.radians(120.0)  # tilt of a trunk on its head or hands
LYING_HEIGHT = 0.35  # leg lengths above the floor: the waist of who lies is below
SITTING_HEIGHT = 0.75  # the same of who sits, on a chair
FLOOR_SITTING_HEIGHT = 0.3  # the same of who sits on the floor
MIN_UNSUPPORTED_DISTANCE = 0.2  # leg lengths, from the feet to the centre of mass: beyond, something else carries it
MIN_POSTURE_DURATION = 3.0  # times √(leg / g): what lasts less is a move, not a posture
RISE_DURATION = 2.0  # times √(leg / g), in which the robot's human is turned upright before and after
FOLLOWING_HZ = 1.0  # how fast the height follows the lower foot of who is turned upright
TRUNK_SHARE, THIGHS_SHARE = 0.68, 0.2  # of a human's mass, head and arms included; the rest is in shanks and feet
LEG_POINTS = ("hip", "knee", "ankle", "toe")
TRUNK_CENTRE = 0.55  # of the way from waist to neck


def standing(human: Human) -> Human:
    """The human on its feet on the floor, with a remark for each stretch in which it is not.

    Who lies, leans on both hands or is upside down is turned upright, of who crawls the trunk is, of who hangs from its
    hips halfway, who climbs is put over level ground, and who floats on the floor. Who sits, kneels or puts a hand
    down stays as it is: its hips are as low as they are, and the robot's as low as it can have them.
    """
    shortest = MIN_POSTURE_DURATION * human.leg_time * human.rate
    lies, inverted, crawls, folds, sits = _postures(human)
    hand, _ = hands_down(human)
    low = lies | sits | crawls
    as_upright, bent = (
        "stands, as if the dancer had been turned upright",
        "stands, its knees bent as far as that allows",
    )
    remarks, stretches = [], dict[str, list[tuple[int, int]]]()
    for flags, verb, instead, on_feet in (
        (lies, "lies", as_upright, False),
        (inverted & ~crawls, "is upside down", as_upright, False),
        (crawls, "crawls", "stands, its trunk upright", False),
        (folds, "hangs its head below its hips", "bows as far as its balance allows", True),
        (sits, "sits", bent, False),
        (kneeling(human) & ~low, "kneels", bent, False),
        (hand & ~low & ~inverted & ~folds, "has a hand on the floor", "stands, its hands above it", True),
    ):
        stretches[verb] = _lasting(flags, shortest)
        remarks += [
            _remark(human, first, end, f"The dancer {verb}", instead, on_feet) for first, end in stretches[verb]
        ]
    carried = [
        one
        for one in stretches_off_floor(human)
        if not any(first < one.end and one.first < end for found in stretches.values() for first, end in found)
    ]
    remarks += [_off_floor_remark(human, one) for one in carried]
    if side := leg_stood_on(human):
        remarks.append(
            _remark(human, 0, human.count, f"The dancer stands on the {side} leg", "does where it steps", True)
        )
    if not remarks:
        return human
    if climbs := [one for one in carried if one.stands]:
        human = over_level_ground(human, climbs)
    upper = tuple(name for name in human.points if not name.endswith(LEG_POINTS))
    for found, turned, tilt in (
        ([(one.first, one.end) for one in carried if not one.stands], (), 0.0),
        ([*stretches["lies"], *stretches["is upside down"]], tuple(human.points), 0.0),
        (stretches["crawls"], upper, 0.0),
        (stretches["hangs its head below its hips"], upper, MIN_RECLINED_TILT),
    ):
        human = _on_floor(human, found, turned, tilt) if found else human
    return replace(human, remarks=(*human.remarks, *sorted(remarks, key=lambda remark: remark.start)))


def _remark(human: Human, first: int, end: int, what: str, instead: str, on_feet: bool) -> Remark:
    start, until = human.start + first / human.rate, human.start + (end - 1) / human.rate
    return Remark(start, until, f"{what} from {start:.2f} to {until:.2f} s; the robot {instead}.", on_feet)


def _off_floor_remark(human: Human, one: OffFloor) -> Remark:
    if one.stands:
        what = f"The dancer stands up to {one.height:.2f} m above the floor, as who climbs does,"
        told = _remark(human, one.first, one.end, what, "steps on the floor", False)
        return replace(told, climbed=one.height)
    needed = GRAVITY * ((one.end - one.first) / human.rate) ** 2 / 8.0
    what = (
        f"Both feet are off the floor, and the body rises by {max(one.rise, 0.0):.2f} m where a leap as long takes"
        f" {needed:.2f} m,"
    )
    return _remark(human, one.first, one.end, what, "stays on the floor", False)


def _postures(human: Human) -> tuple[Flags, Flags, Flags, Flags, Flags]:
    """The frames (T,) in which a human lies or leans on its hands, is upside down, is on hands and knees, hangs from
    its hips, and sits."""
    points, leg = human.points, human.leg
    trunk = points["neck"] - points["waist"]
    tilt = np.arctan2(np.linalg.norm(trunk[:, :2], axis=1), trunk[:, 2])
    height = points["waist"][:, 2] / leg
    reclines = tilt > MIN_RECLINED_TILT
    legs = points["waist"] - np.mean([points[f"{side}_ankle"] for side in SIDES], axis=0)
    leg_tilt = np.arctan2(np.linalg.norm(legs[:, :2], axis=1), legs[:, 2])
    both_hands = hands_down(human)[1]
    lies: Flags = reclines & (
        (height < LYING_HEIGHT) | (both_hands & (leg_tilt > MIN_RECLINED_TILT) & (legs[:, 2] > 0.0))
    )
    inverted: Flags = (tilt > MIN_UPSIDE_DOWN_TILT) & (legs[:, 2] < 0.0) & ~lies
    crawls: Flags = reclines & both_hands & kneeling(human) & ~lies & ~inverted
    folds: Flags = (tilt > MIN_UPSIDE_DOWN_TILT) & ~lies & ~inverted & ~crawls
    thighs = [points[f"{side}_hip"] - points[f"{side}_knee"] for side in SIDES]
    level = np.all([np.arctan2(np.linalg.norm(t[:, :2], axis=1), t[:, 2]) > MIN_RECLINED_TILT for t in thighs], axis=0)
    carried = (height < FLOOR_SITTING_HEIGHT) | (_beside_feet(human) > MIN_UNSUPPORTED_DISTANCE * leg)
    sits: Flags = (tilt <= MIN_RECLINED_TILT) & level & (height < SITTING_HEIGHT) & carried
    return lies, inverted, crawls, folds, sits


def _beside_feet(human: Human) -> Array:
    """Distance (T,) along the floor from the centre of mass to the convex hull of ankles and toes [m]."""
    points = human.points
    trunk = points["waist"] + TRUNK_CENTRE * (points["neck"] - points["waist"])
    thighs = np.mean([points[f"{side}_{joint}"] for side in SIDES for joint in ("hip", "knee")], axis=0)
    shanks = np.mean([points[f"{side}_{joint}"] for side in SIDES for joint in ("knee", "ankle")], axis=0)
    centre = TRUNK_SHARE * trunk + THIGHS_SHARE * thighs + (1.0 - TRUNK_SHARE - THIGHS_SHARE) * shanks
    corners = [points[f"{side}_{joint}"][:, :2] - centre[:, :2] for side in SIDES for joint in ("ankle", "toe")]
    inside = np.any([_around_origin(*three) for three in combinations(corners, 3)], axis=0)
    distance = np.min([_from_origin(one, other) for one, other in combinations(corners, 2)], axis=0)
    return np.where(inside, 0.0, distance)


def _around_origin(a: Array, b: Array, c: Array) -> Flags:
    """Whether triangles of corners (T, 2) hold the origin."""
    sides: Array = np.stack([p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((a, b), (b, c), (c, a))])
    inside: Flags = np.all(sides > 0.0, axis=0) | np.all(sides < 0.0, axis=0)
    return inside


def _from_origin(a: Array, b: Array) -> Array:
    """Distance (T,) of line segments between points (T, 2) from the origin."""
    along = b - a
    share = -np.sum(a * along, axis=1) / np.maximum(np.sum(along**2, axis=1), 1e-12)
    distance: Array = np.linalg.norm(a + np.clip(share, 0.0, 1.0)[:, None] * along, axis=1)
    return distance


def _lasting(flags: Flags, shortest: float) -> list[tuple[int, int]]:
    """Start and end (exclusive) of the runs of True of some frames, shorter gaps between them bridged; or of all."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    runs: list[list[int]] = []
    for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if runs and first - runs[-1][1] < shortest:
            runs[-1][1] = last
        else:
            runs.append([first, last])
    return [(first, last) for first, last in runs if last - first >= min(shortest, len(flags))]


def _on_floor(human: Human, stretches: list[tuple[int, int]], turned: Sequence[str], tilt: float) -> Human:
    """The human with its lower foot on the floor in some stretches, and the points that are named, with all bodies,
    turned about its waist until the trunk is upright, or has no more than a tilt [rad]."""
    rising = max(1.0, RISE_DURATION * human.leg_time * human.rate)
    frames, share = np.arange(human.count), np.zeros(human.count)
    for first, last in stretches:
        outside = np.maximum(first - frames, frames - (last - 1)).clip(min=0)
        share = np.maximum(share, minimum_jerk(1.0 - outside / rising))
    waist = human.points["waist"]
    trunk = human.points["neck"] - waist
    axis = np.column_stack([trunk[:, 1], -trunk[:, 0], np.zeros(human.count)])
    size = np.linalg.norm(axis, axis=1)
    angle = np.maximum(np.arctan2(size, trunk[:, 2]) - tilt, 0.0) if turned else np.zeros(human.count)
    turn = Rotation.from_rotvec((share * angle / np.maximum(size, 1e-9))[:, None] * axis).as_matrix()
    points = dict(human.points)
    points |= {name: waist + np.einsum("tij,tj->ti", turn, points[name] - waist) for name in turned}
    lowest = np.min([points[f"{side}_{joint}"][:, 2] for side in SIDES for joint in ("ankle", "toe")], axis=0)
    if 0.5 * human.rate > FOLLOWING_HZ:
        lowest = low_passed(lowest, human.rate, FOLLOWING_HZ)
    lift = np.column_stack([np.zeros((human.count, 2)), -share * lowest])
    return replace(
        human,
        points={name: place + lift for name, place in points.items()},
        frames={body: turn @ rotation for body, rotation in human.frames.items()},
    )
