"""Parts of the robot that keep away from one another."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from solvers.rows import Rows
from sot.control.task import Task
from sot.control.tick import Tick
from sot.proximity import Proximity
from sot.robots.robot import Robot
from tasks.bounds import AccelerationBounds

Array = np.ndarray

LOOK = 0.005
"""Pairs of shapes are looked through for those to watch at these intervals [s]."""
LONGEST = 10.0
"""Looks for which a pair is left alone at most."""
SURPRISE = 0.25
"""How much faster a pair may approach from look to look [m/s]."""
FAR = 0.1
"""Pairs this much further apart than they may come [m] are not watched: what is too fast for it is stopped harder."""
EASY = 10.0
"""Deceleration that pairs are watched for [m/s²]: some joints have little leverage on a distance."""
BRAKE = 25.0
"""Deceleration that is relied upon to stop an approach, if the joints give as much [m/s²]. Feet are planned to stop
beside one another at up to 20 m/s², hands likewise: what relies on less brakes motions that are in order. An approach
that is too fast for it is stopped as much harder as it takes, steadily."""


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
        self._watched: list[int] = []
        self._looked = -np.inf
        self._calm = np.full(len(self.pairs), -np.inf)  # times until which pairs may be left alone
        self._make_room(0, robot.nv)

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
        near, count = self._watched, len(self._watched)
        if count > len(self._free):
            self._make_room(count, len(tick.v))
        if not near:
            self.error, self.labels = _NONE, ()
            return self.make_rows(self._empty, self._free, self._upper)
        A, lower = self._empty.copy(), self._free.copy()
        distances, rates, J, drift = self.observe(tick, near)
        # What the joints give at the accelerations that are relied upon.
        most = np.abs(J[:, 6:]) @ self._acceleration
        brakes = _brakes(distances - self._least, rates, tick.period, most)
        unlimited = self._upper[:count]
        bounds = AccelerationBounds(np.full(count, self._least), unlimited, unlimited, brakes, unlimited)
        wanted = bounds(distances, rates, tick.period)[0] - drift
        A[:count], lower[:count] = J, np.minimum(wanted, most)
        self.error = np.maximum(self._least - distances, 0.0)
        self.labels = [" and ".join(self.pairs[k]) for k in near]
        return self.make_rows(A, lower, self._upper)

    def _make_room(self, pairs: int, nv: int) -> None:
        """For the rows of some pairs; those of none are read-only, so that nobody writes them twice."""
        self._empty, self._free, self._upper = np.zeros((pairs, nv)), np.full(pairs, -np.inf), np.full(pairs, np.inf)
        for same in (self._empty, self._free, self._upper):
            same.flags.writeable = False

    def _look(self, tick: Tick) -> list[int]:
        """Pairs whose approach may have to be braked before the next look."""
        if tick.t < self._looked:
            self._calm[:] = -np.inf  # another run
        proximity, v, period, least = self._proximity, tick.v, tick.period, self._least
        within = _within(proximity.fastest(v), period, least, self._calm - TIMING, tick.t)
        near = proximity.near(tick.data, tick.q, within)
        if not near:
            return near
        distances, J = proximity.found(tick.data, near)
        looks = _left_alone(distances, J @ v, period, least)
        self._calm[near] = tick.t + LOOK * looks
        return [k for k, later in zip(near, looks.tolist(), strict=True) if not later]


@compiled
def _brakes(ways: Array, rates: Array, period: float, most: Array) -> Array:
    """Decelerations [m/s²] that stop pairs on the way that they have left: BRAKE at least, at most what joints give.

    To lead a pair that is too fast for BRAKE back to where BRAKE would do takes an arm's whole torque for some ticks.
    """
    brakes = np.minimum(BRAKE, most)
    for k in range(len(ways)):
        speed = -rates[k]
        left = 2.0 * ways[k] - period * speed
        if speed > 0.0 and left > 0.0:
            brakes[k] = min(max(BRAKE, speed**2 / left), most[k])
    return brakes


@compiled
def _stopping(speed: float, period: float, looks: float) -> float:
    """Way on which an approach at a speed [m/s] is stopped if it is watched from so many looks on [m]."""
    speed = speed + looks * SURPRISE
    return min(speed * (speed / (2.0 * EASY) + period + looks * LOOK), FAR)


@compiled
def _within(speeds: Array, period: float, least: float, calm: Array, t: float) -> Array:
    """Distances [m] below which pairs that approach at these speeds at most need a closer look."""
    within = np.full(len(speeds), -np.inf)
    for k in range(len(speeds)):
        if calm[k] <= t:
            within[k] = least + _stopping(speeds[k], period, 1.0)
    return within


@compiled
def _left_alone(distances: Array, rates: Array, period: float, least: float) -> Array:
    """For how many looks pairs may be left alone: even if they then have sped up, each time by as much as is allowed
    for, they are far enough apart to be stopped."""
    looks = np.zeros(len(distances))
    for k in range(len(looks)):
        speed = max(-rates[k], 0.0)
        while looks[k] < LONGEST and distances[k] >= least + _stopping(speed, period, looks[k] + 1.0):
            looks[k] += 1.0
    return looks


TIMING = 1e-9  # s: rounding of times
_NONE = np.zeros(0)
