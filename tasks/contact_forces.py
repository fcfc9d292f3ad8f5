"""The smallest contact forces among those that the levels above leave open."""

import numpy as np

from solvers.rows import Rows
from sot.control.task import Task
from sot.control.tick import Tick


class LeastForces(Task):
    """All force variables towards zero: of the ways to share the load between vertices, the most even one.

    Meant for the last level, which it makes strictly convex: everything above leaves the internal forces free.

    Args:
        weight: Scale within the level [1/N].
    """

    variable = "force"

    def __init__(self, weight: float = 0.01, name: str = "LeastForces") -> None:
        super().__init__(name, "N", "N", weight)
        self._A, self._nothing = np.eye(0), np.zeros(0)

    def rows(self, tick: Tick) -> Rows:
        """Rows ``φ = 0``."""
        count = tick.force_count
        if count != len(self._A):
            self._A, self._nothing, self.selects = np.eye(count), np.zeros(count), slice(0, count)
        return self.make_rows(self._A, self._nothing, self._nothing)
