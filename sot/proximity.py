"""How near the parts of a robot come to one another: pairs of collision shapes, and how their distances change."""

from collections.abc import Iterator, Sequence

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.robots.robot import Robot

Array = np.ndarray

LIMBS = ("left_arm", "right_arm", "left_leg", "right_leg")
ROOM = 0.02
"""Pairs that are nearer at rest [m] are neighbours in the tree, or made to touch: they do not count."""

GJK_TOLERANCE = 1e-10
"""Of distances to boxes [m]; with coal's own, 1e-6, one in a hundred is off by as much, which shows in rates."""


class Proximity:
    """Distances between the collision shapes of a robot's limbs and those of the rest of it.

    A limb is paired with all that is not of it; legs not with the base, which they overlap by design.

    Most pairs are far apart, and stay so for many ticks: a distance changes by no more than the joints between the two
    shapes turn, each times its reach. Only pairs that may have come near since they were last looked at are looked at
    again.

    Args:
        robot: The robot.

    Attributes:
        pairs: Names of the shapes of each pair.
    """

    def __init__(self, robot: Robot) -> None:
        self._model, data = robot.model, robot.model.createData()
        self._geometry = robot.shapes.copy()
        self._geometry.removeAllCollisionPairs()
        for first, second in _candidates(robot):
            self._geometry.addCollisionPair(pin.CollisionPair(first, second))
        self._open()
        pin.computeDistances(self._model, data, self._geometry, self._results, robot.rest)
        apart = [result.min_distance for result in self._each]
        for k in np.flatnonzero(np.array(apart) < ROOM)[::-1].tolist():
            self._geometry.removeCollisionPair(self._geometry.collisionPairs[k])
        self._open()
        shapes = self._geometry.geometryObjects
        pairs = [(shapes[pair.first], shapes[pair.second]) for pair in self._geometry.collisionPairs]
        self.pairs = [(first.name, second.name) for first, second in pairs]
        moves = [_moves(self._model, second) - _moves(self._model, first) for first, second in pairs]
        self._moves = np.array(moves).reshape(len(pairs), robot.nv)
        reaches = [reach(self._model, first, second) for first, second in pairs]
        self._reach = np.array(reaches).reshape(len(pairs), robot.na)
        self._seen = np.zeros((len(pairs), robot.na))
        self._apart = np.full(len(pairs), -np.inf)

    def fastest(self, v: Array) -> Array:
        """What the distances' rates do not exceed at a velocity (nv,), shape (pairs,) [m/s]."""
        return _fastest(self._reach, v)

    def near(self, data: pin.Data, q: Array, within: Array) -> list[int]:
        """Indices of the pairs that are less than `within` apart.

        Args:
            data: Pinocchio's, with the places of the joints at q.
            q: Configuration, shape (nq,).
            within: Distance of each pair, shape (pairs,) [m].
        """
        joints = q[7:]
        due = _due(self._apart, self._reach, self._seen, joints, within)
        if not len(due):
            return []
        pin.updateGeometryPlacements(self._model, data, self._geometry, self._results)
        for k in due.tolist():
            pin.computeDistance(self._geometry, self._results, k)
            self._apart[k] = self._each[k].min_distance
        self._seen[due] = joints
        return due[(self._apart < within)[due]].tolist()

    def measure(self, data: pin.Data, pairs: Sequence[int]) -> tuple[Array, Array]:
        """Distances of n pairs, negative where shapes overlap, shape (n,) [m], and their Jacobian, shape (n, nv).

        Args:
            data: Pinocchio's, with the joints' places and Jacobians at a configuration.
            pairs: Indices of pairs.
        """
        pin.updateGeometryPlacements(self._model, data, self._geometry, self._results)
        for k in pairs:
            pin.computeDistance(self._geometry, self._results, k)
        return self.found(data, pairs)

    def found(self, data: pin.Data, pairs: Sequence[int]) -> tuple[Array, Array]:
        """The same of pairs that `near` has just found."""
        distances, normals, points = np.empty(len(pairs)), np.empty((len(pairs), 3)), np.empty((len(pairs), 3))
        for n, k in enumerate(pairs):
            distances[n], normals[n] = self._each[k].min_distance, self._normals[k]
            points[n] = self._each[k].getNearestPoint2()
        return distances, _slopes(normals, points, data.J, self._moves, np.array(pairs, dtype=int))

    def _open(self) -> None:
        self._results = self._geometry.createData()
        self._each = list(self._results.distanceResults)  # views: looking them up costs more than a distance
        self._normals = [result.normal for result in self._each]  # from the first shape to the second; views as well
        for request in self._results.distanceRequests:
            request.gjk_tolerance = GJK_TOLERANCE


@compiled
def _fastest(reach: Array, v: Array) -> Array:
    fastest = np.zeros(len(reach))
    for k in range(len(reach)):
        for i in range(reach.shape[1]):
            fastest[k] += reach[k, i] * abs(v[6 + i])
    return fastest


@compiled
def _due(apart: Array, reach: Array, seen: Array, joints: Array, within: Array) -> Array:
    """Pairs that may have come nearer than `within` since they were looked at."""
    near = np.empty(len(apart), np.bool_)
    for k in range(len(apart)):
        least = apart[k]
        for i in range(len(joints)):
            least -= reach[k, i] * abs(seen[k, i] - joints[i])
        near[k] = least < within[k]
    return np.flatnonzero(near)


@compiled
def _slopes(normals: Array, points: Array, J: Array, moves: Array, pairs: Array) -> Array:
    """Jacobian of the distances of some pairs, from what two unit forces along the normals at the points do."""
    out = np.empty((len(pairs), J.shape[1]))
    for n in range(len(pairs)):
        nx, ny, nz = normals[n]
        x, y, z = points[n]
        a, b, c = y * nz - z * ny, z * nx - x * nz, x * ny - y * nx
        for i in range(J.shape[1]):
            slope = nx * J[0, i] + ny * J[1, i] + nz * J[2, i] + a * J[3, i] + b * J[4, i] + c * J[5, i]
            out[n, i] = slope * moves[pairs[n], i]
    return out


def _candidates(robot: Robot) -> Iterator[tuple[int, int]]:
    """Pairs of shapes of different parts of the body, at least one of them a limb."""
    part = {2 + joint: limb for limb in LIMBS for joint in robot.groups[limb]}
    owners = [
        part.get(shape.parentJoint, "base" if shape.parentJoint <= 1 else "trunk")
        for shape in robot.shapes.geometryObjects
    ]
    for second, b in enumerate(owners):
        for first, a in enumerate(owners[:second]):
            if a != b and {a, b} & set(LIMBS) and not ("base" in (a, b) and {a, b} & {"left_leg", "right_leg"}):
                yield first, second


def _moves(model: pin.Model, shape: pin.GeometryObject) -> Array:
    """1 for each velocity that moves a shape, 0 for the others; shape (nv,)."""
    moves = np.zeros(model.nv)
    for joint in model.supports[shape.parentJoint]:
        moves[model.idx_vs[joint] : model.idx_vs[joint] + model.nvs[joint]] = 1.0
    return moves


def reach(model: pin.Model, first: pin.GeometryObject, second: pin.GeometryObject) -> Array:
    """How far a shape is moved in the view of another when each joint turns by one radian, at most; shape (na,) [m]."""
    reach = np.zeros(model.nv - 6)
    chains = [set(model.supports[shape.parentJoint]) for shape in (first, second)]
    for shape, own, other in ((first, *chains), (second, *chains[::-1])):
        shape.geometry.computeLocalAABB()
        length = float(np.linalg.norm(shape.placement.act(shape.geometry.aabb_center))) + shape.geometry.aabb_radius
        joint = shape.parentJoint
        while joint in own - other:
            reach[joint - 2] = length
            length += float(np.linalg.norm(model.jointPlacements[joint].translation))
            joint = model.parents[joint]
    return reach
