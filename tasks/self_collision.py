"""Parts of the robot that keep away from one another."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from solvers.rows import Rows
from sot.proximity import Proximity
from sot.robot import Robot
from sot.task import Task
from sot.tick import Tick
from tasks.bounds import AccelerationBounds

Array = np.ndarray

LOOK = 0.005
"""Pairs of shapes are looked through for those to watch at these intervals [s]."""
SURPRISE = 0.25
"""How much faster than now a pair may approach by the next look [m/s]."""
FAR = 0.1
"""Pairs this much further apart than they may come [m] are not watched: what is too fast for it is stopped harder."""
BRAKE = 10.0
"""Deceleration that is relied upon to stop an approach [m/s²]."""


class SelfCollision(Task):
    """Distances between the robot's limbs and the rest of it as bounds on their acceleration.

    A distance d moves as ``d̈ = J v̇ + J̇ v``; like a joint with a range it may come to its least value, but only so
    fast that it can still be stopped there, and shapes that are too near from the start are led apart (see
    `AccelerationBounds`). No more is asked for than what the joints give at the accelerations that are relied upon.

    Args:
        robot: The robot.
        least: Distance that is kept [m].
        weight: Scale of its rows within its level.

    Attributes:
        pairs: Names of the shapes of the pairs that are kept apart.
    """

    equality = False
    gives_way = 1

    def __init__(self, robot: Robot, least: float = 0.01, weight: float = 0.1) -> None:
        super().__init__("SelfCollision", "m/s²", "m", weight)
        self._least, self._acceleration = least, robot.acceleration
        self._proximity, self._ahead = Proximity(robot), robot.model.createData()
        self.pairs = self._proximity.pairs
        self._bounds = self._braked(0)
        self._watched: list[int] = []
        self._looked = -np.inf
        self._A, self._lower, self._upper = np.zeros((0, robot.nv)), np.zeros(0), np.zeros(0)

    def observe(self, tick: Tick, pairs: Sequence[int]) -> tuple[Array, Array, Array, Array]:
        """Distances d of n pairs (n,), their rates (n,), J (n, nv) and J̇ v (n,)."""
        model, proximity = tick.robot.model, self._proximity
        distances, J = proximity.measure(tick.data, pairs)
        rates = J @ tick.v
        # What the rates become after a period without acceleration: they depend on how the shapes are curved.
        pin.computeJointJacobians(model, self._ahead, pin.integrate(model, tick.q, tick.period * tick.v))
        _, ahead = proximity.measure(self._ahead, pairs)
        return distances, rates, J, (ahead @ tick.v - rates) / tick.period

    def rows(self, tick: Tick) -> Rows:
        """Rows ``d̈ >= d̈_min`` of the pairs that are near and approach; `error` is how much too near each of
        them is.

        There are as many as were ever needed at once, the spare ones empty: a level that keeps its size is set up once.
        """
        if not 0.0 < tick.t - self._looked < LOOK - TIMING:
            self._watched, self._looked = self._look(tick), tick.t
        near, self.error = self._watched, _NONE
        if len(near) > len(self._lower):
            self._A, self._lower = np.zeros((len(near), len(tick.v))), np.full(len(near), -np.inf)
            self._upper, self._bounds = np.full(len(near), np.inf), self._braked(len(near))
        count = len(near)
        self._A[count:], self._lower[count:] = 0.0, -np.inf
        self.labels = [" and ".join(self.pairs[k]) for k in near]
        if near:
            distances, rates, self._A[:count], drift = self.observe(tick, near)
            self.error = np.maximum(self._least - distances, 0.0)
            wanted = self._bounds(distances, rates, tick.period)[0] - drift
            # What the joints give at the accelerations that are relied upon.
            most = np.abs(self._A[:count, 6:]) @ self._acceleration
            self._lower[:count] = np.minimum(wanted, most)
        return self._rows(self._A, self._lower, self._upper)

    def _braked(self, pairs: int) -> AccelerationBounds:
        """Bounds for some pairs, or fewer."""
        return AccelerationBounds(*(np.full(pairs, limit) for limit in (self._least, np.inf, np.inf, BRAKE, np.inf)))

    def _look(self, tick: Tick) -> list[int]:
        """Pairs whose approach may have to be braked before the next look."""
        proximity, ahead = self._proximity, tick.period + LOOK
        within = self._least + np.minimum(_stopping(proximity.fastest(tick.v), ahead), FAR)
        near = proximity.near(tick.data, tick.q, within)
        if not near:
            return near
        distances, J = proximity.found(tick.data, near)
        close = distances < self._least + _stopping(np.maximum(-(J @ tick.v), 0.0), ahead)
        return [k for k, watch in zip(near, close, strict=True) if watch]


def _stopping(speed: Array, ahead: float) -> Array:
    """Way on which approaches at some speeds [m/s] are stopped, from some time ahead [s] on [m]."""
    speed = speed + SURPRISE
    return speed * (speed / (2.0 * BRAKE) + ahead)


TIMING = 1e-9  # s: rounding of times
_NONE = np.zeros(0)
