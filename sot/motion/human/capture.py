"""A recorded human: joint positions and rotations over time, in metres, Z up, walking off along X."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from sot.errors import InputError

HUMAN_LEG_RANGE_M = (0.6, 1.1)  # hip to ankle of a human who can dance
AVERAGE_LEG_M = 0.85
KNOWN_METRES_PER_UNIT = (
    1.0,
    0.01,
    0.001,
    0.0254,
    0.0254 / 0.45,
    0.3048,
)  # m, cm, mm, inch, inch/0.45 (CMU), foot
REFERENCE_POSE_JUMP_SPEED = 9.0  # m/s; a joint moves faster from one frame to the next only out of a reference pose
COORDINATE_LIMIT = 1e6  # in file units: a kilometre in the smallest unit
FLOOR_PERCENTILE = 3.0  # of the lowest point of the feet: neither a jump nor a dip of noise moves the floor


@dataclass(frozen=True)
class Capture:
    """A motion of a tree of joints as a file gives it; end sites are joints too.

    Attributes:
        name: what to call it, the stem of its file.
        rate: frames per second [Hz].
        joints: J names, unique; parents come before their children.
        parents: J indices, -1 for the root.
        positions: (T, J, 3) of the joints in the world [m].
        rotations: (T, J, 3, 3) from joint to world. How a joint's axes lie in its body is up to the file.
    """

    name: str
    rate: float
    joints: tuple[str, ...]
    parents: tuple[int, ...]
    positions: np.ndarray
    rotations: np.ndarray

    @property
    def frames(self) -> int:
        return len(self.positions)

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.frames - 1) / self.rate


@dataclass(frozen=True)
class Leg:
    """Indices of the joints of one leg; `tip` is its last joint or end site."""

    hip: int
    knee: int
    ankle: int
    tip: int


def to_world(recorded: Capture) -> Capture:
    """Turn a capture in its file's own units and axes into one in the project's.

    Needs no joint names, only a pair of legs: the longest two chains of equal bones that hang off one joint. Their
    size gives the unit, the way from ankles to hips the up axis, knees and toes the front. A reference pose that
    precedes the motion is dropped. The first frame ends up heading +X with its mid hips over the origin; the lowest
    point of the feet is at z = 0.

    Raises:
        InputError: no pair of legs, or numbers too large to be a motion.
    """
    if not np.abs(recorded.positions).max() < COORDINATE_LIMIT:
        raise InputError(f"{recorded.name}: its positions are too large to be a human motion")
    legs = find_legs(recorded)
    scale = _metres_per_unit(recorded, legs)
    positions = recorded.positions * scale
    first = _first_moving_frame(positions, recorded.rate)
    positions, rotations = positions[first:], recorded.rotations[first:]

    upright = _rotation_to_z_up(positions, legs)
    turn = _rotation_to_face_x(positions @ upright.T, legs) @ upright
    positions, rotations = positions @ turn.T, turn @ rotations

    hips = positions[0, [leg.hip for leg in legs]].mean(axis=0)
    feet = positions[:, [joint for leg in legs for joint in (leg.knee, leg.ankle, leg.tip)], 2].min(axis=1)
    origin = np.array([hips[0], hips[1], np.percentile(feet, FLOOR_PERCENTILE)])
    return replace(recorded, positions=positions - origin, rotations=rotations)


def find_legs(capture: Capture) -> tuple[Leg, Leg]:
    """The two legs of a tree of joints, known by their bones alone; which is left stays open.

    Raises:
        InputError: no joint has two equal chains of at least two bones below it.
    """
    parents = np.array(capture.parents)
    bone = np.median(np.linalg.norm(capture.positions - capture.positions[:, parents], axis=2), axis=0)
    bone[0] = 0.0
    children: list[list[int]] = [[] for _ in parents]
    reach = np.zeros(len(parents))
    for joint in range(len(parents) - 1, 0, -1):
        children[parents[joint]].append(joint)
        reach[parents[joint]] = max(reach[parents[joint]], reach[joint] + bone[joint])

    def chain(joint: int) -> list[int]:
        """From a joint to the farthest joint below it."""
        links = [joint]
        while children[links[-1]]:
            links.append(max(children[links[-1]], key=lambda child: reach[child] + bone[child]))
        return links

    best: tuple[float, list[int], list[int]] = (0.0, [], [])
    for siblings in children:
        chains = [chain(joint) for joint in siblings]
        for i, one in enumerate(chains):
            for other in chains[:i]:
                alike = len(one) == len(other) >= 3
                if alike and np.allclose(bone[one[1:]], bone[other[1:]], rtol=0, atol=0.1 * reach[one[0]]):
                    best = max(best, (float(reach[one[0]]), one, other))
    if best[0] < 1e-6:
        raise InputError(f"{capture.name}: no human motion, for its {len(parents)} joints hold no pair of legs")
    return _leg_of_chain(best[1], bone), _leg_of_chain(best[2], bone)


def _leg_of_chain(chain: list[int], bone: np.ndarray) -> Leg:
    """The leg in a chain of joints: its two neighbouring bones that are longest together are thigh and shank."""
    knee = max(range(1, len(chain) - 1), key=lambda i: bone[chain[i]] + bone[chain[i + 1]])
    return Leg(hip=chain[knee - 1], knee=chain[knee], ankle=chain[knee + 1], tip=chain[-1])


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
    for unit in KNOWN_METRES_PER_UNIT:
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


def _rotation_to_z_up(positions: np.ndarray, legs: tuple[Leg, Leg]) -> np.ndarray:
    """(3, 3) rotation from the file's axes to Z up. Files are Y up or Z up; upside down would be unusual."""
    hips = positions[:, [leg.hip for leg in legs]].mean(axis=(0, 1))
    ankles = positions[:, [leg.ankle for leg in legs]].mean(axis=(0, 1))
    up = hips - ankles
    if abs(up[2]) > abs(up[1]):
        return np.diag([1.0, 1.0, 1.0]) if up[2] > 0 else np.diag([1.0, -1.0, -1.0])
    side = np.sign(up[1]) or 1.0
    return np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -side], [0.0, side, 0.0]])


def _rotation_to_face_x(positions: np.ndarray, legs: tuple[Leg, Leg]) -> np.ndarray:
    """(3, 3) rotation about Z that makes the first frame's pelvis face +X."""
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
    heading = np.arctan2(front[0, 1], front[0, 0])
    c, s = np.cos(heading), np.sin(heading)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
