"""How a robot can stand on two flat feet: legs within their joints' ranges, and apart."""

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.robots.leg_range import Leg
from sot.robots.robot import FEET, Robot
from sot.robots.size import leg_length

Array = NDArray[np.float64]

SIDES = tuple(foot.removesuffix("_foot") for foot in FEET)
PLANNED_DISTANCE_LEGS = 0.0333  # leg lengths, distance that plans keep between limbs
PLANNED_REST_DISTANCE_SHARE = 0.75  # share of its distance at rest that a pair keeps at most


def planned_distances(robot: Robot, rest_distances: Array) -> Array:
    """The distances (n,) that plans keep between pairs of shapes, which are so far apart at rest (n,) [m].

    They are greater than what the controller keeps, so that the two do not contradict each other.
    """
    return np.minimum(PLANNED_DISTANCE_LEGS * leg_length(robot), PLANNED_REST_DISTANCE_SHARE * rest_distances)


def leg_pairs(robot: Robot) -> list[tuple[int, int]]:
    """The robot's pairs of shapes of the right leg and the left one; not those of feet, which footholds keep apart."""
    left, right = ({2 + joint for joint in robot.groups[f"{side}_leg"]} for side in SIDES)
    feet = {robot.model.frames[robot.point(foot)].parentJoint for foot in robot.feet}
    owners = [shape.parentJoint for shape in robot.shapes.geometryObjects]
    found = []
    for pair in robot.shapes.collisionPairs:
        for a, b in ((int(pair.first), int(pair.second)), (int(pair.second), int(pair.first))):
            if owners[a] in right and owners[b] in left and not feet.issuperset((owners[a], owners[b])):
                found.append((a, b))
    return found


class Stance:
    """A robot on two flat feet, in its rest posture but for its legs.

    Attributes:
        legs: left and right.
    """

    def __init__(self, robot: Robot):
        self.legs = tuple(Leg(robot, side) for side in SIDES)
        self._robot, self._data = robot, robot.model.createData()
        self._geometry = robot.shapes.copy()
        self._geometry.removeAllCollisionPairs()
        for pair in leg_pairs(robot):
            self._geometry.addCollisionPair(pin.CollisionPair(*pair))
        self._results = self._geometry.createData()
        self._kept = planned_distances(robot, self._distances(robot.rest))

    def postures(self, angles: Sequence[Array], ankles: Sequence[Array], turns: Sequence[Array]) -> list[Array] | None:
        """The joint angles (6,) of both legs, in range or not, by `Leg.posture`; None if a leg has none."""
        found = [
            leg.posture(start, ankle, turn)
            for leg, start, ankle, turn in zip(self.legs, angles, ankles, turns, strict=True)
        ]
        solved = [own for own in found if own is not None]
        return solved if len(solved) == len(found) else None

    def configuration(self, angles: Sequence[Array]) -> Array:
        """The robot's configuration (nq,) with its legs at some joint angles, its base as at rest."""
        q = self._robot.rest.copy()
        for leg, own in zip(self.legs, angles, strict=True):
            q[7 + leg.joints] = own
        return q

    def are_in_range(self, angles: Sequence[Array]) -> bool:
        """Whether joint angles of both legs are within their ranges."""
        return all(leg.in_range(own) for leg, own in zip(self.legs, angles, strict=True))

    def are_apart(self, angles: Sequence[Array]) -> bool:
        """Whether legs with some joint angles are as far apart as `planned_distances` says."""
        return bool(np.all(self._distances(self.configuration(angles)) >= self._kept))

    def _distances(self, q: Array) -> Array:
        pin.computeDistances(self._robot.model, self._data, self._geometry, self._results, q)
        return np.array([result.min_distance for result in self._results.distanceResults])
