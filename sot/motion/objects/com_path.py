"""The centre of mass among the supports as the human's is among its own, over the demonstration: Otani (33)."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from sot.motion.human.human import Human
from sot.motion.objects.human_mass import human_com
from sot.motion.objects.support import com_over_supports
from sot.polygon import Polygon

Array = NDArray[np.float64]

SMOOTHING_HZ = 2.0  # Hz: faster motion of a human's centre of mass is nothing that a support has to be given up for
SUPPORT_INSET = 0.06  # leg lengths from the edge of the support: a foot that stands carries some of the weight


@dataclass(frozen=True)
class PlacePath:
    """A place over time, (T, 2) each, sampled at a rate [Hz]: position [m], velocity and acceleration."""

    rate: float
    position: Array
    velocity: Array
    acceleration: Array

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration (2,) at a time [s], at rest beyond both ends."""
        x, last = t * self.rate, len(self.position) - 1
        k = min(max(int(x + 1e-6), 0), last)
        dt = max(x - k, 0.0) / self.rate if 0.0 < x < last else 0.0
        velocity, acceleration = self.velocity[k], self.acceleration[k]
        place = self.position[k] + dt * velocity + 0.5 * dt**2 * acceleration
        return place, velocity + dt * acceleration, acceleration


def com_path(
    human: Human,
    start: float,
    supports: Mapping[str, Array],
    corners: Iterable[Array],
    rate: float,
    leg: float,
) -> PlacePath:
    """The robot's centre of mass over some supports, wherever the human's is among the same ones.

    Args:
        human: At the rate of its frames.
        start: When its first frame is on the time line [s].
        supports: Name of each support -> the robot's support point (2,) [m]; feet and hands, as `human_support` says.
        corners: Of the robot's supports, seen from above, (n, 2) each: the place stays well inside their hull.
        rate: Of the samples [Hz].
        leg: The robot's leg length [m].
    """
    com = human.low_passed(SMOOTHING_HZ)
    centre, points = human_com(com)[:, :2], np.stack([human_support(human, name) for name in supports], axis=1)
    own, hull = np.stack(list(supports.values())), Polygon.hull(np.vstack(list(corners)))
    inside = hull.inset(min(SUPPORT_INSET * leg, 0.9 * float(hull.margin(hull.centre))))
    place = np.array([inside.nearest_point(com_over_supports(points[k], centre[k], own)) for k in range(human.count)])
    times = start + human.times
    spline = CubicSpline(times, place, bc_type="clamped")
    samples = np.arange(round(times[-1] * rate) + 1) / rate
    kept = np.clip(samples, times[0], times[-1])
    moving = ((samples > times[0]) & (samples < times[-1]))[:, None]
    return PlacePath(rate, spline(kept), moving * spline(kept, 1), moving * spline(kept, 2))


def human_support(human: Human, name: str) -> Array:
    """The support point of a human's foot or hand over time, seen from above (T, 2) [m]."""
    side, link = name.split("_", 1)
    ends = ("ankle", "toe") if link == "foot" else ("wrist", "wrist")
    middle: Array = 0.5 * (human.points[f"{side}_{ends[0]}"] + human.points[f"{side}_{ends[1]}"])[:, :2]
    return middle
