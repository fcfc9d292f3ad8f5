"""Clips joined end to end as one performance: the end of each is blended into the beginning of the next."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.motion.human.capture import Capture
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

SEAM_TIME = 0.5
"""Time for which the end of a clip and the beginning of the next overlap [s]."""


def joined(captures: Iterable[Capture]) -> Capture:
    """Captures of one skeleton and one rate, one after the other.

    Each goes on from where the one before ended, facing the same way. Over a seam, bones turn from one to the other and
    keep their lengths.

    Raises:
        InputError: their skeletons differ, or one is too short for its seams.
    """
    parts = iter(captures)
    whole = next(parts)
    for following in parts:
        whole = _joined(whole, following)
    return whole


def repeated(capture: Capture, seconds: float) -> Capture:
    """A capture, again and again until it lasts for some time [s].

    Raises:
        InputError: it is too short for its seams.
    """
    whole = capture
    while whole.duration < seconds:
        whole = _joined(whole, capture)
    rows = slice(round(seconds * whole.rate) + 1)
    return Capture(
        whole.name,
        whole.rate,
        whole.joints,
        whole.parents,
        whole.positions[rows],
        whole.rotations[rows],
        whole.zero_pose,
    )


def _joined(first: Capture, second: Capture) -> Capture:
    if (first.joints, first.parents) != (second.joints, second.parents):
        raise InputError(f"{first.name} and {second.name} have different skeletons: send them one at a time")
    seam = round(SEAM_TIME * first.rate) + 1
    for one in (first, second):
        if one.frames <= 2 * seam:
            raise InputError(f"{one.name}: a seam needs clips of more than {2.0 * SEAM_TIME:g} s")
    start = first.frames - seam
    hips = _hips(first.parents)
    positions, rotations = _moved(second, hips, first.positions[start, hips], first.rotations[start, hips])
    share = minimum_jerk(np.linspace(0.0, 1.0, seam))
    blended = _blended(
        first.parents, share, first.positions[start:], first.rotations[start:], positions[:seam], rotations[:seam]
    )
    return Capture(
        first.name,
        first.rate,
        first.joints,
        first.parents,
        np.concatenate([first.positions[:start], blended[0], positions[seam:]]),
        np.concatenate([first.rotations[:start], blended[1], rotations[seam:]]),
        first.zero_pose,
    )


def _hips(parents: tuple[int, ...]) -> int:
    """The first joint from which trunk and legs part; above it there may be a root that stays where it is."""
    return next((j for j in range(len(parents)) if parents.count(j) >= 3), 0)


def _moved(capture: Capture, hips: int, position: Array, rotation: Array) -> tuple[Array, Array]:
    """Positions and rotations of a capture whose hips start over a position (3,), and face as a rotation (3, 3)."""
    turned = rotation @ capture.rotations[0, hips].T
    heading = Rotation.from_euler("z", np.arctan2(turned[1, 0] - turned[0, 1], turned[0, 0] + turned[1, 1]))
    turn, start = heading.as_matrix(), capture.positions[0, hips]
    there = np.append(position[:2], start[2])
    return (capture.positions - start) @ turn.T + there, turn @ capture.rotations


def _blended(
    parents: tuple[int, ...], share: Array, positions: Array, rotations: Array, others: Array, turns: Array
) -> tuple[Array, Array]:
    """Positions (n, J, 3) and rotations (n, J, 3, 3) that go over from one motion to another, by a share (n,)."""
    between = np.empty_like(rotations)
    for j in range(len(parents)):
        way = Rotation.from_matrix(rotations[:, j].transpose(0, 2, 1) @ turns[:, j]).as_rotvec()
        between[:, j] = rotations[:, j] @ Rotation.from_rotvec(share[:, None] * way).as_matrix()
    weight, places, hips = share[:, None], np.empty_like(positions), _hips(parents)
    for j, parent in enumerate(parents):
        if parent < 0 or j <= hips:
            places[:, j] = (1.0 - weight) * positions[:, j] + weight * others[:, j]
            continue
        offset, other = (
            np.einsum("nba,nb->na", turn[:, parent], place[:, j] - place[:, parent])
            for turn, place in ((rotations, positions), (turns, others))
        )
        places[:, j] = places[:, parent] + np.einsum(
            "nab,nb->na", between[:, parent], (1.0 - weight) * offset + weight * other
        )
    return places, between
