"""The footfalls of one foot: when and where it stands, one stance after the other."""

from bisect import bisect_right
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import pinocchio as pin

from sot.motion.feet.contacts import Phase
from sot.robots.surface import Surface


@dataclass(frozen=True)
class Stance:
    """A stance of one foot.

    Attributes:
        start, end: in motion time [s].
        pose: of the foot's frame.
        surface: of the world under it, if the phases say so.
        rises: when its heel begins to rise [s]; None if it stays flat.
    """

    start: float
    end: float
    pose: pin.SE3
    surface: Surface | None = None
    rises: float | None = None


class Footfalls:
    """The stances of a foot over a motion, in order of time, each at a place of its own.

    Args:
        phases: of the motion.
        foot: whose.
    """

    def __init__(self, phases: Sequence[Phase], foot: str) -> None:
        stances: list[Stance] = []
        for phase in phases:
            if foot not in phase.feet:
                continue
            pose, surface = phase.feet[foot], phase.surfaces.get(foot)
            rises = phase.start if foot in phase.rising else None
            if stances and stances[-1].end >= phase.start - 1e-9:
                before = stances[-1]
                rises = before.rises if before.rises is not None else rises
                stances[-1] = Stance(before.start, phase.end, pose, surface, rises)
            else:
                stances.append(Stance(phase.start, phase.end, pose, surface, rises))
        self._set_stances(stances)

    def _set_stances(self, stances: Sequence[Stance]) -> None:
        self.stances = tuple(stances)
        self._starts = [stance.start for stance in stances]

    def with_step(self, lift: float, land: float, pose: pin.SE3) -> "Footfalls":
        """With the stance at `lift` in two: between, until `land`, the foot is in the air, and then at another pose."""
        at = self.count_begun(lift) - 1
        stance = self.stances[at]
        parts = replace(stance, end=lift, rises=None), replace(stance, start=land, end=max(stance.end, land), pose=pose)
        changed = copy(self)
        changed._set_stances((*self.stances[:at], *parts, *self.stances[at + 1 :]))
        return changed

    def with_landing(self, index: int, start: float) -> "Footfalls":
        """With a stance that begins at another time [s]."""
        changed = copy(self)
        earlier = replace(self.stances[index], start=start)
        changed._set_stances((*self.stances[:index], earlier, *self.stances[index + 1 :]))
        return changed

    def __len__(self) -> int:
        return len(self.stances)

    def __getitem__(self, index: int) -> Stance:
        return self.stances[index]

    def count_begun(self, t: float) -> int:
        """How many stances have begun by a time [s]."""
        return bisect_right(self._starts, t + 1e-9)

    def stances_around(self, t: float) -> tuple[Stance | None, Stance | None]:
        """The stances before and after the swing that a time [s] is in or follows, none where there is none."""
        index = self.count_begun(t)
        swings = index < len(self) and (not index or t >= self.stances[index - 1].end - 1e-9)
        after = index if swings else index - 1
        return (self.stances[after - 1] if after > 0 else None), (self.stances[after] if after >= 0 else None)

    def nearest_stance(self, t: float) -> Stance | None:
        """The stance at a time [s], or the one nearest in time to it; none if the foot never stands."""
        if not self.stances:
            return None
        index = self.count_begun(t)
        before, after = self.stances[max(index - 1, 0)], self.stances[min(index, len(self) - 1)]
        return after if after.start - t < t - before.end else before
