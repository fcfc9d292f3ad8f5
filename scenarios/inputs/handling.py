"""Demonstrations of our own in which a human handles things: a box lifted and set down, a door pushed open.

`python -m scenarios.inputs.handling FOLDER` writes them: of each the clip (.bvh), the objects (.objects.toml) and the
contact events (.events.toml). They are synthetic: smooth functions of time and inverse kinematics, recorded of nobody.
Here X is forward, Y left, Z up, and each track is a list of times with values, at rest at each of them.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from scenarios.inputs.synthetic_human import (
    ANKLE_FROM_MIDDLE_M,
    ANKLE_HEIGHT_M,
    SHANK_M,
    SIDES,
    THIGH_M,
    arm_angles,
    bvh_text,
    leg_angles,
)
from sot.motion.objects import event_file
from sot.motion.objects.demonstration import HandledObjects, LevelSurface, ObjectPath, write_objects
from sot.motion.objects.events import ContactEvent, ContactPlan, SurfaceName, SurfacePair
from sot.smooth import minimum_jerk
from sot.whole_file import atomic_write

Array = NDArray[np.float64]
Track = Sequence[tuple[float, Sequence[float] | Array]]

RATE_HZ = 30.0  # Hz
STANDING_HIPS_M = ANKLE_HEIGHT_M + THIGH_M + SHANK_M - 0.02  # m, of the hips' height
PELVIS_SHARE_OF_BOW = 0.4  # the rest bends the spine
HANGING_PALM_M = (0.06, 0.24, 0.83)  # m, of the left one
BESIDE_M = 0.16  # m, between a palm and the object before it touches and after it lets go
BOX_M = (0.28, 0.48, 0.28)  # m
STAND_M, TABLE_M, PLATE_M = 0.85, 0.99, 0.03  # m, heights
BOX_AHEAD_M, TABLE_AHEAD_M = 0.54, 0.83  # m, of the box before and after
GRIP_ABOVE_MIDDLE_M = 0.07  # m, of a box on the floor, that the hands need not go as low as its middle
OVER_FOOT_M = 0.14  # m, by which the hips are over the left foot to stand on it alone, and the box with them
DOOR_M = (0.04, 0.90, 2.00)  # m
HINGE_M = (0.46, 0.50)  # m, forward and left
PUSHED_AT_M = (0.67, 1.30)  # m, from the hinge and above the floor
DOOR_ANGLE_DEG = 25.0  # deg

LEFT_FOOT, RIGHT_FOOT = (
    SurfacePair(SurfaceName("robot", f"{side}_foot"), SurfaceName("world", "floor")) for side in ("left", "right")
)


@dataclass(frozen=True)
class Demonstration:
    """A clip as text, its objects, and its contacts."""

    clip: str
    handled: HandledObjects
    contacts: ContactPlan

    def write(self, folder: Path, name: str) -> None:
        """Write its three files."""
        with atomic_write(folder / f"{name}.bvh") as place:
            place.write_text(self.clip, encoding="ascii", newline="\n")
        write_objects(folder / f"{name}.objects.toml", self.handled)
        event_file.write(folder / f"{name}.events.toml", self.contacts)


def box_demonstration(from_plate: bool) -> Demonstration:
    """A box taken from a stand ahead, or from a low plate on the floor, carried over one leg and set on a table."""
    low = PLATE_M if from_plate else STAND_M
    reach = 1.4 if from_plate else 1.0  # s, of going down and of rising
    touch = 1.0 + reach
    lift = touch + 0.5
    up = lift + reach + 0.4
    shifted, off = up + 1.0, up + 1.2
    placed = off + 2.2
    release = placed + 0.5
    home = release + 1.8
    end = home + 1.6
    half = 0.5 * BOX_M[2]
    start, carried = (BOX_AHEAD_M, 0.0, low + half), (BOX_AHEAD_M, 0.0, 1.14)
    there = (TABLE_AHEAD_M, OVER_FOOT_M, TABLE_M + half)
    hips_low, bow = (STANDING_HIPS_M - 0.50, 78.0) if from_plate else (STANDING_HIPS_M - 0.05, 24.0)
    box: Track = [
        (lift, start),
        (up, carried),
        (shifted, (carried[0], OVER_FOOT_M, carried[2])),
        (off, (carried[0], OVER_FOOT_M, carried[2])),
        (placed - 0.5, (*there[:2], there[2] + 0.06)),
        (placed, there),
    ]
    hips = [
        (0.5, (0, 0, STANDING_HIPS_M)),
        (touch - 0.4, (-0.10 if from_plate else -0.03, 0, hips_low)),
        (lift, (-0.10 if from_plate else -0.03, 0, hips_low)),
        (up, (0, 0, STANDING_HIPS_M)),
        (shifted, (0, OVER_FOOT_M, STANDING_HIPS_M)),
        (off + 0.3, (0, OVER_FOOT_M, STANDING_HIPS_M)),
        (placed - 0.6, (0.04, OVER_FOOT_M, STANDING_HIPS_M - 0.05)),
        (release + 0.6, (0.04, OVER_FOOT_M, STANDING_HIPS_M - 0.05)),
        (home, (0, OVER_FOOT_M, STANDING_HIPS_M)),
        (home + 1.0, (0, 0, STANDING_HIPS_M)),
    ]
    bows = [(0.5, 0), (touch - 0.4, bow), (lift, bow), (up, 4), (off, 4), (placed - 0.6, 42), (release + 0.6, 42)]
    bows.append((home, 0))
    foot = [(off, (0, 0)), (off + 0.7, (-0.14, 0.20)), (release + 1.0, (-0.14, 0.20)), (home, (0, 0))]
    held = (touch, release)
    frames = round(end * RATE_HZ) + 1
    times = np.arange(frames) / RATE_HZ
    path = ObjectPath(np.array(BOX_M), _along(times, box), np.tile(np.eye(3), (frames, 1, 1)))
    palms = {
        side: _gripping_palm(times, sign, path, held, GRIP_ABOVE_MIDDLE_M if from_plate else 0.0)
        for side, sign in SIDES.items()
    }
    on_box = [SurfacePair(SurfaceName("robot", f"{side}_hand"), SurfaceName("box", side)) for side in ("left", "right")]
    below, table = (
        SurfacePair(SurfaceName("box", "bottom"), SurfaceName("world", name))
        for name in ("plate" if from_plate else "stand", "table")
    )
    contacts = ContactPlan(
        (LEFT_FOOT, RIGHT_FOOT, below),
        (
            *(ContactEvent(touch, "make", pair) for pair in on_box),
            ContactEvent(lift, "break", below),
            ContactEvent(off, "break", RIGHT_FOOT),
            ContactEvent(placed, "make", table),
            *(ContactEvent(release, "break", pair) for pair in on_box),
            ContactEvent(home, "make", RIGHT_FOOT),
        ),
    )
    surfaces = {
        below.second.surface: LevelSurface(np.array([BOX_AHEAD_M, 0.0, low]), np.array([0.20, 0.28])),
        "table": LevelSurface(np.array([TABLE_AHEAD_M + 0.09, OVER_FOOT_M, TABLE_M]), np.array([0.42, 0.80])),
    }
    clip = _clip(times, hips, [(t, (angle,)) for t, angle in bows], palms, foot)
    return Demonstration(clip, HandledObjects(RATE_HZ, {"box": path}, surfaces), contacts)


def door_demonstration() -> Demonstration:
    """A door ahead, its hinge on the left, pushed open with the right hand and held there."""
    touch, pushed = 2.0, 6.6
    end = pushed + 1.2
    begun = touch + 0.5
    times = np.arange(round(end * RATE_HZ) + 1) / RATE_HZ
    angle = np.radians(_along(times, [(begun, (0.0,)), (pushed, (DOOR_ANGLE_DEG,))])[:, 0])
    turn = Rotation.from_euler("Z", angle[:, None])
    centre = np.array([*HINGE_M, 0.5 * DOOR_M[2]]) + turn.apply([0.0, -0.5 * DOOR_M[1], 0.0])
    path = ObjectPath(np.array(DOOR_M), centre, turn.as_matrix(), hinged=True)
    spot = np.array([*HINGE_M, PUSHED_AT_M[1]]) + turn.apply([-0.5 * DOOR_M[0], -PUSHED_AT_M[0], 0.0])
    before = _along(times, [(0.5, _mirrored(HANGING_PALM_M)), (1.5, spot[0] - [BESIDE_M, 0, 0]), (touch, spot[0])])
    palms = {
        "Left": np.tile(np.array(HANGING_PALM_M), (len(times), 1)),
        "Right": np.where((times < touch)[:, None], before, spot),
    }
    pair = SurfacePair(SurfaceName("robot", "right_hand"), SurfaceName("door", "front"))
    contacts = ContactPlan((LEFT_FOOT, RIGHT_FOOT), (ContactEvent(touch, "make", pair),))
    hips = [
        (0.5, (0, 0, STANDING_HIPS_M)),
        (touch, (0, 0, STANDING_HIPS_M - 0.04)),
        (pushed, (0.05, 0, STANDING_HIPS_M - 0.05)),
    ]
    bows = [(0.5, (0.0,)), (touch, (4.0,)), (pushed, (16.0,))]
    clip = _clip(times, hips, bows, palms, [(0.0, (0, 0))])
    return Demonstration(clip, HandledObjects(RATE_HZ, {"door": path}, {}), contacts)


def _clip(times: Array, hips: Track, bows: Track, palms: dict[str, Array], foot: Track) -> str:
    """The clip of a human whose hips, trunk, palms and right foot follow tracks; the left foot stands."""
    place, bow = _in_file_axes(_along(times, hips)), np.radians(_along(times, bows)[:, 0])
    nothing = np.zeros_like(bow)

    def bent(share: float) -> Array:
        return np.column_stack([nothing, share * bow, nothing])

    spine = (1.0 - PELVIS_SHARE_OF_BOW) / 3.0
    angles = {"Hips": bent(PELVIS_SHARE_OF_BOW)} | {f"Spine{i}": bent(spine) for i in ("", "1", "2")}
    angles["Neck"] = bent(-0.4)
    back, high = _along(times, foot).T
    for side, sign in SIDES.items():
        own = 1.0 if side == "Right" else 0.0
        ankle = np.column_stack([nothing + sign * ANKLE_FROM_MIDDLE_M, ANKLE_HEIGHT_M + own * high, own * back])
        legs = leg_angles(place, angles["Hips"], sign, ankle)
        way = np.array([0.7 * sign, -1.0, -0.3])
        arms = arm_angles(place, angles, sign, _in_file_axes(palms[side]), way)
        angles |= {side + joint: angle for joint, angle in {**legs, **arms}.items()}
    return bvh_text(place, angles, RATE_HZ)


def _gripping_palm(times: Array, sign: float, path: ObjectPath, held: tuple[float, float], above: float) -> Array:
    """Places (T, 3) of a palm that hangs, comes beside a box, holds it in a span of time, and hangs again.

    above: how far above the box's middle it holds it [m].
    """
    side = np.array([0.0, sign * 0.5 * path.size[1], above])
    beside = side + np.array([0.0, sign * BESIDE_M, 0.0])
    hanging = np.array(HANGING_PALM_M) * [1.0, sign, 1.0]
    start, end = held
    first, last = path.position[0], path.position[-1]
    before = [(0.5, hanging), (start - 0.45, first + beside), (start, first + side)]
    after = [(end, last + side), (end + 0.5, last + beside), (end + 1.8, hanging)]
    on_box = path.position + side
    place = np.where((times < start)[:, None], _along(times, before), on_box)
    return np.where((times > end)[:, None], _along(times, after), place)


def _along(times: Array, track: Track) -> Array:
    """Values (T, n) of a track, with least jerk from one entry to the next."""
    values = np.tile(np.array(track[0][1], dtype=float), (len(times), 1))
    for (start, before), (end, after) in pairwise(track):
        share = minimum_jerk((times - start) / (end - start))[:, None]
        values += share * (np.array(after, dtype=float) - np.array(before, dtype=float))
    return values


def _mirrored(place: Sequence[float]) -> Array:
    return np.array(place) * [1.0, -1.0, 1.0]


def _in_file_axes(places: Array) -> Array:
    return places[:, [1, 2, 0]]


def demonstrations() -> dict[str, Demonstration]:
    """All of them by name."""
    return {
        "box_stand": box_demonstration(from_plate=False),
        "box_plate": box_demonstration(from_plate=True),
        "door": door_demonstration(),
    }


if __name__ == "__main__":
    for name, demonstration in demonstrations().items():
        demonstration.write(Path(sys.argv[1]), name)
