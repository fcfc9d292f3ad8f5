"""A source of whole people reduced to key points of the upper body, as a camera above a table sees them."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.live.frame import Frame, Skeleton, Source, capture_of
from sot.motion.human.key_points import KEY_POINTS
from sot.motion.human.skeleton import JointAliases, named_joints

Array = NDArray[np.float64]

PARENT_OF_KEY_POINT = {
    **{
        f"{side}_{below}": f"{side}_{above}"
        for side in ("left", "right")
        for below, above in (("elbow", "shoulder"), ("wrist", "elbow"))
    },
    **{f"{side}_shoulder": "waist" for side in ("left", "right")},
    "head": "waist",
}
KEY_POINT_SKELETON = Skeleton(
    KEY_POINTS, tuple(KEY_POINTS.index(PARENT_OF_KEY_POINT[name]) if name != "waist" else -1 for name in KEY_POINTS)
)


class KeyPointSource:
    """A source of which only the eight key points of the upper body are let through.

    Args:
        source: of whole people.
        names: the key points that are asked for; all eight are needed.
        mapping: names of the joints of an unknown skeleton, as of `named_joints`.

    Raises:
        InputError: some of them are missing.
    """

    def __init__(self, source: Source, names: Sequence[str] = KEY_POINTS, mapping: JointAliases | None = None) -> None:
        if missing := [name for name in KEY_POINTS if name not in names]:
            raise InputError(f"a human takes all eight key points; missing: {', '.join(missing)}")
        self.name = f"{source.name}, key points"
        self._source, self._mapping = source, mapping
        self._skeleton: Skeleton | None = None
        self._joints: list[list[int]] = []

    @property
    def counts(self) -> Counter[str]:
        """Those of the source."""
        return self._source.counts

    @property
    def ended(self) -> bool:
        """Whether nothing more can come."""
        return self._source.ended

    def poll(self, now: float) -> list[Frame]:
        """The key points of the frames that have arrived by a time [s].

        Raises:
            InputError: the skeleton is not known.
        """
        return [self._reduced(frame) for frame in self._source.poll(now)]

    def _reduced(self, frame: Frame) -> Frame:
        if frame.skeleton != self._skeleton:
            joints = named_joints(capture_of([frame], 1.0, self._source.name), self._mapping)
            hips = [joints["left_hip"], joints["right_hip"]]
            self._joints = [hips if name == "waist" else [joints[name]] for name in KEY_POINTS]
            self._skeleton = frame.skeleton
        positions = np.array([frame.positions[joints].mean(axis=0) for joints in self._joints])
        return Frame(KEY_POINT_SKELETON, positions, None, frame.stamp, frame.sequence, frame.received)

    def reply(self, now: float, joints: Array) -> None:
        """Tell the source's listeners."""
        self._source.reply(now, joints)

    def close(self) -> None:
        """Let go of the source."""
        self._source.close()
