"""Parts of the robot that keep away from one another and from things."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from solvers.rows import Rows
from sot.acceleration_bounds import AccelerationBounds
from sot.control.task import Task
from sot.control.tick import Tick
from sot.proximity import Proximity
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.system import System

Array = np.ndarray

LOOK_PERIOD = 0.005
"""Interval at which all pairs of shapes are looked through for those to watch [s]."""
MAX_SKIPPED_LOOKS = 10.0
"""Bound of the number of looks that a distant pair is left out of."""
SPEED_CHANGE_BOUND = 0.25
"""Bound of the change of a pair's approach speed from one look to the next [m/s]."""
WATCH_DISTANCE_BOUND = 0.1
"""Bound of the stopping distance that is reckoned with [m]: a pair further apart than this is not watched, and what
approaches too fast for it is stopped harder."""
WATCH_DECELERATION = 10.0
"""Deceleration [m/s²] with which the distance at which a pair has to be watched is computed. It is less than the one
relied upon, since some joints have little leverage on a distance."""
RELIED_DECELERATION = 25.0
"""Deceleration that is relied upon to stop an approach, if the joints give as much [m/s²]. Feet are planned to stop
beside one another at up to 20 m/s², hands likewise: what relies on less brakes motions that are in order. An approach
that is too fast for it is stopped as much harder as it takes, steadily."""

MIN_DISTANCE_LEGS = 0.0166
"""Distance that is kept [leg lengths]: half of what plans keep, which keeps the two from contradicting each other."""
REST_DISTANCE_SHARE = 0.5
"""Share of its distance at rest that a pair keeps at most."""


class SelfCollision(Task):
    """Distances between the robot's limbs and the rest of it, and of both with things, as bounds on their acceleration.

    A distance d moves as ``d̈ = J v̇ + J̇ v``; like a joint with a range it may come to its least value, but only so
    fast that it can still be stopped there, and shapes that are too near from the start are led apart (see
    `AccelerationBounds`). No more is asked for than what the joints give at the accelerations that are relied upon.

    Bodies that a contact of the stack is to bring together, whatever its mode, are not kept apart; nor are things from
    one another, of which none is carried: nobody could.

    Args:
        robot: The robot, or the system of it and things, which then keep away from it and from one another as well.
        min_distance: Distance that is kept [m], less by pairs that are nearly as near at rest; MIN_DISTANCE_LEGS by
            default.
        weight: Scale of its rows within its level.

    Attributes:
        pairs: Names of the shapes of the pairs that are kept apart.
        min_distances: Distances that they are kept at [m].
    """

    equality = False
    gives_way = 1

    def __init__(self, robot: Robot | System, min_distance: float | None = None, weight: float = 0.1) -> None:
        super().__init__("SelfCollision", "m/s²", "m", weight)
        self._system = system = System.of(robot)
        self._acceleration = system.robot.acceleration
        self._proximity, self._data_ahead = Proximity(system), system.model.createData()
        min_distance = MIN_DISTANCE_LEGS * leg_length(system.robot) if min_distance is None else min_distance
        self.min_distances = np.minimum(min_distance, REST_DISTANCE_SHARE * self._proximity.rest_distances)
        self._among: list[object] | None = None  # contacts and carried things for which the next is worked out
        self._alone = np.zeros(len(self.min_distances), dtype=bool)
        self.pairs = self._proximity.pairs
        self._watched: list[int] = []
        self._last_look = -np.inf
        self._unwatched_until = np.full(len(self.pairs), -np.inf)  # times until which pairs may be left alone
        self._allocate_rows(0, system.nv)

    def distances_and_rates(self, tick: Tick, pairs: Sequence[int]) -> tuple[Array, Array, Array, Array]:
        """Distances d of n pairs (n,), their rates (n,), J (n, nv) and J̇ v (n,)."""
        model, proximity = self._system.model, self._proximity
        q, v = tick.q[: model.nq], tick.v[: model.nv]
        distances, J = proximity.distances_and_jacobian(tick.data, pairs)
        rates = J @ v
        # What the rates become after a period without acceleration: they depend on how the shapes are curved.
        pin.computeJointJacobians(model, self._data_ahead, pin.integrate(model, q, tick.period * v))
        _, ahead = proximity.distances_and_jacobian(self._data_ahead, pairs)
        return distances, rates, J, (ahead @ v - rates) / tick.period

    def rows(self, tick: Tick) -> Rows:
        """Rows ``d̈ >= d̈_min`` of the pairs that are near and approach; `error` is how much too near each of
        them is.

        There are as many as were ever needed at once, the spare ones empty: a level that keeps its size is set up once.
        """
        if not 0.0 < tick.t - self._last_look < LOOK_PERIOD - TIME_TOLERANCE:
            self._watched, self._last_look = self._pairs_to_watch(tick), tick.t
        near, count = self._watched, len(self._watched)
        if count > len(self._unbounded_below):
            self._allocate_rows(count, self._system.nv)
        if not near:
            self.error, self.labels = _NO_ERROR, ()
            return self.make_rows(self._zero_rows, self._unbounded_below, self._unbounded_above)
        A, lower = self._zero_rows.copy(), self._unbounded_below.copy()
        distances, rates, J, drift = self.distances_and_rates(tick, near)
        # What the joints give at the accelerations that are relied upon.
        achievable = np.abs(J[:, 6 : 6 + len(self._acceleration)]) @ self._acceleration
        # What is carried, and the trunk before a thing, is moved by joints that are not between the two shapes.
        achievable[np.array(near) >= self._proximity.own_pairs] += RELIED_DECELERATION
        kept = self.min_distances[near]
        brakes = _braking_decelerations(distances - kept, rates, tick.period, achievable)
        unlimited = self._unbounded_above[:count]
        bounds = AccelerationBounds(kept, unlimited, unlimited, brakes, unlimited)
        wanted = bounds(distances, rates, tick.period)[0] - drift
        A[:count], lower[:count] = J, np.minimum(wanted, achievable)
        self.error = np.maximum(kept - distances, 0.0)
        self.labels = [" and ".join(self.pairs[k]) for k in near]
        return self.make_rows(A, lower, self._unbounded_above)

    def _allocate_rows(self, pairs: int, nv: int) -> None:
        """For the rows of some pairs; those of none are read-only, so that nobody writes them twice."""
        self._zero_rows, self._unbounded_below, self._unbounded_above = (
            np.zeros((pairs, nv)),
            np.full(pairs, -np.inf),
            np.full(pairs, np.inf),
        )
        for same in (self._zero_rows, self._unbounded_below, self._unbounded_above):
            same.flags.writeable = False

    def _pairs_to_watch(self, tick: Tick) -> list[int]:
        """Pairs whose approach may have to be braked before the next look."""
        if tick.t < self._last_look:
            self._unwatched_until[:] = -np.inf  # another run
        proximity, v, period, kept = self._proximity, tick.v[: self._system.nv], tick.period, self.min_distances
        within = _watch_distances(
            proximity.rate_bounds(v), period, kept, self._unwatched_until - TIME_TOLERANCE, tick.t
        )
        if self._system.things:
            within[self._left_alone(tick)] = -np.inf
        near = proximity.pairs_within(tick.data, tick.q, within)
        if not near:
            return near
        distances, J = proximity.latest_distances_and_jacobian(tick.data, near)
        looks = _skippable_looks(distances, J @ v, period, kept[near])
        self._unwatched_until[near] = tick.t + LOOK_PERIOD * looks
        return [k for k, later in zip(near, looks.tolist(), strict=True) if not later]

    def _left_alone(self, tick: Tick) -> Array:
        """Whether each pair is one that a contact is to bring together, or without the robot and what it carries."""
        now = [*tick.contacts, *tick.carried]
        if self._among != now:
            body_of, moved = self._system.body_of, {"robot", *tick.carried}
            meeting = [frozenset((body_of(contact.surface), body_of(contact.on))) for contact in tick.contacts]
            pairs = zip(self._proximity.bodies, self._proximity.owners, strict=True)
            self._among, self._alone = now, np.array([own in meeting or not whose & moved for own, whose in pairs])
        return self._alone


@compiled
def _braking_decelerations(gaps: Array, rates: Array, period: float, achievable: Array) -> Array:
    """Decelerations [m/s²] that stop pairs within the gaps that they have left.

    They are RELIED_DECELERATION at least, and no more than the joints can give. To lead a pair that is too fast for
    RELIED_DECELERATION back to where that would do takes an arm's whole torque for some ticks.
    """
    brakes = np.minimum(RELIED_DECELERATION, achievable)
    for k in range(len(gaps)):
        speed = -rates[k]
        left = 2.0 * gaps[k] - period * speed
        if speed > 0.0 and left > 0.0:
            brakes[k] = min(max(RELIED_DECELERATION, speed**2 / left), achievable[k])
    return brakes


@compiled
def _stopping_distance(speed: float, period: float, looks: float) -> float:
    """Distance [m] on which an approach at a speed [m/s] is stopped if it is watched only after some looks."""
    speed = speed + looks * SPEED_CHANGE_BOUND
    return min(speed * (speed / (2.0 * WATCH_DECELERATION) + period + looks * LOOK_PERIOD), WATCH_DISTANCE_BOUND)


@compiled
def _watch_distances(speeds: Array, period: float, kept: Array, unwatched_until: Array, t: float) -> Array:
    """Distances [m] below which pairs that approach at these speeds at most need a closer look."""
    within = np.full(len(speeds), -np.inf)
    for k in range(len(speeds)):
        if unwatched_until[k] <= t:
            within[k] = kept[k] + _stopping_distance(speeds[k], period, 1.0)
    return within


@compiled
def _skippable_looks(distances: Array, rates: Array, period: float, kept: Array) -> Array:
    """Number of looks that each pair may be left out of.

    Even if it has sped up by then, at each look by the bound, it is far enough apart to be stopped.
    """
    looks = np.zeros(len(distances))
    for k in range(len(looks)):
        speed = max(-rates[k], 0.0)
        while looks[k] < MAX_SKIPPED_LOOKS and distances[k] >= kept[k] + _stopping_distance(
            speed, period, looks[k] + 1.0
        ):
            looks[k] += 1.0
    return looks


TIME_TOLERANCE = 1e-9  # s: rounding of times
_NO_ERROR = np.zeros(0)
