"""What a live reference stands on: where feet are and will be, and the plan of the centre of mass over them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.control.pose import Pose
from sot.live.com_preview import KNOT_PERIOD, ComPreview
from sot.motion.feet.contacts import Phase, planted_phases, support_polygon
from sot.polygon import Polygon
from sot.robots.robot import Robot

Array = NDArray[np.float64]


class Footing(Protocol):
    """Feet that stand or step, and the centre of mass over them.

    Attributes:
        start: which feet stand where at the start.
    """

    start: Phase

    def advance(
        self, t: float, period: float, wanted: Array, future: Sequence[tuple[float, Array]], height: float
    ) -> Array:
        """Go on by a period from a time on [s].

        wanted: where the centre of mass is to be now (2,) [m].
        future: how much later [s] it will be wanted how much farther (2,) [m], in order.
        height: of the centre of mass [m].

        Returns:
            Place and velocity of the centre of mass at that time, its acceleration at the period's end (3, 2).
        """
        ...

    @property
    def com(self) -> Array:
        """Place, velocity and acceleration of the centre of mass now (3, 2)."""
        ...

    @property
    def room(self) -> Polygon | None:
        """Where the zero-moment point may be at the end of the last period; None if feet that stay leave enough."""
        ...

    def poses(self, t: float) -> Mapping[str, Pose] | None:
        """Foot -> its pose at a time [s], not before the last; None if all feet stay."""
        ...

    def foothold(self, foot: str, t: float) -> Array:
        """Where a foot stands at a time; during a swing, the nearest in time (3,) [m]."""
        ...

    def phases(self, end: float) -> tuple[Phase, ...]:
        """Which feet stood where, up to a time [s]."""
        ...


class PlantedFooting:
    """Feet that stay where the rest posture puts them.

    Args:
        robot: who stands.
    """

    def __init__(self, robot: Robot) -> None:
        (self.start,) = planted_phases(robot, np.inf)
        com = pin.centerOfMass(robot.model, robot.model.createData(), robot.rest).copy()
        sole = np.ptp(robot.sole(robot.feet[0])[:, :2], axis=0)
        self._preview = ComPreview(support_polygon(robot, self.start), sole, com[:2], float(com[2]))
        self._planned_at = -np.inf

    def advance(
        self, t: float, period: float, wanted: Array, future: Sequence[tuple[float, Array]], height: float
    ) -> Array:
        """See `Footing`."""
        plan = self._preview
        if t > self._planned_at + KNOT_PERIOD - 1e-6:
            self._planned_at = t
            plan.plan(wanted, future)
        place, rate = plan.c, plan.dc
        plan.advance(period)
        return np.stack([place, rate, plan.ddc])

    @property
    def com(self) -> Array:
        """See `Footing`."""
        return np.stack([self._preview.c, self._preview.dc, self._preview.ddc])

    @property
    def room(self) -> None:
        """See `Footing`."""

    def poses(self, t: float) -> None:
        """All feet stay."""

    def foothold(self, foot: str, t: float) -> Array:
        """See `Footing`."""
        return self.start.feet[foot].translation

    def phases(self, end: float) -> tuple[Phase, ...]:
        """See `Footing`."""
        return (replace(self.start, end=end),)
