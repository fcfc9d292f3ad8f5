"""The weight matrix of resolved acceleration, Hammam (17)-(19), (29): as printed, and mended.

Resolved acceleration is one weighted inverse. In (31), ``q̈ = α + G_v (q̇_c − q̇)``, α of (32) and q̇_c of (16) are the
same inverse of two right-hand sides, so that ``y = q̈ + G_v q̇`` is that inverse of both together. What W stops is y; and
y is G_v times the rate of ``s = q + q̇ / G_v``, of where a joint comes to rest that (31) brakes from now on.

So (31) keeps limits if the weights look at s instead of q: s cannot pass a limit at which they are without bound, and q
follows s. As printed they look at q, and q̇ / G_v beyond a limit is where the joint comes to rest.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from solvers import Penalties
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.resolved.collisions import CollisionFunction, printed_collision_weights
from tasks.resolved.joint_limits import dariush_limit_weights, limit_gradient, printed_limit_weights
from tasks.resolved.pairs import Distances

Array = np.ndarray
DynamicWeight = Callable[[Tick], Array]

MENDED_LIMIT_SHARE = 0.9
"""a of (18) as mended: the share of the weights that joint limits have."""
RETURN_RATE = 5.0
"""Rate [1/s] at which what is beyond a limit, or nearer to it than its margin, is led back."""
RANGE_MARGIN = 0.005
"""Distance from the ends of a joint's range at which its weight stops growing [rad]."""
PAIR_MARGIN = 0.005
"""Distance of two shapes at which their weight stops growing [m]."""
STIFFNESS = 100.0
"""Factor of the weights at the margins for what would pass them within the next period, or has passed them."""


@dataclass(frozen=True)
class Weights:
    """What a weighting gives to the solver: W, and one-sided penalties that depend on where the answer goes."""

    matrix: Array
    penalties: Penalties | None = None


class Weighting(Protocol):
    """Anything that makes weights of a state."""

    def __call__(self, tick: Tick, distances: Distances) -> Weights: ...


def inertia_weight(tick: Tick) -> Array:
    """W_D = H, Hammam (29): acceleration energy."""
    return tick.M


def unit_weight(tick: Tick) -> Array:
    """W_D = I."""
    return np.eye(tick.robot.nv)


class DynamicOnly:
    """W = W_D: no constraints."""

    def __init__(self, dynamic: DynamicWeight) -> None:
        self._dynamic = dynamic

    def __call__(self, tick: Tick, distances: Distances) -> Weights:
        return Weights(self._dynamic(tick))


class PrintedWeighting:
    """W of Hammam (17)-(19) to the letter.

    Args:
        robot: The robot.
        dynamic: W_D.
        function: g of (25).
    """

    def __init__(self, robot: Robot, dynamic: DynamicWeight, function: CollisionFunction | None = None) -> None:
        self._robot, self._dynamic, self._function = robot, dynamic, function or CollisionFunction()

    def __call__(self, tick: Tick, distances: Distances) -> Weights:
        robot, count = self._robot, len(distances.values)
        share = 1.0 / (count + 1)
        diagonal = (1.0 - share) * printed_collision_weights(
            self._function, distances.values, distances.jacobian, tick.v
        )
        diagonal[6:] += share * printed_limit_weights(tick.q[7:], tick.v[6:], robot.lower, robot.upper)
        return Weights(self._dynamic(tick) + np.diag(diagonal))


class LimitWeighting:
    """W of Dariush (14): joint limits alone, by weights that are 1 away from them.

    Args:
        robot: The robot.
        lower, upper: Its ranges, or virtual ones, shapes (na,) [rad].
    """

    def __init__(self, robot: Robot, lower: Array, upper: Array) -> None:
        self._weight, self._lower, self._upper = np.eye(robot.nv), lower, upper

    def __call__(self, tick: Tick, distances: Distances) -> Weights:
        joints = dariush_limit_weights(tick.q[7:], tick.v[6:], self._lower, self._upper)
        self._weight.flat[6 * (len(self._weight) + 1) :: len(self._weight) + 1] = joints
        return Weights(self._weight)


class MendedWeighting:
    """The printed weights where the robot comes to rest, one-sided by the answer, along distances' normals.

    *At s.* Gradients are taken at ``q + q̇ / G_v`` and at ``d + ḋ / G_v``.

    *One-sided.* "Towards a limit" is said by the answer, not by the velocity: a joint at rest at its limit is free to
    leave it, and not free to go on.

    *Along normals.* A pair's weight is on the rate of its distance, ``|g'| n nᵀ``, instead of on each joint that
    changes it: shapes may slide along one another, and joints may make up for one another.

    *As normals turn.* ``d̈ + G_v ḋ = n y + ṅ q̇``: where ṅ q̇ brings shapes together, y has to make up for it.

    *Over whole periods.* What s would pass within the next period meets a weight that is STIFFNESS times what it is at
    the margin; what is beyond the margin is led back.

    Args:
        robot: The robot.
        dynamic: W_D.
        velocity_gain: G_v of (31) [1/s]; infinite for a solver of velocities, which stop at once.
        function: g of (25).
    """

    def __init__(
        self, robot: Robot, dynamic: DynamicWeight, velocity_gain: float, function: CollisionFunction | None = None
    ) -> None:
        self._robot, self._dynamic, self._function = robot, dynamic, function or CollisionFunction()
        self._braking_time = 1.0 / velocity_gain
        # Targets are in y's unit: G_v times a velocity, or the velocity itself.
        self._gain = velocity_gain if np.isfinite(velocity_gain) else 1.0
        self._joint_weights = np.abs(limit_gradient(robot.upper - RANGE_MARGIN, robot.lower, robot.upper))
        self._pair_weight = float(np.abs(self._function.slope(np.array(PAIR_MARGIN))))

    def __call__(self, tick: Tick, distances: Distances) -> Weights:
        robot, nv = self._robot, self._robot.nv
        q, v = tick.q[7:], tick.v[6:]
        at_rest = q + self._braking_time * v
        side = np.where(at_rest > 0.5 * (robot.lower + robot.upper), 1.0, -1.0)
        reached = np.where(side > 0.0, np.maximum(q, at_rest), np.minimum(q, at_rest))
        ends = np.where(side > 0.0, robot.upper - RANGE_MARGIN, robot.lower + RANGE_MARGIN)
        room = side * (ends - reached)
        joints = np.zeros((robot.na, nv))
        joints[np.arange(robot.na), 6 + np.arange(robot.na)] = side
        inside = np.where(room > 0.0, reached, ends)
        weights = MENDED_LIMIT_SHARE * np.abs(limit_gradient(inside, robot.lower, robot.upper))
        gaps = distances.values + self._braking_time * np.minimum(distances.jacobian @ tick.v, 0.0)
        share = (1.0 - MENDED_LIMIT_SHARE) / max(len(gaps), 1)
        pair_weights = share * np.abs(self._function.slope(np.maximum(gaps, PAIR_MARGIN)))
        stiff = np.append(MENDED_LIMIT_SHARE * self._joint_weights, np.full(len(gaps), share * self._pair_weight))
        drift = np.append(np.zeros(robot.na), np.minimum(distances.drift, 0.0) if self._braking_time else 0.0 * gaps)
        rows = np.vstack([joints, -distances.jacobian])
        penalties = Penalties(
            np.vstack([rows, rows]),
            np.append(drift, self._allowed(np.append(room, gaps - PAIR_MARGIN), drift, tick.period)),
            np.concatenate([weights, pair_weights, STIFFNESS * stiff]),
        )
        return Weights(self._dynamic(tick), penalties)

    def _allowed(self, room: Array, drift: Array, period: float) -> Array:
        """Largest y that leaves s within its room after a period, or leads it back, shape (n,)."""
        reach = period / self._gain + (0.5 * period**2 if self._braking_time else 0.0)
        allowed: Array = np.where(room > 0.0, room / reach, self._gain * RETURN_RATE * room + drift)
        return allowed
