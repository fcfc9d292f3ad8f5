"""Distances between the pairs of shapes that may collide, and how they change."""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sot.proximity.cores import Cores, measure_cores
from sot.proximity.corners import Corners, corner_motion, second_corners
from sot.proximity.movement import (
    MAX_SLIDE_SPEED,
    core_distance_motion,
    distance_drifts,
    distance_jacobian,
    move_pairs,
    pairs_possibly_within,
    rate_bounds,
)
from sot.proximity.shapes import bounding_balls, shapes_of
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.vector_view import view_of_all

Array = np.ndarray

GJK_TOLERANCE = 1e-10
"""Of distances between boxes [m]; with coal's own, 1e-6, one in a hundred is off by as much, which shows in rates."""


class DistanceMotion(NamedTuple):
    """How the distances of n pairs move: ``d̈ = J v̇ + J̇ v``.

    Attributes:
        distances: d, negative where shapes overlap (n,) [m].
        rates: J v (n,) [m/s].
        jacobian: J (n, nv).
        drifts: J̇ v (n,) [m/s²].
    """

    distances: Array
    rates: Array
    jacobian: Array
    drifts: Array


class Proximity:
    """Distances between the pairs of shapes of a robot that may collide, and of these with things and of things.

    Most pairs are far apart, and stay so for many ticks: a distance changes by no more than one shape moves as seen
    from the other. Only pairs that may have come near since they were last measured are measured again. All is told at
    the configuration that `move_to` was given last. Pairs with a thing come after the robot's own.

    Args:
        robot: The robot, or the system of it and things.

    Attributes:
        pairs: Names of the shapes of each pair.
        bodies: Bodies of the shapes of each pair, see `System.body_of`.
        owners: Whose they are: "robot", or things by name.
        own_pairs: Number of pairs of the robot alone, which come first.
        latest_distances: Distances of the pairs as `pairs_within` measured them last (pairs,) [m].
        rest_distances: Distances as all is at rest (pairs,) [m], 0 where shapes overlap.
    """

    def __init__(self, robot: Robot | System) -> None:
        system = System.of(robot)
        robot = system.robot
        self._model, self._nv = system.model, system.nv
        self._geometry, bodies, owners = shapes_of(system)
        self.own_pairs = own_pairs = len(robot.shapes.collisionPairs)
        shapes = self._geometry.geometryObjects
        indices = [(pair.first, pair.second) for pair in self._geometry.collisionPairs]
        self.pairs = [(shapes[first].name, shapes[second].name) for first, second in indices]
        self.bodies = [frozenset((bodies[first], bodies[second])) for first, second in indices]
        self.owners = [frozenset((owners[first], owners[second])) for first, second in indices]
        joints = [shape.parentJoint for shape in shapes]
        chains = [[joint for joint in self._model.supports[k].tolist() if joint] for k in joints]
        self._chains = np.zeros((len(shapes), self._model.njoints), dtype=int)
        for own, chain in zip(self._chains, chains, strict=True):
            own[: len(chain)] = chain
        moving = [_moving_velocities(self._model, chain) for chain in chains]
        self._relative_motion = np.array([moving[second] - moving[first] for first, second in indices])
        self._relative_motion = self._relative_motion.reshape(len(indices), self._nv)
        self._tree = np.array(self._model.parents), np.array(self._model.idx_vs), np.array(self._model.nvs)
        self._indices, self._joints = np.array(indices, dtype=int).reshape(-1, 2), np.array(joints, dtype=int)
        self._balls = bounding_balls(shapes)
        # The smaller one last: seen from the other, its points move less far.
        self._small_last = np.take_along_axis(self._indices, np.argsort(-self._balls[1][self._indices], axis=1), axis=1)
        self.latest_distances = np.full(len(indices), -np.inf)
        self._latest_poses = np.zeros((len(indices), 12))
        self._now, self._ahead, self._later = (_Places(self._geometry, self._indices) for _ in range(3))
        self._corners = Corners.of(len(indices))
        self._data = None
        self.move_to(_rest_data(system))
        with_things = self.measure(np.arange(own_pairs, len(indices)))
        self.rest_distances = np.maximum([*robot.rest_distances, *with_things], 0.0)

    def move_to(self, data: pin.Data) -> None:
        """Take on a configuration: Pinocchio's data with the joints' places and Jacobians.

        Data of a robot among things do for the robot alone, whose joints come first.
        """
        pin.updateGeometryPlacements(self._model, data, self._geometry, self._now.results)
        if data is not self._data:
            self._data, self._J = data, data.J[:, : self._nv]  # a live view: asking for it takes longer than a distance

    def rate_bounds(self, v: Array) -> Array:
        """Upper bounds of the rates of all distances at a velocity (nv,), shape (pairs,) [m/s]."""
        now = self._now
        bounds: Array = rate_bounds(
            *(self._J, v, *self._tree, self._joints, now.rotations, now.translations, *self._balls, self._small_last)
        )
        return bounds

    def pairs_within(self, within: Array) -> Array:
        """Indices of the pairs whose shapes are less than `within` apart, shape (pairs,) [m]; they are measured."""
        now = self._now
        due = pairs_possibly_within(
            *(within, self.latest_distances, self._latest_poses),
            *(now.rotations, now.translations, *self._balls, self._small_last),
        )
        self.latest_distances[due] = distances = self.measure(due)
        near: Array = due[distances < within[due]]
        return near

    def measure(self, pairs: Array) -> Array:
        """Measure pairs: distances of these, negative where shapes overlap, (n,) [m]."""
        return self._now.measure(pairs)

    def jacobian_and_rates(self, pairs: Array, v: Array) -> tuple[Array, Array]:
        """Jacobian J (n, nv) of the distances of pairs that were measured here, and J v (n,) [m/s]."""
        now = self._now
        return distance_jacobian(now.normals, now.points, self._J, v, self._relative_motion, pairs)

    def drifts(
        self, pairs: Array, rates: Array, v: Array, period: float, max_slide_speed: float = MAX_SLIDE_SPEED
    ) -> Array:
        """J̇ v of the distances of pairs (n,) that change at these rates (n,): shape (n,) [m/s²].

        They are how the rates change within a period [s] without acceleration, and measured, since they depend on how
        the shapes are curved. A nearest point that slides on its shape faster than `max_slide_speed` [m/s] has jumped
        to another corner: then they are those of the point that is the nearest now.
        """
        now, ahead, (_, starts, counts) = self._now, self._ahead, self._tree
        twists = move_pairs(
            *(self._J, v, period, starts, counts, self._chains, self._indices, pairs),
            *(now.rotations, now.translations, ahead.rotations, ahead.translations),
        )
        ahead.measure(pairs)
        return distance_drifts(
            *(self._indices, pairs, twists, rates, period),
            *(now.rotations, now.translations, now.distances, now.normals, now.points),
            *(ahead.rotations, ahead.translations, ahead.normals, ahead.points, max_slide_speed),
        )

    def motion(self, pairs: Array, v: Array, period: float) -> DistanceMotion:
        """Distances of pairs (n,) and how they move at a velocity v (nv,), see `drifts`."""
        now, ahead, (_, starts, counts) = self._now, self._ahead, self._tree
        told, *motion = core_distance_motion(
            *(self._indices, pairs, *now.cores, self._J, v, period, starts, counts, self._chains),
            *(self._relative_motion, *now.arrays, *ahead.arrays),
        )
        if told:
            return DistanceMotion(*motion)
        distances = self.measure(pairs)
        jacobian, rates = self.jacobian_and_rates(pairs, v)
        return DistanceMotion(distances, rates, jacobian, self.drifts(pairs, rates, v, period))

    def forget_corners(self) -> None:
        """Forget which corners have been the nearest: another run begins."""
        self._corners.is_told[:] = False

    def second_corners(
        self, pairs: Array, v: Array, period: float, horizon: float, least: float
    ) -> tuple[Array, DistanceMotion]:
        """The pairs with a second corner nearly as near, and how the distances there move, after `motion` of them.

        A corner that is farther away would come unseen until it is the nearest, and the other one would go. It is the
        one that has been the nearest before, or will be within a horizon [s] at the velocities v (nv,).

        Args:
            pairs: Which (n,).
            v: (nv,).
            period: Of the tick [s].
            horizon: How far is looked ahead [s].
            least: Distance from the nearest point from which on another one is a second one, and within which it is
                nearly as near [m].
        """
        now, ahead, later, (_, starts, counts) = self._now, self._ahead, self._later, self._tree
        tree, places = (starts, counts, self._chains, self._indices), (now.rotations, now.translations)
        move_pairs(self._J, v, horizon, *tree, pairs, *places, later.rotations, later.translations)
        later.measure(pairs)
        has = second_corners(self._indices, pairs, least, *now.arrays, *later.arrays, *self._corners)
        chosen, corners = pairs[has], self._corners
        twists = move_pairs(self._J, v, period, *tree, chosen, *places, ahead.rotations, ahead.translations)
        jacobian, rates, drifts = corner_motion(
            *(self._indices, chosen, now.normals, corners.points, self._J, v, period, self._relative_motion, twists),
            *(*places, ahead.rotations, ahead.translations),
        )
        return chosen, DistanceMotion(corners.distances[chosen], rates, jacobian, drifts)


class _Places:
    """Places of shapes and what is measured between them.

    Attributes:
        results: Pinocchio's data of the shapes.
        cores: Of the shapes.
        rotations, translations: Axes and origins of all shapes, world axes, (m, 3, 3) and (m, 3): views of Pinocchio's,
            since looking them up costs more.
        distances, normals, points: Of the pairs as they were measured last, normals from the first shapes to the second
            ones, and nearest points of these, (n,), (n, 3) and (n, 3).
        arrays: The last five.
    """

    def __init__(self, geometry: pin.GeometryModel, indices: Array) -> None:
        self._geometry, self.results = geometry, geometry.createData()
        for request in self.results.distanceRequests:
            request.gjk_tolerance = GJK_TOLERANCE
        self._pairs, self._indices = list(self.results.distanceResults), indices
        self.cores = Cores.of(geometry.geometryObjects)
        self.rotations = view_of_all([place.rotation for place in self.results.oMg], (3, 3))
        self.translations = view_of_all([place.translation for place in self.results.oMg], (3,))
        self.distances, self.normals, self.points = (np.empty((len(indices), *shape)) for shape in ((), (3,), (3,)))
        self.arrays = self.rotations, self.translations, self.distances, self.normals, self.points

    def measure(self, pairs: Array) -> Array:
        """Measure some pairs; returns their distances."""
        told = measure_cores(self._indices, pairs, *self.cores, *self.arrays)
        distances: Array = self.distances[pairs]
        if not told:
            for k in pairs[np.isnan(distances)].tolist():
                result = self._pairs[k]
                pin.computeDistance(self._geometry, self.results, k)
                self.distances[k], self.normals[k] = result.min_distance, result.normal
                self.points[k] = result.getNearestPoint2()
            distances = self.distances[pairs]
        return distances


def _rest_data(system: System) -> pin.Data:
    data = system.model.createData()
    pin.computeJointJacobians(system.model, data, system.rest)
    return data


def _moving_velocities(model: pin.Model, chain: list[int]) -> Array:
    """1 for each velocity of the joints of a chain, 0 for the others; shape (nv,)."""
    moves = np.zeros(model.nv)
    for joint in chain:
        moves[model.idx_vs[joint] : model.idx_vs[joint] + model.nvs[joint]] = 1.0
    return moves
