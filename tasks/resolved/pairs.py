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
        self._proximities = [Proximity(robot)]
        if obstacles:
            self._proximities.append(Proximity(_among_obstacles(robot, obstacles)))

    def __call__(self, tick: Tick) -> Distances:
        """At a tick's configuration."""
        names: list[tuple[str, str]] = []
        parts = []
        for number, proximity in enumerate(self._proximities):
            proximity.move_to(tick.data)
            near = proximity.pairs_within(self._reach + self._braking_time * proximity.rate_bounds(tick.v))
            names += [proximity.pairs[k] for k in near.tolist()]
            jacobian, rates = proximity.jacobian_and_rates(near, tick.v)
            parts.append((np.full(len(near), number), near, proximity.latest_distances[near], jacobian, rates))
        owners, pairs, values, jacobian, rates = (np.concatenate(each) for each in zip(*parts, strict=True))
        gaps = values + self._braking_time * np.minimum(rates, 0.0)
        nearest = np.argsort(gaps)[: self._count]
        nearest = nearest[gaps[nearest] < self._reach]
        drifts = np.zeros(len(values))
        for number, proximity in enumerate(self._proximities):
            curved = nearest[(owners[nearest] == number) & (values[nearest] < CURVED_DISTANCE)]
            if len(curved):
                # Weights see one distance a pair: that it jumps to another corner is to brake, too.
                drifts[curved] = proximity.drifts(pairs[curved], rates[curved], tick.v, tick.period, np.inf)
        return Distances([names[k] for k in nearest.tolist()], values[nearest], jacobian[nearest], drifts[nearest])


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
