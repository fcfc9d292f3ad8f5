"""What each foot is to carry, so that all of them together give a wanted zero-moment point and force."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sot.motion.feet.contacts import Phase
from sot.motion.trajectory import Motion
from sot.polygon import Polygon

Array = np.ndarray

COP_INSET_RATIO = 0.1
"""Share of a sole's half width by which centres of pressure keep off its edges."""
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
        self._phases, self._starts = motion.phases, np.array([phase.start for phase in motion.phases])
        gravity = float(np.linalg.norm(robot.model.gravity.linear))
        self._ramp = LOAD_RAMP_TIME * float(np.sqrt(motion.com[0, 2] / gravity))
        soles = {foot: robot.sole(foot)[:, :2] for foot in robot.feet}
        self.middles = {foot: 0.5 * (sole.min(axis=0) + sole.max(axis=0)) for foot, sole in soles.items()}
        self._middles = {foot: np.append(middle, 0.0) for foot, middle in self.middles.items()}
        self._soles = {foot: _without_rim(sole) for foot, sole in soles.items()}

    def feet(self, t: float) -> Mapping[str, pin.SE3]:
        """Feet that stand at a time [s], and where the plan has their frames."""
        return self._phases[self._phase(t)].feet

    def limits(self, t: float) -> dict[str, float]:
        """Largest share of the load that each standing foot may carry at a time [s]."""
        k = self._phase(t)
        shares = {}
        for foot in self._phases[k].feet:
            x = min((t - self._stands_since(k, foot)) / self._ramp, (self._stands_until(k, foot) - t) / self._ramp, 1.0)
            shares[foot] = 3.0 * x**2 - 2.0 * x**3 if x > 0.0 else 0.0
        return shares

    def __call__(self, t: float, zmp: Array, force: Array) -> dict[str, FootLoad]:
        """Loads of the standing feet at a time [s] for a zero-moment point (2,) [m] and a force (3,) [N], world."""
        feet = self.feet(t)
        middles = {foot: pose.act(self._middles[foot])[:2] for foot, pose in feet.items()}
        shares = self._shares(t, zmp, middles)
        rest = zmp - sum((shares[foot] * middles[foot] for foot in feet), np.zeros(2))
        loads = {}
        for foot, pose in feet.items():
            off = pose.rotation.T[:2, :2] @ rest  # feet are level, or nearly so
            x, y = self._soles[foot].nearest_point(self.middles[foot] + off)
            own = shares[foot] * (pose.rotation.T @ force)
            loads[foot] = FootLoad(own, np.array([y * own[2], -x * own[2], x * own[1] - y * own[0]]))
        return loads

    def _shares(self, t: float, zmp: Array, middles: Mapping[str, Array]) -> dict[str, float]:
        if len(middles) < 2:
            return dict.fromkeys(middles, 1.0)
        (first, a), (second, b) = middles.items()
        limits = self.limits(t)
        x = float(np.clip((zmp - a) @ (b - a) / max((b - a) @ (b - a), 1e-9), 0.0, 1.0))
        if limits[first] + limits[second] < 1.0:  # both come or go: as their ramps are
            x = limits[second] / max(limits[first] + limits[second], 1e-9)
        else:
            x = min(max(x, 1.0 - limits[first]), limits[second])
        return {first: 1.0 - x, second: x}

    def _phase(self, t: float) -> int:
        return min(max(int(np.searchsorted(self._starts, t, side="right")) - 1, 0), len(self._phases) - 1)

    def _stands_since(self, k: int, foot: str) -> float:
        phases: list[Phase] = list(self._phases)
        while k >= 0 and foot in phases[k].feet:
            k -= 1
        return phases[k].end if k >= 0 else -np.inf

    def _stands_until(self, k: int, foot: str) -> float:
        while k < len(self._phases) and foot in self._phases[k].feet:
            k += 1
        return self._phases[k].start if k < len(self._phases) else np.inf


def _without_rim(corners: Array) -> Polygon:
    """A sole (n, 2) without its rim, in the foot frame."""
    half = 0.5 * float(np.min(corners.max(axis=0) - corners.min(axis=0)))
    return Polygon.hull(corners).inset(COP_INSET_RATIO * half)
