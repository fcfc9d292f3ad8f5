"""Where a human does not stand on its feet: it lies, or sits. The robot stands, and says so."""

from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

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
TRUNK_CENTRE = 0.55  # of the way from waist to neck


def standing(human: Human) -> Human:
    """The human turned upright where it lies or is upside down, with a remark for each stretch of that or of sitting.

    Who sits stays as it is: its hips are as low as they are, and the robot's as low as it can have them.
    """
    shortest = MIN_POSTURE_DURATION * human.leg_time
    lying, inverted, sitting = (_lasting(flags, shortest * human.rate) for flags in _postures(human))
    remarks = [
        Remark(
            human.start + first / human.rate,
            human.start + (last - 1) / human.rate,
            f"The dancer {verb} from {human.start + first / human.rate:.2f} to"
            f" {human.start + (last - 1) / human.rate:.2f} s; the robot {instead}.",
            on_feet=False,
        )
        for found, verb, instead in (
            (lying, "lies", "stands, as if the dancer had been turned upright"),
            (inverted, "is upside down", "stands, as if the dancer had been turned upright"),
            (sitting, "sits", "stands, its knees bent as far as that allows"),
        )
        for first, last in found
    ]
    if not remarks:
        return human
    upright = _turned_upright(human, [*lying, *inverted]) if lying or inverted else human
    return replace(upright, remarks=(*human.remarks, *sorted(remarks, key=lambda remark: remark.start)))


def _postures(human: Human) -> tuple[Flags, Flags, Flags]:
    """The frames (T,) in which a human lies, in which it is upside down, and in which it sits."""
    points, leg = human.points, human.leg
    trunk = points["neck"] - points["waist"]
    tilt = np.arctan2(np.linalg.norm(trunk[:, :2], axis=1), trunk[:, 2])
    height = points["waist"][:, 2] / leg
    lies: Flags = (tilt > MIN_RECLINED_TILT) & (height < LYING_HEIGHT)
    inverted: Flags = (tilt > MIN_UPSIDE_DOWN_TILT) & ~lies
    thighs = [points[f"{side}_hip"] - points[f"{side}_knee"] for side in SIDES]
    level = np.all([np.arctan2(np.linalg.norm(t[:, :2], axis=1), t[:, 2]) > MIN_RECLINED_TILT for t in thighs], axis=0)
    carried = (height < FLOOR_SITTING_HEIGHT) | (_beside_feet(human) > MIN_UNSUPPORTED_DISTANCE * leg)
    sits: Flags = (tilt <= MIN_RECLINED_TILT) & level & (height < SITTING_HEIGHT) & carried
    return lies, inverted, sits


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


def _turned_upright(human: Human, lying: list[tuple[int, int]]) -> Human:
    """The human turned about its waist so that its trunk is upright, its lower foot on the floor, while it lies."""
    rising = max(1.0, RISE_DURATION * human.leg_time * human.rate)
    frames, share = np.arange(human.count), np.zeros(human.count)
    for first, last in lying:
        outside = np.maximum(first - frames, frames - (last - 1)).clip(min=0)
        share = np.maximum(share, minimum_jerk(1.0 - outside / rising))
    waist = human.points["waist"]
    trunk = human.points["neck"] - waist
    axis = np.column_stack([trunk[:, 1], -trunk[:, 0], np.zeros(human.count)])
    size = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(size, trunk[:, 2])
    turn = Rotation.from_rotvec((share * angle / np.maximum(size, 1e-9))[:, None] * axis).as_matrix()
    points = {name: waist + np.einsum("tij,tj->ti", turn, place - waist) for name, place in human.points.items()}
    lowest = np.min([points[f"{side}_{joint}"][:, 2] for side in SIDES for joint in ("ankle", "toe")], axis=0)
    if 0.5 * human.rate > FOLLOWING_HZ:
        lowest = low_passed(lowest, human.rate, FOLLOWING_HZ)
    lift = np.column_stack([np.zeros((human.count, 2)), -share * lowest])
    return replace(
        human,
        points={name: place + lift for name, place in points.items()},
        frames={body: turn @ rotation for body, rotation in human.frames.items()},
    )
