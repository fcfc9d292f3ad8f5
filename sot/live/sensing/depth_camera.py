"""A simulated depth camera: positions of joints with noise, dropouts and self-occlusion, some ten times a second."""

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from sot.live.frame import Frame, Source

Array = NDArray[np.float64]

LIMB_RADIUS = 0.06
"""Radius of the capsules about the bones that hide what is behind them [m]."""
MIN_DEPTH_BEHIND = 0.1
"""Depth behind a bone from which on a joint is hidden by it [m]; its own bones meet in it."""


class DepthCamera:
    """A source as a depth camera would see it; a joint that is not seen stays where it was seen last.

    Args:
        source: of the person.
        rate: pictures a second [Hz]; one of the source's frames a picture.
        noise: standard deviation of each coordinate [m].
        dropouts: probability that a joint is not found in a picture.
        place: of the camera in the world (3,) [m].
        seed: of the noise.

    Attributes:
        counts: joints not found ("dropouts") and hidden ("hidden").
    """

    def __init__(
        self,
        source: Source,
        rate: float = 30.0,
        noise: float = 0.01,
        dropouts: float = 0.0,
        place: tuple[float, float, float] = (3.0, 0.0, 1.2),
        seed: int = 0,
    ) -> None:
        self.name = f"{source.name}, depth camera"
        self.counts: Counter[str] = Counter()
        self._source, self._period = source, 1.0 / rate
        self._noise, self._dropouts, self._place = noise, dropouts, np.array(place)
        self._random = np.random.default_rng(seed)
        self._seen: Array | None = None
        self._next_stamp, self._sequence = -np.inf, 0

    @property
    def ended(self) -> bool:
        """Whether nothing more can come."""
        return self._source.ended

    def poll(self, now: float) -> list[Frame]:
        """The pictures of the frames that have arrived by a time [s]."""
        pictures = []
        for frame in self._source.poll(now):
            if frame.stamp >= self._next_stamp - 1e-9:
                self._next_stamp = max(self._next_stamp, frame.stamp - self._period) + self._period
                pictures.append(self._picture(frame))
        return pictures

    def _picture(self, frame: Frame) -> Frame:
        measured = frame.positions + self._noise * self._random.standard_normal(frame.positions.shape)
        hidden = hidden_joints(frame.positions, frame.skeleton.parents, self._place)
        dropped = self._random.random(len(measured)) < self._dropouts
        self.counts["hidden"] += int(np.count_nonzero(hidden))
        self.counts["dropouts"] += int(np.count_nonzero(dropped))
        if self._seen is None:
            self._seen = measured
        else:
            self._seen = np.where((hidden | dropped)[:, None], self._seen, measured)
        self._sequence += 1
        return Frame(frame.skeleton, self._seen, None, frame.stamp, self._sequence, frame.received)

    def reply(self, now: float, joints: Array) -> None:
        """A camera wants to know nothing."""

    def close(self) -> None:
        """Let go of the source."""
        self._source.close()


def hidden_joints(positions: Array, parents: tuple[int, ...], camera: Array) -> NDArray[np.bool_]:
    """Flags (J,) of the joints that a bone of the body hides from a camera at a place (3,).

    A bone hides what is MIN_DEPTH_BEHIND or more behind where the line of sight passes it within LIMB_RADIUS.
    """
    bones = np.array([(parent, joint) for joint, parent in enumerate(parents) if parent >= 0])
    hidden = np.zeros(len(positions), dtype=bool)
    start, along = positions[bones[:, 0]], positions[bones[:, 1]] - positions[bones[:, 0]]
    for joint, place in enumerate(positions):
        sight = place - camera
        depth = float(np.linalg.norm(sight))
        sight = sight / depth
        # nearest points of the line of sight and each bone, the latter's within its ends
        away = start - camera
        across = along - np.outer(along @ sight, sight)
        offset = away - np.outer(away @ sight, sight)
        share = np.clip(-np.sum(across * offset, axis=1) / np.maximum(np.sum(across**2, axis=1), 1e-9), 0.0, 1.0)
        nearest = away + share[:, None] * along
        at = nearest @ sight
        aside = np.linalg.norm(nearest - np.outer(at, sight), axis=1)
        other = (bones != joint).all(axis=1)
        hidden[joint] = bool((other & (aside < LIMB_RADIUS) & (at < depth - MIN_DEPTH_BEHIND)).any())
    return hidden
