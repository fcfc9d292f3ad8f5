"""What each foot is to carry, so that all of them together give a wanted zero-moment point and force."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sot.gravity import GRAVITY
from sot.motion.feet.contacts import phase_at
from sot.motion.feet.footfalls import Footfalls
from sot.motion.trajectory import Motion
from sot.polygon import Polygon

Array = np.ndarray

COP_INSET_RATIO = 0.1
"""Share of a sole's half width by which centres of pressure keep off its edges."""
MIN_STANDING_SHARE = 0.08
"""Least share of the load of a foot that stands for good: one that does not press slips."""
LOAD_RAMP_TIME = 0.35
"""Time within which a foot gives its load away before it leaves the floor, and takes it after it has come down [s], of
√(l / g)."""


@dataclass(frozen=True, slots=True)
class FootLoad:
    """What a foot carries, in the axes of its frame and about its origin: force and moment of sole on foot.

    Attributes:
        force: (3,) [N].
        moment: (3,) [N m].
    """

    force: Array
    moment: Array


class LoadSharing:
    """Shares of the feet that stand in a motion.

    Two feet share by how near the zero-moment point is to the middle of either sole; a foot that is about to leave, or
    has just come down, carries what its ramp admits. Each centre of pressure stays on its sole.

    Args:
        motion: says which feet stand where, and when.
    """

    def __init__(self, motion: Motion) -> None:
        robot = motion.robot
        self._phases, self._ramp = motion.phases, load_ramp(motion)
        self._stances = {foot: Footfalls(motion.phases, foot) for foot in robot.feet}
        self._begin, self._end = motion.phases[0].start, motion.phases[-1].end
        self.middles = {foot: _middle(robot.sole(foot)) for foot in robot.feet}
        """Middle of each foot's sole (3,) in its frame [m]."""
        self._soles = {foot: _without_rim(robot.sole(foot)[:, :2]) for foot in robot.feet}
        self._time = float("nan")

    def feet(self, t: float) -> Mapping[str, pin.SE3]:
        """Feet that stand at a time [s], and where the plan has their frames."""
        self._update(t)
        return self._feet

    def limits(self, t: float) -> dict[str, float]:
        """Largest share of the load that each standing foot may carry at a time [s]."""
        self._update(t)
        return self._limits

    def _update(self, t: float) -> None:
        """Find what depends on time alone, once a tick."""
        if t != self._time:
            self._time = t
            self._feet, self._limits = self._stances_at(t)
            self._middles_now = {foot: pose.act(self.middles[foot])[:2] for foot, pose in self._feet.items()}

    def _stances_at(self, t: float) -> tuple[Mapping[str, pin.SE3], dict[str, float]]:
        """Feet that stand at a time [s] with their places, and the largest share of the load of each."""
        feet = phase_at(self._phases, t).feet
        return feet, self._ramps(t, feet)

    def _ramps(self, t: float, feet: Mapping[str, pin.SE3]) -> dict[str, float]:
        shares = {}
        for foot in feet:
            stance = self._stances[foot].nearest_stance(t)
            assert stance is not None  # it stands
            since = t - stance.start if stance.start > self._begin else np.inf
            left = stance.end - t if stance.end < self._end else np.inf
            shares[foot] = _smooth_ramp(min(since / self._ramp, left / self._ramp, 1.0))
        return shares

    def __call__(self, t: float, zmp: Array, force: Array) -> dict[str, FootLoad]:
        """Loads of the standing feet at a time [s] for a zero-moment point (2,) [m] and a force (3,) [N], world."""
        feet = self.feet(t)
        middles = self._middles_now
        shares = self._shares(t, zmp, middles)
        rest = zmp - sum((shares[foot] * middles[foot] for foot in feet), np.zeros(2))
        loads = {}
        for foot, pose in feet.items():
            off = pose.rotation.T[:2, :2] @ rest  # feet are level, or nearly so
            x, y = self._soles[foot].nearest_point(self.middles[foot][:2] + off)
            own = shares[foot] * (pose.rotation.T @ force)
            loads[foot] = FootLoad(own, np.array([y * own[2], -x * own[2], x * own[1] - y * own[0]]))
        return loads

    def _shares(self, t: float, zmp: Array, middles: Mapping[str, Array]) -> dict[str, float]:
        if len(middles) < 2:
            return dict.fromkeys(middles, 1.0)
        (first, a), (second, b) = middles.items()
        limits = self.limits(t)
        along = float((zmp - a) @ (b - a) / max((b - a) @ (b - a), 1e-9))
        x = min(max(along, MIN_STANDING_SHARE), 1.0 - MIN_STANDING_SHARE)
        if limits[first] + limits[second] < 1.0:  # both come or go: as their ramps are
            x = limits[second] / max(limits[first] + limits[second], 1e-9)
        else:
            x = min(max(x, 1.0 - limits[first]), limits[second])
        return {first: 1.0 - x, second: x}


class ContactLoadSharing(LoadSharing):
    """Shares of the feet whose contacts stand now, wherever steps have led them.

    Args:
        motion: of the robot.
        contacts: foot -> place of its frame and load (0 to 1) of its contact, of those that stand.
    """

    def __init__(self, motion: Motion, contacts: Callable[[], Mapping[str, tuple[pin.SE3, float]]]) -> None:
        super().__init__(motion)
        self._contacts = contacts

    def _stances_at(self, t: float) -> tuple[Mapping[str, pin.SE3], dict[str, float]]:
        contacts = self._contacts()
        feet = {foot: place for foot, (place, _) in contacts.items()}
        return feet, {foot: _smooth_ramp(load) for foot, (_, load) in contacts.items()}


def load_ramp(motion: Motion) -> float:
    """Time within which a foot gives its load away, or takes it [s]."""
    return LOAD_RAMP_TIME * float(np.sqrt(motion.com[0, 2] / GRAVITY))


def _smooth_ramp(x: float) -> float:
    return 3.0 * x**2 - 2.0 * x**3 if x > 0.0 else 0.0


def _middle(corners: Array) -> Array:
    """Middle (3,) of a sole (n, 3) that lies in the plane z = 0 of its frame."""
    return np.append(0.5 * (corners.min(axis=0) + corners.max(axis=0))[:2], 0.0)


def _without_rim(corners: Array) -> Polygon:
    """A sole (n, 2) without its rim, in the foot frame."""
    half = 0.5 * float(np.min(corners.max(axis=0) - corners.min(axis=0)))
    return Polygon.hull(corners).inset(COP_INSET_RATIO * half)
