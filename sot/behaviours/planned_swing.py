"""The path of a swinging foot between two planned footholds, and the same path led elsewhere."""

import numpy as np

from sot.behaviours.stride import lowered_pose, quintic_to_rest, raised_pose, value_and_derivatives
from sot.control.pose import Pose, PoseReference
from sot.motion.feet.footfalls import Footfalls, Stance

Array = np.ndarray


class PlannedSwing:
    """Path of a foot in a motion, for the times in which its contact is off: ``t -> Pose``.

    Where the motion has the foot on the floor by then, it is lowered at a steady speed.

    Args:
        stances: Of the foot.
        path: Of the foot in the motion.
    """

    def __init__(self, stances: Footfalls, path: PoseReference) -> None:
        self._stances, self._path = stances, path
        # Half a millimetre by which a fitted path ends above the floor makes a foot late by tens of milliseconds.
        heights = [(stance.start, float(stance.pose.translation[2])) for stance in stances.stances]
        self._landing_heights_missing = {start: height - float(path(start).position[2]) for start, height in heights}

    def ends(self, t: float) -> tuple[Stance | None, Stance | None]:
        """The stances between which the swing is that a time [s] is in or follows, none where there is none."""
        return self._stances.stances_around(t)

    def __call__(self, t: float) -> Pose:
        """Pose of the foot at a time [s]."""
        pose = self._path(t)
        before, after = self.ends(t)
        if before is None or after is None:
            return pose
        late, span = t - after.start, after.start - before.end
        return lowered_pose(raised_pose(pose, self._landing_heights_missing[after.start], span + late, span), late)


class LedSwing:
    """A planned swing from another place, to another place: ``t -> Pose``.

    What it is off the plan by goes by quintic polynomials, from what it is when the foot is led elsewhere.

    Args:
        planned: The swing.
        t: From when on it is led [s].
        land: When the foot lands by the plan [s].
        off: What the foot is off its planned place by then (2,) [m].
    """

    def __init__(self, planned: PoseReference, t: float, land: float, off: Array) -> None:
        self._planned, self.land = planned, land
        self._from, self._coefficients = t, np.zeros((6, 2))
        self._coefficients[0] = self.landing_off = off.copy()

    def redirect(self, t: float, off: Array) -> None:
        """Let the foot land off its planned place by another way (2,) [m], from a time on [s]."""
        if t < self.land:
            now = value_and_derivatives(self._coefficients, t - self._from)
            self._coefficients = quintic_to_rest(*now, off, self.land - t)
            self._from, self.landing_off = t, off.copy()

    def __call__(self, t: float) -> Pose:
        """Pose of the foot at a time [s]."""
        pose = self._planned(t)
        off, rate, second = value_and_derivatives(self._coefficients, min(max(t, self._from), self.land) - self._from)
        position, velocity, acceleration = pose.position.copy(), pose.velocity.copy(), pose.acceleration.copy()
        position[:2] += off
        velocity[:2] += rate
        acceleration[:2] += second
        return Pose(position, pose.rotation, velocity, acceleration)
