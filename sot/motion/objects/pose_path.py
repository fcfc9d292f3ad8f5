"""Poses over time as a path that can be sampled anywhere, with its derivatives."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

from sot.control.pose import Pose
from sot.motion.trajectory import Track
from sot.rotation import rotation_of_vector

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PosePath:
    """A point's path, at rest before its first sample and after its last.

    Attributes:
        rate: Samples per second [Hz].
        track: The samples.
    """

    rate: float
    track: Track

    @classmethod
    def through(cls, times: Array, position: Array, rotation: Array, rate: float) -> "PosePath":
        """The smooth path through positions (T, 3) [m] and rotations (T, 3, 3) at times (T,) [s], sampled at a rate."""
        samples = np.arange(round(times[-1] * rate) + 1) / rate
        inside = np.clip(samples, times[0], times[-1])
        place, turn = (
            CubicSpline(times, position, bc_type="clamped"),
            RotationSpline(times, Rotation.from_matrix(rotation)),
        )
        turned = turn(inside)
        velocity, acceleration = (np.hstack([place(inside, k), turned.apply(turn(inside, k))]) for k in (1, 2))
        still = (samples <= times[0]) | (samples >= times[-1])
        velocity[still], acceleration[still] = 0.0, 0.0
        return cls(rate, Track(place(inside), turned.as_matrix(), velocity, acceleration))

    def __call__(self, t: float) -> Pose:
        """The pose at a time [s]."""
        track, last = self.track, len(self.track.position) - 1
        x = min(max(t * self.rate, 0.0), float(last))
        k = int(x + 1e-6)
        dt = max(x - k, 0.0) / self.rate
        velocity, acceleration = track.velocity[k], track.acceleration[k]
        if not dt:
            return Pose(track.position[k], track.rotation[k], velocity, acceleration)
        place = track.position[k] + dt * velocity[:3] + 0.5 * dt**2 * acceleration[:3]
        turn = rotation_of_vector(dt * velocity[3:] + 0.5 * dt**2 * acceleration[3:])
        return Pose(place, turn @ track.rotation[k], velocity + dt * acceleration, acceleration)

    def placement(self, t: float) -> pin.SE3:
        """Its place at a time [s]."""
        pose = self(t)
        return pin.SE3(pose.rotation, pose.position)


def blended(first: Sequence[pin.SE3], second: Sequence[pin.SE3], share: Array) -> tuple[Array, Array]:
    """Positions (T, 3) and rotations (T, 3, 3) from first to second poses, by shares (T,) of the way between them."""
    position, rotation = np.empty((len(share), 3)), np.empty((len(share), 3, 3))
    for k, (one, other, part) in enumerate(zip(first, second, share.tolist(), strict=True)):
        position[k] = one.translation + part * (other.translation - one.translation)
        rotation[k] = pin.exp3(part * pin.log3(other.rotation @ one.rotation.T)) @ one.rotation
    return position, rotation
