"""The path of a swinging foot between two planned footholds, the same path led elsewhere, and one that ends early."""

import numpy as np
import pinocchio as pin

from sot.behaviours.stride import LANDING_DEPTH, lowered_pose, quintic_to_rest, raised_pose, value_and_derivatives
from sot.control.pose import Pose, PoseReference
from sot.motion.feet.footfalls import Footfalls

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

    def __call__(self, t: float) -> Pose:
        """Pose of the foot at a time [s]."""
        pose = self._path(t)
        before, after = self._stances.stances_around(t)
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

    Attributes:
        planned: Where the plan has it land (3,) [m].
        landing_off: How far off that place it lands (2,) [m].
    """

    def __init__(self, planned: PoseReference, t: float, land: float, off: Array) -> None:
        self._planned, self.land, self.planned = planned, land, planned(land).position
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


class EarlyLanding:
    """The way of a foot from the air to the floor, on which the plan does not have it yet: ``t -> Pose``.

    Places go by quintic polynomials, and the rotation about one axis; what it turned about others ends at once.

    Args:
        t: From when on it is led [s].
        pose: Of the foot then.
        land: When it lands [s].
        planned: Pose in which the plan has it land, later.
        off: What it is to land off that place (2,) [m].

    Attributes:
        planned, landing_off: As of a `LedSwing`.
    """

    def __init__(self, t: float, pose: Pose, land: float, planned: Pose, off: Array) -> None:
        self.land, self.planned, self._rotation = land, planned.position, pose.rotation
        way = pin.log3(planned.rotation @ pose.rotation.T)
        angle = float(np.linalg.norm(way))
        self._axis = way / angle if angle > 1e-9 else np.zeros(3)
        self._angle = angle
        at, rate, second = (
            np.append(part[:3], turned)
            for part, turned in (
                (pose.position, 0.0),
                (pose.velocity, self._axis @ pose.velocity[3:]),
                (pose.acceleration, self._axis @ pose.acceleration[3:]),
            )
        )
        self._lead(t, (at, rate, second), off)

    def _lead(self, t: float, now: tuple[Array, Array, Array], off: Array) -> None:
        end = np.append(self.planned + np.append(off, -LANDING_DEPTH), self._angle)
        self._coefficients = quintic_to_rest(*now, end, self.land - t)
        self._from, self.landing_off = t, off.copy()

    def redirect(self, t: float, off: Array) -> None:
        """Let the foot land off its planned place by another way (2,) [m], from a time on [s]."""
        if t < self.land:
            self._lead(t, value_and_derivatives(self._coefficients, t - self._from), off)

    def __call__(self, t: float) -> Pose:
        """Pose of the foot at a time [s]; lower and lower once it should have landed."""
        at, rate, second = value_and_derivatives(self._coefficients, min(max(t, self._from), self.land) - self._from)
        velocity, acceleration = (np.append(part[:3], part[3] * self._axis) for part in (rate, second))
        over = Pose(at[:3], pin.exp3(at[3] * self._axis) @ self._rotation, velocity, acceleration)
        return lowered_pose(over, t - self.land)
