"""Limbs that keep their distance: arms from the rest of the body, legs from each other."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.body.coordinates import to_configuration
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.parts import Arm, Body, Indices
from sot.motion.body.targets import Targets
from sot.motion.feet.stance import Build
from sot.motion.feet.swing import FootPath
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.stance_range import PLANNED_DISTANCE_LEGS, leg_pairs, planned_distances

Array = NDArray[np.float64]

ACCEPTED_MISSING = {"arm": 0.005, "legs": 0.00166}  # leg lengths, missing of that distance


class _NearestPair(NamedTuple):
    """Nearest pair of a limb's shape: its row and shape, the normal and the two nearest points (3,)."""

    row: int
    shape: int
    normal: Array
    first: Array
    second: Array


class Clearance:
    """Signed distances from each shape of a limb to the nearest one of what it keeps clear of, at the knots of a clip.

    Only the robot's own pairs of shapes count, each to be as far apart as `planned_distances` says. A
    distance changes by no more than the joints between two shapes turn, each times its reach: distances at a knot are
    measured again only where something may have come near since.

    Attributes:
        wanted: greatest distance that is to be kept by a pair [m].
    """

    def __init__(self, robot: Robot, pairs: Iterable[tuple[int, int]], length: int):
        """
        Args:
            robot: the robot.
            pairs: of its shapes, each what is to be kept clear of and the limb's.
            length: number of knots T.
        """
        self._leg = leg_length(robot)
        self.wanted = PLANNED_DISTANCE_LEGS * self._leg
        self._model, self._chains = robot.model, JointTree(robot)
        self._data = robot.model.createData()
        self._geometry = robot.shapes.copy()
        self._geometry.removeAllCollisionPairs()
        for pair in pairs:
            self._geometry.addCollisionPair(pin.CollisionPair(*pair))
        self._allocate_results()
        self._min_distances = planned_distances(robot, self._distances(robot.rest))
        left, shapes = list(self._geometry.collisionPairs), self._geometry.geometryObjects
        owners = np.array([pair.second for pair in left], dtype=int)
        self._pairs_of_shape = [
            np.flatnonzero(owners == shape) for shape in np.unique(owners)
        ]  # pairs of each of its shapes
        self._joints = [(shapes[pair.first].parentJoint, shapes[pair.second].parentJoint) for pair in left]
        reaches = [_lever_arm_bounds(self._model, shapes[pair.first], shapes[pair.second]) for pair in left]
        self._reach = np.array(reaches).reshape(len(left), robot.na)
        self._measured_angles = np.zeros((length, robot.na))
        self._known_distances = np.full((length, len(left)), -np.inf)

    @staticmethod
    def of_arm(robot: Robot, side: str, length: int) -> "Clearance":
        """Clearance of an arm from the rest of the body."""
        arm = set(_shapes_of_group(robot, f"{side}_arm"))
        return Clearance(robot, _pairs_between(robot, set(range(robot.shapes.ngeoms)) - arm, arm), length)

    @staticmethod
    def of_legs(robot: Robot, length: int) -> "Clearance":
        """Clearance of the left leg from the right one; pairs of feet do not count, since their motion is given."""
        return Clearance(robot, leg_pairs(robot), length)

    def evaluate(self, knots: Indices, y: Array, columns: Indices) -> tuple[Array, Array]:
        """Distance that is missing of what is to be kept at n knots (n, shapes) [m], 0 where none is, and its Jacobian
        (n, shapes, s) with respect to some columns of the coordinates y (n, nv)."""
        missing = np.zeros((len(y), len(self._pairs_of_shape)))
        J = np.zeros((*missing.shape, len(columns)))
        nearest: dict[int, list[_NearestPair]] = {}  # pair -> where it is the nearest
        turned = np.abs(y[:, 6:] - self._measured_angles[knots]) @ self._reach.T
        due = np.flatnonzero((self._known_distances[knots] - turned < self._min_distances).any(axis=1))
        self._measured_angles[knots[due]] = y[due, 6:]
        for n, q in zip(due.tolist(), to_configuration(y[due]), strict=True):
            self._known_distances[knots[n]] = apart = self._distances(q)
            spare = apart - self._min_distances
            if spare.min(initial=np.inf) >= 0.0:
                continue
            for i, pairs in enumerate(self._pairs_of_shape):
                if (least := spare[pairs].min()) < 0.0:
                    k = int(pairs[spare[pairs].argmin()])
                    missing[n, i] = -least
                    found = self._pair_results[k]
                    place = _NearestPair(n, i, found.normal.copy(), found.getNearestPoint1(), found.getNearestPoint2())
                    nearest.setdefault(k, []).append(place)
        for k, places in nearest.items():
            rows, shapes, normals, first, second = (np.array(each) for each in zip(*places, strict=True))
            kinematics, (one, other) = Kinematics(self._chains, y[rows], columns), self._joints[k]
            apart_by = kinematics.point_jacobian(other, second) - kinematics.point_jacobian(one, first)
            J[rows, shapes] = -np.einsum("ni,nis->ns", normals, apart_by)
        return missing, J

    def added(self, limb: str, residuals: tuple[Array, Array], missing: tuple[Array, Array]) -> tuple[Array, Array]:
        """Weighted residuals and Jacobians of a limb with those of the distances that are missing."""
        (errors, jacobians), (lacking, J), weight = residuals, missing, 1.0 / (ACCEPTED_MISSING[limb] * self._leg)
        return np.hstack([errors, weight * lacking]), np.concatenate([jacobians, weight * J], axis=1)

    def _allocate_results(self) -> None:
        self._results = self._geometry.createData()
        self._pair_results = list(self._results.distanceResults)  # views: looking them up costs more than the distances

    def _distances(self, q: Array) -> Array:
        pin.computeDistances(self._model, self._data, self._geometry, self._results, q)
        return np.array([result.min_distance for result in self._pair_results])


class ClearArm(Arm):
    """An arm that follows its directions and is pushed off the body where it comes too near."""

    def __init__(self, robot: Robot, side: str, targets: Targets):
        super().__init__(robot, side, targets)
        self._clearance = Clearance.of_arm(robot, side, targets.length)

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        return self._clearance.added(
            "arm", super().evaluate(knots, y), self._clearance.evaluate(knots, y, self.columns)
        )


class ClearBody(Body):
    """Base, legs and chest that follow their targets, with legs pushed off each other where they are too near.

    The push fades with overlap and vanishes where legs overlap by as much as they are to keep: over feet that leave no
    way out it would disturb all the rest.
    """

    def __init__(
        self,
        robot: Robot,
        build: Build,
        targets: Targets,
        feet: Mapping[str, FootPath],
        legs: Clearance,
        com: Array | None = None,
    ):
        """legs: their clearance, which remembers what it saw from body to body of the same clip."""
        super().__init__(robot, build, targets, feet, com)
        self._legs = legs

    def evaluate(self, knots: Indices, y: Array) -> tuple[Array, Array]:
        missing, J = self._legs.evaluate(knots, y, self.columns)
        hope = np.clip(2.0 - missing / self._legs.wanted, 0.0, 1.0)
        return self._legs.added("legs", super().evaluate(knots, y), (hope * missing, hope[..., None] * J))


def _shapes_of_group(robot: Robot, group: str) -> list[int]:
    """Numbers of the shapes that a group of joints carries."""
    joints = {2 + joint for joint in robot.groups[group]}
    return [k for k, shape in enumerate(robot.shapes.geometryObjects) if shape.parentJoint in joints]


def _pairs_between(robot: Robot, first: set[int], second: set[int]) -> list[tuple[int, int]]:
    """Pairs of the robot's shapes that may collide, each one of the first and one of the second shapes."""
    pairs = [(int(pair.first), int(pair.second)) for pair in robot.shapes.collisionPairs]
    swapped = [(b, a) for a, b in pairs]
    return [(a, b) for a, b in (*pairs, *swapped) if a in first and b in second]


def _lever_arm_bounds(model: pin.Model, first: pin.GeometryObject, second: pin.GeometryObject) -> Array:
    """Upper bounds of how far each joint moves one shape relative to another, shape (na,) [m/rad]."""
    bounds = np.zeros(model.nv - 6)
    chains = [set(model.supports[shape.parentJoint]) for shape in (first, second)]
    for shape, own, other in ((first, *chains), (second, *chains[::-1])):
        shape.geometry.computeLocalAABB()
        length = float(np.linalg.norm(shape.placement.act(shape.geometry.aabb_center))) + shape.geometry.aabb_radius
        joint = shape.parentJoint
        while joint in own - other:
            bounds[joint - 2] = length
            length += float(np.linalg.norm(model.jointPlacements[joint].translation))
            joint = model.parents[joint]
    return bounds
