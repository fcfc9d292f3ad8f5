"""A capture brought into the project's world: metres, Z up, walking off along X."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from sot.errors import InputError
from sot.motion.human.capture import Capture, Leg, find_legs

HUMAN_LEG_RANGE_M = (0.6, 1.1)  # hip to ankle of a human who can dance
AVERAGE_LEG_M = 0.85
METRES_PER_UNIT = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "cmu": 0.0254 / 0.45, "ft": 0.3048}
"""Name of a unit -> metres; CMU counts in inches / 0.45."""
REFERENCE_POSE_JUMP_SPEED = 9.0  # m/s; a joint moves faster from one frame to the next only out of a reference pose
COORDINATE_LIMIT = 1e6  # in file units: a kilometre in the smallest unit
FLOOR_PERCENTILE = 3.0  # of the lowest point of the feet: neither a jump nor a dip of noise moves the floor

UP_AXES = {sign + axis: (k, 1.0 if not sign else -1.0) for sign in ("", "-") for k, axis in enumerate("xyz")}
"""Name of each axis of a file that may be up, or forward -> its index and sign."""
CLEARLY_UPRIGHT = 0.8  # cosine of a body to an axis, on average, from which on the clip itself shows that it is up
POSTURE_COSINE = 0.9  # of trunk and legs to each other and to an axis, in a zero pose that is a posture
MIN_UPSIDE_DOWN = 0.4  # leg lengths that other parts of the body get below the feet: hands that are low get less
LYING_EXTENT = 0.9  # leg lengths: all that is recorded of who lies or crawls is within this height above the floor
FLOOR_TOLERANCE = 0.2  # leg lengths, between the origin of a file and its floor


def to_world(recorded: Capture, up: str | None = None, forward: str | None = None, unit: str | None = None) -> Capture:
    """Turn a capture in its file's own units and axes into one in the project's.

    Needs no joint names, only a pair of legs: the longest two chains of equal bones that hang off one joint. Their
    size gives the unit, knees and toes the front, the body above the hips and the legs below the up axis (see
    `up_axis`). A reference pose that precedes the motion is dropped. The first frame ends up heading +X with its mid
    hips over the origin; the lowest point of the feet, or of who never stands on them, is at z = 0.

    Args:
        recorded: What a file holds.
        up: The file's up axis, one of `UP_AXES`, instead of the one that the clip shows.
        forward: The file's axis that becomes +X, instead of the first frame's heading.
        unit: The file's unit, one of `METRES_PER_UNIT`, instead of the one that the legs show.

    Raises:
        InputError: no pair of legs, numbers too large to be a motion, or another axis or unit.
    """
    ways = {name: _checked_axis(f"{name} axis", way) for name, way in (("up", up), ("forward", forward)) if way}
    if unit is not None and unit.lower() not in METRES_PER_UNIT:
        raise InputError(f"unit '{unit}' is not known: choose one of {', '.join(METRES_PER_UNIT)}")
    if not np.abs(recorded.positions).max() < COORDINATE_LIMIT:
        raise InputError(f"{recorded.name}: its positions are too large to be a human motion")
    legs = find_legs(recorded)
    scale = METRES_PER_UNIT[unit.lower()] if unit else _metres_per_unit(recorded, legs)
    positions = recorded.positions * scale
    first = _first_moving_frame(positions, recorded.rate)
    positions, rotations = positions[first:], recorded.rotations[first:]

    vertical = ways.get("up") or up_axis(recorded, legs, scale)
    upright = _rotation_to_z_up(vertical)
    if "forward" in ways:
        axis, sign = ways["forward"]
        if axis == vertical[0]:
            raise InputError(f"{recorded.name}: the forward axis '{forward}' lies along the up axis; name another")
        turn = _rotation_to_x(sign * upright[:, axis]) @ upright
    else:
        turn = _rotation_to_x(_first_heading(positions @ upright.T, legs)) @ upright
    positions, rotations = positions @ turn.T, turn @ rotations

    hips = positions[0, [leg.hip for leg in legs]].mean(axis=0)
    feet = positions[:, [joint for leg in legs for joint in (leg.knee, leg.ankle, leg.tip)], 2].min(axis=1)
    floor, lowest = (float(np.percentile(low, FLOOR_PERCENTILE)) for low in (feet, positions[:, :, 2].min(axis=1)))
    if floor - lowest > MIN_UPSIDE_DOWN * AVERAGE_LEG_M:
        floor = lowest  # it never stands on its feet
    origin = np.array([hips[0], hips[1], floor])
    late = first / recorded.rate
    remarks = tuple(replace(one, start=one.start - late, end=one.end - late) for one in recorded.remarks)
    return replace(recorded, positions=positions - origin, rotations=rotations, remarks=remarks)


def _metres_per_unit(capture: Capture, legs: tuple[Leg, Leg]) -> float:
    """Metres per file unit: the known unit that makes the legs human, or else the one that makes them average."""
    length = np.mean(
        [
            np.median(np.linalg.norm(capture.positions[:, upper] - capture.positions[:, lower], axis=1))
            for leg in legs
            for upper, lower in pairwise((leg.hip, leg.knee, leg.ankle))
        ]
    )
    leg_length = 2.0 * float(length)
    for unit in METRES_PER_UNIT.values():
        if HUMAN_LEG_RANGE_M[0] <= leg_length * unit <= HUMAN_LEG_RANGE_M[1]:
            return unit
    return AVERAGE_LEG_M / leg_length


def _first_moving_frame(positions: np.ndarray, rate: float) -> int:
    """Index of the first frame after a reference pose (T-pose); 0 without one. The jump out of the pose shows it.

    The pose may be held for some frames. A fast start is no jump: there the frames that follow are fast as well.
    """
    speed = np.linalg.norm(np.diff(positions[:13], axis=0), axis=2).max(axis=1) * rate
    held = 0
    while held < len(speed) and speed[held] < 1e-6:
        held += 1
    after = speed[held + 1 :]
    if len(after) and speed[held] > max(REFERENCE_POSE_JUMP_SPEED, 3.0 * after.max()):
        return held + 1
    return 0


def up_axis(recorded: Capture, legs: tuple[Leg, Leg], scale: float) -> tuple[int, float]:
    """The file's up axis as its index and sign, in the manner of `UP_AXES`.

    It is the axis that hips are above ankles and the rest of the body is above the hips along, on average. Where the
    clip does not clearly show one, or shows someone upright who by its zero pose would lie flat on the file's floor or
    be upside down, the zero pose decides if it is a posture: people sit, crawl, lie and stand on their hands.

    scale: metres per unit of the file.
    """
    direction = np.mean(_body_directions(recorded, recorded.positions, legs), axis=(0, 1))
    shown = int(np.argmax(np.abs(direction)))
    posture = None if recorded.zero_pose is None else _up_of_posture(recorded, recorded.zero_pose, legs)
    sign = 1.0 if direction[shown] > 0.0 else -1.0
    if posture is not None:
        vague = np.abs(direction[shown]) < CLEARLY_UPRIGHT
        if vague or posture == (shown, -sign) or _lies(recorded, legs, scale, posture, shown):
            return posture
    return shown, sign


def _body_directions(recorded: Capture, positions: np.ndarray, legs: tuple[Leg, Leg]) -> np.ndarray:
    """Unit vectors (2, T, 3) from ankles to hips, and from hips to the middle of all bones above, by their lengths."""
    hips = positions[:, [leg.hip for leg in legs]].mean(axis=1)
    ankles = positions[:, [leg.ankle for leg in legs]].mean(axis=1)
    own = _joints_above_hips(recorded, legs)
    upper, lower = positions[:, [recorded.parents[joint] for joint in own]], positions[:, own]
    length = np.linalg.norm(lower - upper, axis=2)[:, :, None]
    trunk = np.sum(length * (0.5 * (upper + lower) - hips[:, None]), axis=1)
    return np.stack([_unit(hips - ankles), _unit(trunk)])


def _joints_above_hips(recorded: Capture, legs: tuple[Leg, Leg]) -> list[int]:
    """Joints below the pelvis, the nearest joint that carries both legs, in the tree, but for those of the legs."""
    carried: dict[int, set[int]] = {}  # joint -> which of both hips are the joint itself or below it
    for k, leg in enumerate(legs):
        joint = leg.hip
        while joint >= 0:
            carried.setdefault(joint, set()).add(k)
            joint = recorded.parents[joint]
    pelvis = max(joint for joint, hips in carried.items() if len(hips) == len(legs))
    part = {pelvis}
    for joint, parent in enumerate(recorded.parents):  # parents come first
        if parent in part and joint not in carried:
            part.add(joint)
    return sorted(part - {pelvis})


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (T, 3) divided by their lengths; those without a length stay 0."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)


def _up_of_posture(recorded: Capture, pose: np.ndarray, legs: tuple[Leg, Leg]) -> tuple[int, float] | None:
    """The up axis of a pose (J, 3) in which a human stands; None if it is no such pose."""
    below, above = _body_directions(recorded, pose[None], legs)[:, 0]
    axis = int(np.argmax(np.abs(below)))
    sign = 1.0 if below[axis] > 0.0 else -1.0
    return (axis, sign) if min(sign * below[axis], sign * above[axis], below @ above) > POSTURE_COSINE else None


def _lies(recorded: Capture, legs: tuple[Leg, Leg], scale: float, up: tuple[int, float], shown: int) -> bool:
    """Whether a clip shows someone who lies on the floor by one up axis, rather than who stands on it by another."""
    leg = AVERAGE_LEG_M / scale
    height = up[1] * recorded.positions[:, :, up[0]]
    feet = recorded.positions[:, [leg.tip for leg in legs], shown]
    flat = np.percentile(height.max(axis=1), 95.0) - np.percentile(height.min(axis=1), 5.0) < LYING_EXTENT * leg
    on_floor = abs(np.percentile(height.min(axis=1), 5.0)) < FLOOR_TOLERANCE * leg
    return bool(flat and on_floor and np.abs(feet).min() > FLOOR_TOLERANCE * leg)


def _checked_axis(kind: str, name: str) -> tuple[int, float]:
    if name.lower() not in UP_AXES:
        raise InputError(f"{kind} '{name}' is not known: choose one of {', '.join(UP_AXES)}")
    return UP_AXES[name.lower()]


def _rotation_to_z_up(up: tuple[int, float]) -> np.ndarray:
    """(3, 3) rotation from a file's axes to Z up, its up axis given as index and sign."""
    axis, sign = up
    turns = {0: [[0, 1, 0], [0, 0, sign], [sign, 0, 0]], 1: [[1, 0, 0], [0, 0, -sign], [0, sign, 0]]}
    return np.array(turns.get(axis, [[1, 0, 0], [0, sign, 0], [0, 0, sign]]), dtype=float)


def _first_heading(positions: np.ndarray, legs: tuple[Leg, Leg]) -> np.ndarray:
    """(2,) direction that the first frame's pelvis faces, Z up."""
    one, other = legs
    lateral = positions[:, one.hip] - positions[:, other.hip]
    front = np.stack([lateral[:, 1], -lateral[:, 0]], axis=1)  # ahead if `one` is the left leg
    pointing = sum(
        positions[:, leg.knee]
        - 0.5 * (positions[:, leg.hip] + positions[:, leg.ankle])  # knees bend to the front
        + positions[:, leg.tip]
        - positions[:, leg.ankle]  # and toes point there
        for leg in legs
    )
    if np.sum(front * pointing[:, :2]) < 0:
        front = -front
    heading: np.ndarray = front[0]
    return heading


def _rotation_to_x(direction: np.ndarray) -> np.ndarray:
    """(3, 3) rotation about Z that turns a direction (2,) or (3,) to +X, seen from above."""
    heading = np.arctan2(direction[1], direction[0])
    c, s = np.cos(heading), np.sin(heading)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
