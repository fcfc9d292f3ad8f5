"""The shipped clip as numbers, read and turned by means of its own: what the writers of other formats start from."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from tests.sot.motion.human.clips import GROOVE, RATE

ORDER = "YXZ"  # of the shipped clip's channels


@dataclass(frozen=True)
class Dance:
    """Some frames of a dancer; axes X left, Y up, Z forward.

    Attributes:
        joints, parents, offsets: its tree, without end sites; offsets (J, 3) [m].
        place: (T, 3) of the hips [m].
        turns: (T, J) rotations from each joint to its parent.
        tips: joint -> (3,) offset of its end site [m].
    """

    joints: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: np.ndarray
    place: np.ndarray
    turns: np.ndarray
    tips: dict[str, np.ndarray]
    rate: float = RATE

    @property
    def count(self) -> int:
        return len(self.place)

    def world(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions (T, J, 3) [m] and rotations (T, J, 3, 3) in the world."""
        positions, rotations = (
            np.zeros((self.count, len(self.joints), 3)),
            np.zeros((self.count, len(self.joints), 3, 3)),
        )
        for j, parent in enumerate(self.parents):
            turn = Rotation.from_quat(self.turns[:, j]).as_matrix()
            if parent < 0:
                rotations[:, j], positions[:, j] = turn, self.place
            else:
                rotations[:, j] = rotations[:, parent] @ turn
                positions[:, j] = positions[:, parent] + np.einsum("tij,j->ti", rotations[:, parent], self.offsets[j])
        return positions, rotations

    def at(self, name: str) -> np.ndarray:
        """(T, 3) of a joint [m]."""
        return self.world()[0][:, self.joints.index(name)]


def dance(frames: int = 60, first: int = 150, heading_deg: float = 0.0) -> Dance:
    """Some frames of the shipped clip, turned about the vertical."""
    head, _, motion = GROOVE.read_text().partition("MOTION\n")
    values = np.array([line.split() for line in motion.splitlines()[2 + first : 2 + first + frames]], dtype=float)
    joints: list[str] = []
    parents: list[int] = []
    offsets: list[list[float]] = []
    tips: dict[str, np.ndarray] = {}
    stack: list[int] = []
    for line in head.splitlines():
        words = line.split()
        if words[0] in ("ROOT", "JOINT"):
            parents.append(stack[-1] if stack else -1)
            joints.append(words[1])
            stack.append(len(joints) - 1)
        elif words[0] == "End":
            stack.append(-2)
        elif words[0] == "OFFSET":
            offset = [float(word) / 100.0 for word in words[1:]]
            if stack[-1] == -2:
                tips[joints[stack[-2]]] = np.array(offset)
            else:
                offsets.append(offset)
        elif words[0] == "}":
            stack.pop()
    turn = Rotation.from_euler("Y", heading_deg, degrees=True)
    angles = values[:, 3:].reshape(len(values), len(joints), 3)
    turns = np.stack([Rotation.from_euler(ORDER, angles[:, j], degrees=True).as_quat() for j in range(len(joints))], 1)
    turns[:, 0] = (turn * Rotation.from_quat(turns[:, 0])).as_quat()
    return Dance(tuple(joints), tuple(parents), np.array(offsets), turn.apply(values[:, :3] / 100.0), turns, tips)


def mirrored(one: Dance) -> Dance:
    """The dance in a mirror, its joints still named left and right as they were."""
    flip = np.array([-1.0, 1.0, 1.0])
    turns = one.turns * np.array([1.0, -1.0, -1.0, 1.0])  # quaternions x, y, z, w mirrored in X
    return replace(
        one,
        place=one.place * flip,
        offsets=one.offsets * flip,
        turns=turns,
        tips={name: tip * flip for name, tip in one.tips.items()},
    )
