"""The smallest contact forces, or those nearest to what contacts wish for, that the levels above leave open."""

import numpy as np

from solvers.rows import Rows
from sot.control.task import Task
from sot.control.tick import Mode, Tick


class LeastForces(Task):
    """All force variables towards zero: of the ways to share the load between vertices, the most even one.

    A contact that wishes for a normal force, as a hand that squeezes does, gets the nearest that is open. One that is
    in reserve, as a hand on a table is, carries less by as much.

    Meant for the last level, which it makes strictly convex: everything above leaves the internal forces free.

    Args:
        weight: Scale within the level [1/N].
    """

    variable = "force"

    def __init__(self, weight: float = 0.01, name: str = "LeastForces") -> None:
        super().__init__(name, "N", "N", weight)
        self._A, self._nothing = np.eye(0), np.zeros(0)
        self._asked: list[tuple[float, float, Mode]] = []  # by the contacts last
        self._reserves: list[float] = []  # of the force variables
        self._wishes = np.zeros(0)

    def rows(self, tick: Tick) -> Rows:
        """Rows ``φ = φ_wished``, zero where no contact wishes for any."""
        count, wish, reserve = 0, False, False
        for contact in tick.contacts:
            count += contact.force_count
            wish = wish or contact.wish > 0.0
            reserve = reserve or contact.reserve != 1.0
        reserves = [c.reserve for c in tick.contacts for _ in range(c.force_count)] if reserve else []
        if count != len(self._A) or reserves != self._reserves:
            self._A, self._nothing, self._reserves = (
                np.diag(reserves) if reserve else np.eye(count),
                np.zeros(count),
                reserves,
            )
            self.selects = None if reserve else slice(0, count)
        wanted = self._nothing
        if wish:
            asked = [(contact.wish, contact.load, contact.mode) for contact in tick.contacts]
            if asked != self._asked:
                self._asked, self._wishes = asked, np.concatenate([contact.wishes() for contact in tick.contacts])
            wanted = self._wishes * reserves if reserve else self._wishes
        return self.make_rows(self._A, wanted, wanted)
