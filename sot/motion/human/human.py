"""A human in motion: canonical points and the frames of pelvis, chest and head over time."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt
from scipy.spatial.transform import Rotation, Slerp

from sot.errors import InputError
from sot.gravity import GRAVITY

SIDES = ("left", "right")
SEGMENTS: dict[str, tuple[str, str]] = {
    "trunk": ("waist", "neck"),
    "head": ("head", "head_top"),
    **{
        f"{side}_{segment}": (f"{side}_{upper}", f"{side}_{lower}")
        for side in SIDES
        for segment, upper, lower in (
            ("thigh", "hip", "knee"),
            ("shank", "knee", "ankle"),
            ("upper_arm", "shoulder", "elbow"),
            ("forearm", "elbow", "wrist"),
        )
    },
}


@dataclass(frozen=True)
class Remark:
    """A sentence on a stretch of a clip: what was mended of it, or what the robot does otherwise.

    Attributes:
        start, end: of the stretch, in the clip's time [s].
        words: the sentence.
        on_feet: whether the dancer's feet carry it there.
        climbed: height above the floor of what the dancer stands on there, at most [m], where a scene may have it.
    """

    start: float
    end: float
    words: str
    on_feet: bool = True
    climbed: float = 0.0


@dataclass(frozen=True)
class Human:
    """A human's motion under canonical names, whatever its file called them.

    Attributes:
        name: of the clip.
        rate: frames per second [Hz].
        points: name -> (T, 3) position in the world [m]: waist (mid hips), chest, neck, head, head_top, and `left_` and
            `right_` shoulder, elbow, wrist, hip, knee, ankle, toe.
        frames: body -> (T, 3, 3) rotation from body to world of pelvis, chest and head: X forward, Y left, Z up when
            the human stands upright and looks ahead.
        start: seconds of the clip before the first frame.
        remarks: on what happens in its frames, in order of time.
        ground: foot -> (T,) height of what it stands on above the floor, of a human who climbs [m]: its points are
            lower by that, as if all of it were one level.
    """

    name: str
    rate: float
    points: dict[str, np.ndarray]
    frames: dict[str, np.ndarray]
    start: float = 0.0
    remarks: tuple[Remark, ...] = ()
    ground: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Number of frames T."""
        return len(self.points["waist"])

    @property
    def times(self) -> np.ndarray:
        """(T,) seconds since the first frame."""
        return np.arange(self.count) / self.rate

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.count - 1) / self.rate

    @property
    def leg(self) -> float:
        """Length of thigh and shank, mean of both sides [m]."""
        return self._length("thigh") + self._length("shank")

    @property
    def arm(self) -> float:
        """Length of upper arm and forearm, mean of both sides [m]."""
        return self._length("upper_arm") + self._length("forearm")

    def _length(self, segment: str) -> float:
        ends = [SEGMENTS[f"{side}_{segment}"] for side in SIDES]
        bones = [np.linalg.norm(self.points[far] - self.points[near], axis=1) for near, far in ends]
        return float(np.mean(np.median(bones, axis=1)))

    @property
    def leg_time(self) -> float:
        """√(leg / g) [s], by which a body of this size gets out of balance."""
        return float(np.sqrt(self.leg / GRAVITY))

    def pelvis_frame(self) -> np.ndarray:
        """(T, 3, 3) rotation from pelvis to world."""
        return self.frames["pelvis"]

    def chest_frame(self) -> np.ndarray:
        """(T, 3, 3) rotation from chest to world."""
        return self.frames["chest"]

    def head_frame(self) -> np.ndarray:
        """(T, 3, 3) rotation from head to world."""
        return self.frames["head"]

    def segment_direction(self, segment: str) -> np.ndarray:
        """(T, 3) unit vectors along one of SEGMENTS, from its near end to its far end, in the world."""
        near, far = SEGMENTS[segment]
        along = self.points[far] - self.points[near]
        return along / np.linalg.norm(along, axis=1, keepdims=True)

    def slice(self, start: float = 0.0, duration: float | None = None) -> "Human":
        """The part of `duration` seconds from `start`, to the end by default; less where the clip ends before.

        Raises:
            InputError: nothing of the clip lies in there.
        """
        first = round(start * self.rate)
        last = self.count if duration is None else min(self.count, first + round(duration * self.rate) + 1)
        if start < 0 or last - first < 2:
            wanted = f"from {start:g} s" + (f" for {duration:g} s" if duration is not None else "")
            raise InputError(f"{self.name}: nothing {wanted}; the clip lasts {self.duration:.2f} s")
        begins, ends = self.start + first / self.rate, self.start + (last - 1) / self.rate
        return replace(
            self,
            points={name: position[first:last] for name, position in self.points.items()},
            frames={body: rotation[first:last] for body, rotation in self.frames.items()},
            ground={foot: level[first:last] for foot, level in self.ground.items()},
            start=begins,
            remarks=tuple(one for one in self.remarks if one.start <= ends and one.end >= begins),
        )

    def resampled(self, rate: float) -> "Human":
        """The motion at another rate [Hz], first to last frame: cubic positions, spherical linear rotations."""
        times = np.arange(int(self.duration * rate + 1e-6) + 1) / rate
        return self.resampled_at(np.minimum(times, self.duration), rate)

    def resampled_at(self, times: np.ndarray, rate: float) -> "Human":
        """The motion sampled at times (T,) within its duration [s], which become frames at a rate [Hz]."""
        points = CubicSpline(self.times, np.stack(list(self.points.values()), axis=1))(times)
        frames = {body: Slerp(self.times, Rotation.from_matrix(r))(times) for body, r in self.frames.items()}
        return replace(
            self,
            rate=rate,
            points={name: points[:, i] for i, name in enumerate(self.points)},
            frames={body: rotation.as_matrix() for body, rotation in frames.items()},
            ground={foot: np.interp(times, self.times, level) for foot, level in self.ground.items()},
        )

    def low_passed(self, cutoff_hz: float) -> "Human":
        """The motion without what is faster than `cutoff_hz`: second-order Butterworth, forward and backward, no delay.

        A cutoff that the frame rate cannot hold, at or above half of it, leaves the motion as it is.
        """
        if cutoff_hz >= 0.5 * self.rate:
            return self
        sos = butter(2, cutoff_hz, fs=self.rate, output="sos")
        padding = min(self.count - 1, round(3 * self.rate / cutoff_hz))

        def smooth(samples: np.ndarray) -> np.ndarray:
            return sosfiltfilt(sos, samples, axis=0, padlen=padding)

        points = smooth(np.stack(list(self.points.values()), axis=1))
        return replace(
            self,
            points={name: points[:, i] for i, name in enumerate(self.points)},
            frames={body: nearest_rotations(smooth(rotation)) for body, rotation in self.frames.items()},
        )

    def scaled(self, factor: float) -> "Human":
        """The motion with every position multiplied by `factor`."""
        return replace(
            self,
            points={name: factor * position for name, position in self.points.items()},
            ground={foot: factor * level for foot, level in self.ground.items()},
        )

    def lowered(self, under: Mapping[str, np.ndarray]) -> "Human":
        """The human over level ground: ankles and toes lowered by what is `under` each, point -> (T,) [m].

        The body goes down by the mean of both ankles, and a knee by the mean of its ankle and the body. What was under
        the ankles is added to `ground`.
        """
        body, points = 0.5 * (under["left_ankle"] + under["right_ankle"]), {}
        for name, place in self.points.items():
            side, _, joint = name.partition("_")
            low = 0.5 * (under[f"{side}_ankle"] + body) if joint == "knee" else under.get(name, body)
            points[name] = place - np.outer(low, [0.0, 0.0, 1.0])
        ground = {f"{side}_foot": self.ground.get(f"{side}_foot", 0.0) + under[f"{side}_ankle"] for side in SIDES}
        return replace(self, points=points, ground=ground)


def nearest_rotations(matrices: np.ndarray) -> np.ndarray:
    """The rotations nearest to (..., 3, 3) matrices in the Frobenius norm."""
    u, _, vt = np.linalg.svd(matrices)
    u[..., :, 2] *= np.sign(np.linalg.det(u @ vt))[..., None]
    return u @ vt
