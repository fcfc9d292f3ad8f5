"""One moment of a person who moves, as a source gives it."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sot.motion.human.capture import Capture

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Skeleton:
    """Names of the J joints that a source sends, and their parents (-1 for the root), parents first."""

    joints: tuple[str, ...]
    parents: tuple[int, ...]


@dataclass(frozen=True)
class Frame:
    """Where a person's joints are.

    Attributes:
        skeleton: whose joints.
        positions: (J, 3) in a world whose Z is up [m].
        rotations: (J, 3, 3) from joint to world, None where the source knows positions only.
        stamp: when the person was there, by the sender's clock [s].
        sequence: count of the sender's frames.
        received: when it arrived, by the clock of this end [s].
    """

    skeleton: Skeleton
    positions: Array
    rotations: Array | None
    stamp: float
    sequence: int
    received: float

    @property
    def is_finite(self) -> bool:
        """Whether all of its numbers are finite."""
        return bool(np.isfinite(self.positions).all() and (self.rotations is None or np.isfinite(self.rotations).all()))


class Source(Protocol):
    """Where frames come from; asked for them again and again, and never waits.

    Attributes:
        name: of what it is, for the report.
        counts: how many packets or frames were dropped, by reason.
        ended: whether nothing more can come.
    """

    name: str
    counts: Counter[str]
    ended: bool

    def poll(self, now: float) -> list[Frame]:
        """Frames that have arrived by a time [s] of this end's clock since it was last asked, as they arrived."""
        ...

    def reply(self, now: float, joints: Array) -> None:
        """Joint targets (na,) [rad] for those who have asked for them; most sources have nobody to tell."""
        ...

    def close(self) -> None:
        """Let go of what it holds open."""
        ...


def capture_of(frames: Sequence[Frame], rate: float, name: str) -> Capture:
    """Frames of one skeleton as a capture; joints without rotations get those of the world's axes."""
    skeleton = frames[0].skeleton
    positions = np.array([frame.positions for frame in frames])
    upright = np.broadcast_to(np.eye(3), (*positions.shape, 3))
    rotations = [frame.rotations if frame.rotations is not None else upright[0] for frame in frames]
    return Capture(name, rate, skeleton.joints, skeleton.parents, positions, np.array(rotations))
