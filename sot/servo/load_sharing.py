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
from sot.robots.soles import front

Array = np.ndarray

COP_INSET_RATIO = 0.1
"""Share of a sole's half width by which centres of pressure keep off its edges."""
MIN_STANDING_SHARE = 0.08
"""Least share of the load of a foot that stands for good: one that does not press slips."""
NEGLIGIBLE_DISTANCE = 1e-10
"""Distance of a zero-moment point from where it is wanted that is let be [m]."""
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


@dataclass(frozen=True, slots=True)
class _Bearing:
    """What bears of a sole that stands.

    Attributes:
        middle: its middle (3,), in the foot frame [m].
        inside: where centres of pressure may be.
    """

    middle: Array
    inside: Polygon

    @classmethod
    def of(cls, sole: Array) -> "_Bearing":
        """Of a sole (n, 3) that lies flat."""
        return cls(_middle(sole), Polygon.hull(sole[:, :2]).inset(_rim(sole)))

    @classmethod
    def of_toes(cls, sole: Array) -> "_Bearing":
        """Of a sole (n, 3) whose heel rises: a strip along its front edge, two rims wide without its own ones."""
        edge, rim = sole[front(sole)], _rim(sole)
        strip = np.concatenate([edge, edge - np.array([4.0 * rim, 0.0, 0.0])])
        return cls(_middle(strip), Polygon.hull(strip[:, :2]).inset(rim))


class LoadSharing:
    """Shares of the feet that stand in a motion.

    Two feet share by how near the zero-moment point is to the middle of either sole; a foot that is about to leave, or
    has just come down, carries what its ramp admits. Each centre of pressure stays on its sole, near the
    front edge of one whose heel rises; what one foot cannot do so, the other one does if it can.

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
        self._soles = {foot: _Bearing.of(robot.sole(foot)) for foot in robot.feet}
        self._toes = {foot: _Bearing.of_toes(robot.sole(foot)) for foot in robot.feet}
        self._time = float("nan")

    def feet(self, t: float) -> Mapping[str, pin.SE3]:
        """Feet that stand at a time [s], and where the plan has their frames."""
        self._update(t)
        return self._feet

    def flat_feet(self, t: float) -> Mapping[str, pin.SE3]:
        """Those of them whose heels do not rise; all of them if no other stands."""
        self._update(t)
        flat = {foot: place for foot, place in self._feet.items() if foot not in self._rising}
        return flat or self._feet

    def limits(self, t: float) -> dict[str, float]:
        """Largest share of the load that each standing foot may carry at a time [s]."""
        self._update(t)
        return self._limits

    def _update(self, t: float) -> None:
        """Find what depends on time alone, once a tick."""
        if t != self._time:
            self._time = t
            self._feet, self._limits = self._stances_at(t)
            self._rising = phase_at(self._phases, t).rising
            self._bearing = {foot: (self._toes if foot in self._rising else self._soles)[foot] for foot in self._feet}
            self._middles_now = {foot: pose.act(self._bearing[foot].middle)[:2] for foot, pose in self._feet.items()}

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
        shares = self._shares(t, zmp, self._middles_now)
        centres = self._centres_of_pressure(zmp, shares)
        loads = {}
        for foot, pose in feet.items():
            x, y = centres[foot]
            own = shares[foot] * (pose.rotation.T @ force)
            loads[foot] = FootLoad(own, np.array([y * own[2], -x * own[2], x * own[1] - y * own[0]]))
        return loads

    def _centres_of_pressure(self, zmp: Array, shares: Mapping[str, float]) -> dict[str, Array]:
        """Where on each sole its load acts, in the foot's axes (2,) [m]: all are off their middles by as much, and some
        by more where others cannot."""
        centres = {foot: self._bearing[foot].middle[:2] for foot in shares}
        for asked in (centres, *([foot] for foot in shares)):
            at = {foot: self._feet[foot].act(np.append(centre, 0.0))[:2] for foot, centre in centres.items()}
            missing = zmp - sum((shares[foot] * place for foot, place in at.items()), np.zeros(2))
            if missing @ missing < NEGLIGIBLE_DISTANCE**2:
                break
            total = sum(shares[foot] for foot in asked)
            for foot in asked:
                off = self._feet[foot].rotation.T[:2, :2] @ missing / max(total, MIN_STANDING_SHARE)  # feet are level
                centres[foot] = self._bearing[foot].inside.nearest_point(centres[foot] + off)
        return centres

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


def _rim(sole: Array) -> float:
    """Width of a sole's rim (n, 3) [m]."""
    return COP_INSET_RATIO * 0.5 * float(np.min(np.ptp(sole[:, :2], axis=0)))
