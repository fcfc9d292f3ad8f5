"""The nearest pairs of shapes: of the robot's own, and of the robot's and its environment's."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import coal
import numpy as np
import pinocchio as pin

from sot.control.tick import Tick
from sot.proximity import Proximity
from sot.robots.robot import Robot

Array = np.ndarray

PAPER_PAIR_COUNT = 16
"""Number of pairs that the paper checks."""
CURVED_DISTANCE = 0.05
"""Distance below which it counts how the normal between two shapes turns [m]."""


@dataclass(frozen=True)
class Obstacle:
    """A shape of the environment, at rest in the world."""

    name: str
    shape: coal.CollisionGeometry
    placement: pin.SE3


@dataclass(frozen=True)
class Distances:
    """Distances of some pairs.

    Attributes:
        pairs: Names of their shapes.
        values: Negative where shapes overlap, shape (n,) [m].
        jacobian: J of the distances, Hammam (23), shape (n, nv).
        drift: J̇ q̇, what the distances accelerate without q̈ until the next tick, shape (n,) [m/s²]; 0 of pairs that
            are not near.
    """

    pairs: Sequence[tuple[str, str]]
    values: Array
    jacobian: Array
    drift: Array


class NearestPairs:
    """The nearest of all pairs of a robot's shapes that may collide, and of its arms and the obstacles.

    Hammam (23) divides by the distance, and changes its sign where shapes overlap. The normal between the shapes does
    neither.

    Args:
        robot: The robot.
        count: How many pairs are given at most.
        reach: Pairs whose shapes come to rest further apart than this are left out [m].
        braking_time: Time over a speed on which it is braked [s]: those count as nearest that come to rest so.
        obstacles: Shapes of the environment.
    """

    def __init__(
        self, robot: Robot, count: int, reach: float, braking_time: float = 0.0, obstacles: Sequence[Obstacle] = ()
    ) -> None:
        self._count, self._reach, self._braking_time = count, reach, braking_time
        self._own, self._environment = Proximity(robot), None
        if obstacles:
            self._environment = Proximity(_among_obstacles(robot, obstacles))
        self._ahead = robot.model.createData()

    def __call__(self, tick: Tick) -> Distances:
        """At a tick's configuration."""
        within = self._reach + self._braking_time * self._own.rate_bounds(tick.v)
        near = self._own.pairs_within(tick.data, tick.q, within)
        values, jacobian = self._own.latest_distances_and_jacobian(tick.data, near)
        found = [(self._own, k) for k in near]
        if self._environment is not None:
            there = self._environment
            others, other_jacobian = there.distances_and_jacobian(tick.data, range(len(there.pairs)))
            values, jacobian = np.append(values, others), np.vstack([jacobian, other_jacobian])
            found += [(there, k) for k in range(len(others))]
        gaps = values + self._braking_time * np.minimum(jacobian @ tick.v, 0.0)
        nearest = np.argsort(gaps)[: self._count]
        nearest = nearest[gaps[nearest] < self._reach]
        values, jacobian = values[nearest], jacobian[nearest]
        chosen = [found[k] for k in nearest.tolist()]
        names = [proximity.pairs[k] for proximity, k in chosen]
        return Distances(names, values, jacobian, self._drift(tick, chosen, values, jacobian))

    def _drift(self, tick: Tick, chosen: Sequence[tuple[Proximity, int]], values: Array, jacobian: Array) -> Array:
        drift = np.zeros(len(values))
        near = np.flatnonzero(values < CURVED_DISTANCE).tolist()
        if not near:
            return drift
        model = tick.robot.model
        pin.computeJointJacobians(model, self._ahead, pin.integrate(model, tick.q, tick.period * tick.v))
        for proximity in {chosen[k][0] for k in near}:
            rows = [k for k in near if chosen[k][0] is proximity]
            _, ahead = proximity.distances_and_jacobian(self._ahead, [chosen[k][1] for k in rows])
            drift[rows] = (ahead - jacobian[rows]) @ tick.v / tick.period
        return drift


def _among_obstacles(robot: Robot, obstacles: Sequence[Obstacle]) -> Robot:
    """The robot with pairs of its arms' shapes and the obstacles in the place of its own pairs."""
    shapes = robot.shapes.copy()
    shapes.removeAllCollisionPairs()
    arms = {2 + joint for joint in robot.groups["arms"]}
    own = [k for k, shape in enumerate(shapes.geometryObjects) if shape.parentJoint in arms]
    for obstacle in obstacles:
        number = shapes.addGeometryObject(pin.GeometryObject(obstacle.name, 0, obstacle.placement, obstacle.shape))
        for k in own:
            shapes.addCollisionPair(pin.CollisionPair(k, number))
    return replace(robot, shapes=shapes)
