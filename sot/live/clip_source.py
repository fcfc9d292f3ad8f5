"""A recorded clip that is played as if the person moved now."""

from collections import Counter

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

from sot.live.frame import Frame, Skeleton
from sot.motion.human.capture import Capture

Array = NDArray[np.float64]


class ClipSource:
    """A capture, frame by frame, from the first time that it is asked on.

    Args:
        capture: the clip, in the project's world.
        rate: frames a second [Hz].
    """

    def __init__(self, capture: Capture, rate: float) -> None:
        self.name = capture.name
        self.counts: Counter[str] = Counter()
        self.ended = False
        self._frames = resampled(capture, rate)
        self._skeleton = Skeleton(capture.joints, capture.parents)
        self._began: float | None = None
        self._next = 0

    @property
    def duration(self) -> float:
        """Length of the clip [s]."""
        return (self._frames.frames - 1) / self._frames.rate

    def poll(self, now: float) -> list[Frame]:
        """The frames that are due."""
        if self._began is None:
            self._began = now
        due = []
        while self._next < self._frames.frames and self._began + self._next / self._frames.rate <= now + 1e-9:
            due.append(self._frame(self._next, now))
            self._next += 1
        self.ended = self._next == self._frames.frames
        return due

    def _frame(self, k: int, now: float) -> Frame:
        frames = self._frames
        return Frame(self._skeleton, frames.positions[k], frames.rotations[k], k / frames.rate, k, now)

    def reply(self, now: float, joints: Array) -> None:
        """A clip wants to know nothing."""

    def close(self) -> None:
        """A clip holds nothing open."""


def resampled(capture: Capture, rate: float) -> Capture:
    """A capture at another rate [Hz]: cubic positions, spherical linear rotations."""
    times = np.arange(capture.frames) / capture.rate
    wanted = np.minimum(np.arange(int(capture.duration * rate + 1e-6) + 1) / rate, times[-1])
    turns = [
        Slerp(times, Rotation.from_matrix(capture.rotations[:, j]))(wanted).as_matrix()
        for j in range(len(capture.joints))
    ]
    positions = CubicSpline(times, capture.positions)(wanted)
    return Capture(
        capture.name, rate, capture.joints, capture.parents, positions, np.stack(turns, axis=1), capture.zero_pose
    )
