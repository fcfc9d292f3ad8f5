"""A recorded human: joint positions and rotations over time, and the legs in a tree of joints."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sot.errors import InputError
from sot.motion.human.human import Remark

MIN_LEG_SHARE = 0.6  # of thigh and shank, of the length of the chain from hip to toes


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
        zero_pose: (J, 3) positions in the file's own axes and unit where no joint is turned, if the file has such a
            pose. It may be a posture, or none at all.
        remarks: on what was lost in the recording, in its own time.
    """

    name: str
    rate: float
    joints: tuple[str, ...]
    parents: tuple[int, ...]
    positions: np.ndarray
    rotations: np.ndarray
    zero_pose: np.ndarray | None = None
    remarks: tuple[Remark, ...] = ()

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
    return _leg_of_chain(best[1], capture.positions), _leg_of_chain(best[2], capture.positions)


def _leg_of_chain(chain: list[int], positions: np.ndarray) -> Leg:
    """The leg in a chain of joints: its two neighbouring bones that are longest together are thigh and shank.

    Where these are the lesser part of the chain, its bones are split, as by MakeHuman: joints that hardly ever bend
    are left out until they are not.
    """
    links = list(chain)
    while True:
        bone = [np.linalg.norm(positions[:, b] - positions[:, a], axis=1) for a, b in pairwise(links)]
        length = [float(np.median(one)) for one in bone]
        knee = max(range(1, len(links) - 1), key=lambda i: length[i - 1] + length[i])
        if length[knee - 1] + length[knee] > MIN_LEG_SHARE * sum(length) or len(links) <= 4:
            return Leg(hip=links[knee - 1], knee=links[knee], ankle=links[knee + 1], tip=links[-1])
        inner = range(1, len(links) - 1)
        whole = [np.linalg.norm(positions[:, links[i + 1]] - positions[:, links[i - 1]], axis=1) for i in inner]
        lost = [float(np.mean(bone[i - 1] + bone[i] - straight)) for i, straight in zip(inner, whole, strict=True)]
        del links[1 + int(np.argmin(lost))]
