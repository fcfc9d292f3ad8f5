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
        jacobian: Of the distances, Hammam (23), shape (n, nv).
    """

    pairs: Sequence[tuple[str, str]]
    values: Array
    jacobian: Array


class NearestPairs:
    """The nearest of all pairs of a robot's shapes that may collide, and of its arms and the obstacles.

    Hammam (23) divides by the distance, and changes its sign where shapes overlap. The normal between the shapes does
    neither.

    Args:
        robot: The robot.
        count: How many pairs are given at most.
        reach: Pairs further apart than this are left out [m].
        obstacles: Shapes of the environment.
    """

    def __init__(self, robot: Robot, count: int, reach: float, obstacles: Sequence[Obstacle] = ()) -> None:
        self._count, self._proximity = count, Proximity(robot)
        self._within = np.full(len(self._proximity.pairs), reach)
        self._reach = reach
        self._environment = Proximity(_among_obstacles(robot, obstacles)) if obstacles else None

    def __call__(self, tick: Tick) -> Distances:
        """At a tick's configuration."""
        near = self._proximity.pairs_within(tick.data, tick.q, self._within)
        values, jacobian = self._proximity.latest_distances_and_jacobian(tick.data, near)
        names = [self._proximity.pairs[k] for k in near]
        if self._environment is not None:
            there = self._environment
            others, other_jacobian = there.distances_and_jacobian(tick.data, range(len(there.pairs)))
            close = others < self._reach
            values, jacobian = np.append(values, others[close]), np.vstack([jacobian, other_jacobian[close]])
            names += [name for name, one in zip(there.pairs, close.tolist(), strict=True) if one]
        nearest = np.argsort(values)[: self._count]
        return Distances([names[k] for k in nearest.tolist()], values[nearest], jacobian[nearest])


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
