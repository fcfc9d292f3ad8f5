"""Parts of the robot that keep away from one another and from things."""

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Rows
from sot.acceleration_bounds import max_viable_acceleration
from sot.control.task import Task
from sot.control.tick import Tick
from sot.proximity import DistanceMotion, Proximity
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

SOFT_BRAKING_LEGS = 0.0166
"""Distance [leg lengths] that braking in proportion to a slow approach takes, of pairs with a thing (see
`AccelerationBounds`). Where both hands hold a thing, joints have next to no leverage on its distance from an arm:
stopping a slow approach at once took every motor's whole torque for a tick, and the hands' squeeze with it."""

CORNER_HORIZON = 0.03
"""Time [s] within which another corner of a pair with a thing may become the nearest and is reckoned with: what braking
in proportion takes."""
CORNER_DISTANCE_LEGS = 0.0166
"""Distance [leg lengths] from the nearest point beyond which another corner, nearer than that, has a row of its own."""

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
        self._proximity = Proximity(system)
        min_distance = MIN_DISTANCE_LEGS * leg_length(system.robot) if min_distance is None else min_distance
        self.min_distances = np.minimum(min_distance, REST_DISTANCE_SHARE * self._proximity.rest_distances)
        self._among: list[object] | None = None  # contacts and carried things for which the next is worked out
        self._alone = np.zeros(len(self.min_distances), dtype=bool)
        self.pairs = self._proximity.pairs
        # What is carried, and the trunk before a thing, is moved by joints that are not between the two shapes as well.
        self._carried_by_others = np.arange(len(self.pairs)) >= self._proximity.own_pairs
        self._soft = np.where(self._carried_by_others, SOFT_BRAKING_LEGS * leg_length(system.robot), 0.0)
        self._corner_distance = CORNER_DISTANCE_LEGS * leg_length(system.robot)
        self._watched = np.zeros(0, dtype=int)
        self._watched_labels: list[str] = []
        self._last_look = -np.inf
        self._unwatched_until = np.full(len(self.pairs), -np.inf)  # times until which pairs may be left alone
        self._allocate_rows(0, system.nv)

    def motion(self, tick: Tick, pairs: Array) -> DistanceMotion:
        """How the distances of pairs of some indices (n,) move."""
        self._proximity.move_to(tick.data)
        return self._proximity.motion(pairs, tick.v[: self._system.nv], tick.period)

    def rows(self, tick: Tick) -> Rows:
        """Rows ``d̈ >= d̈_min`` of the pairs that are near and approach; `error` is how much too near each of
        them is.

        There are as many as were ever needed at once, the spare ones empty: a level that keeps its size is set up once.
        """
        if not 0.0 < tick.t - self._last_look < LOOK_PERIOD - TIME_TOLERANCE:
            self._watched, self._last_look = self._pairs_to_watch(tick), tick.t
            self._watched_labels = [" and ".join(self.pairs[k]) for k in self._watched.tolist()]
        near = self._watched
        if not len(near):
            self.error, self.labels = _NO_ERROR, ()
            return self.make_rows(self._zero_rows, self._unbounded_below, self._unbounded_above)
        motion = self.motion(tick, near)
        labels = self._watched_labels
        if len(with_things := near[self._carried_by_others[near]]):
            again, there = self._second_corners(tick, with_things)
            near = np.concatenate([near, again])
            motion = DistanceMotion(*(np.concatenate(both) for both in zip(motion, there, strict=True)))
            labels = [*labels, *(" and ".join(self.pairs[k]) + ", another corner" for k in again.tolist())]
        count = len(near)
        if count > len(self._unbounded_below):
            self._allocate_rows(count, self._system.nv)
        distances, rates, A, drifts = motion
        lower = self._unbounded_below.copy()
        if count < len(lower):
            A, jacobian = self._zero_rows.copy(), A
            A[:count] = jacobian
        self.error = _write_lower_bounds(
            *(distances, rates, A, drifts, near, self.min_distances, self._carried_by_others, self._soft),
            *(self._acceleration, tick.period, lower),
        )
        self.labels = labels
        return self.make_rows(A, lower, self._unbounded_above)

    def _second_corners(self, tick: Tick, pairs: Array) -> tuple[Array, DistanceMotion]:
        """The pairs that are nearly as near with another corner, and how the distances there move."""
        v = tick.v[: self._system.nv]
        return self._proximity.second_corners(pairs, v, tick.period, CORNER_HORIZON, self._corner_distance)

    def _allocate_rows(self, pairs: int, nv: int) -> None:
        """For the rows of some pairs; those of none are read-only, so that nobody writes them twice."""
        self._zero_rows, self._unbounded_below, self._unbounded_above = (
            np.zeros((pairs, nv)),
            np.full(pairs, -np.inf),
            np.full(pairs, np.inf),
        )
        for same in (self._zero_rows, self._unbounded_below, self._unbounded_above):
            same.flags.writeable = False

    def _pairs_to_watch(self, tick: Tick) -> Array:
        """Pairs whose approach may have to be braked before the next look."""
        if tick.t < self._last_look:
            self._unwatched_until[:] = -np.inf  # another run
            self._proximity.forget_corners()
        proximity, v, period, kept = self._proximity, tick.v[: self._system.nv], tick.period, self.min_distances
        proximity.move_to(tick.data)
        within = _watch_distances(
            proximity.rate_bounds(v), period, kept, self._soft, self._unwatched_until - TIME_TOLERANCE, tick.t
        )
        if self._system.things:
            within[self._left_alone(tick)] = -np.inf
        near = proximity.pairs_within(within)
        if not len(near):
            return near
        _, rates = proximity.jacobian_and_rates(near, v)
        looks = _skippable_looks(proximity.latest_distances[near], rates, period, kept[near], self._soft[near])
        self._unwatched_until[near] = tick.t + LOOK_PERIOD * looks
        watched: Array = near[looks == 0.0]
        return watched

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
def _write_lower_bounds(
    distances: Array,
    rates: Array,
    J: Array,
    drifts: Array,
    pairs: Array,
    kept: Array,
    carried_by_others: Array,
    soft: Array,
    acceleration: Array,
    period: float,
    lower: Array,
) -> Array:
    """Write the least J v̇ [m/s²] of pairs (n,); returns how much too near each of them is [m].

    Pairs brake at RELIED_DECELERATION at least, and no more than the joints can give. To lead a pair that is too fast
    for RELIED_DECELERATION back to where that would do takes an arm's whole torque for some ticks.

    Args:
        distances, rates, J, drifts: Of these pairs, see `DistanceMotion`.
        pairs: Their indices (n,).
        kept, carried_by_others: Distances that are kept [m], and whether joints that are not between the two shapes
            move one of them, of all pairs.
        soft: Distances that braking in proportion takes [m], of all pairs.
        acceleration: What is relied upon of the joints (na,) [rad/s²].
        period: The tick's [s].
        lower: What is written (n,).
    """
    missing = np.empty(len(pairs))
    for n in range(len(pairs)):
        gap, speed = distances[n] - kept[pairs[n]], -rates[n]
        # What the joints give at the accelerations that are relied upon.
        achievable = RELIED_DECELERATION if carried_by_others[pairs[n]] else 0.0
        for i in range(len(acceleration)):
            achievable += abs(J[n, 6 + i]) * acceleration[i]
        brake, left = min(RELIED_DECELERATION, achievable), 2.0 * gap - period * speed
        if speed > 0.0 and left > 0.0:
            brake = min(max(RELIED_DECELERATION, speed**2 / left), achievable)
        wanted = -max_viable_acceleration(gap, speed, period, brake, soft[pairs[n]]) - drifts[n]
        lower[n], missing[n] = min(wanted, achievable), max(-gap, 0.0)
    return missing


@compiled
def _stopping_distance(speed: float, period: float, looks: float, soft: float) -> float:
    """Distance [m] on which an approach at a speed [m/s] is stopped if it is watched only after some looks."""
    speed = speed + looks * SPEED_CHANGE_BOUND
    lag = np.sqrt(2.0 * soft / RELIED_DECELERATION)
    late = period + lag + looks * LOOK_PERIOD
    return min(speed * (speed / (2.0 * WATCH_DECELERATION) + late), WATCH_DISTANCE_BOUND)


@compiled
def _watch_distances(speeds: Array, period: float, kept: Array, soft: Array, unwatched_until: Array, t: float) -> Array:
    """Distances [m] below which pairs that approach at these speeds at most need a closer look."""
    within = np.full(len(speeds), -np.inf)
    for k in range(len(speeds)):
        if unwatched_until[k] <= t:
            within[k] = kept[k] + _stopping_distance(speeds[k], period, 1.0, soft[k])
    return within


@compiled
def _skippable_looks(distances: Array, rates: Array, period: float, kept: Array, soft: Array) -> Array:
    """Number of looks that each pair may be left out of.

    Even if it has sped up by then, at each look by the bound, it is far enough apart to be stopped.
    """
    looks = np.zeros(len(distances))
    for k in range(len(looks)):
        speed = max(-rates[k], 0.0)
        while looks[k] < MAX_SKIPPED_LOOKS and distances[k] >= kept[k] + _stopping_distance(
            speed, period, looks[k] + 1.0, soft[k]
        ):
            looks[k] += 1.0
    return looks


TIME_TOLERANCE = 1e-9  # s: rounding of times
_NO_ERROR = np.zeros(0)
