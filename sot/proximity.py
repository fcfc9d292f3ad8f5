"""How near parts of a robot come to one another and to things: pairs of collision shapes, and how distances change."""

from collections.abc import Sequence

import coal
import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.robots.robot import Robot
from sot.robots.system import System

Array = np.ndarray

GJK_TOLERANCE = 1e-10
"""Of distances to boxes [m]; with coal's own, 1e-6, one in a hundred is off by as much, which shows in rates."""

OVERLAP_CHECK_PERIOD = 0.05
"""Interval at which a motion is looked at for shapes that overlap [s]."""


class Proximity:
    """Distances between the pairs of shapes of a robot that may collide, and of these with things and of things.

    Most pairs are far apart, and stay so for many ticks: a distance changes by no more than the joints between the two
    shapes turn, each times its reach. Only pairs that may have come near since they were last looked at are looked at
    again. Pairs with a thing come after the robot's own; balls about their shapes tell which are far apart.

    Args:
        robot: The robot, or the system of it and things.

    Attributes:
        pairs: Names of the shapes of each pair.
        bodies: Bodies of the shapes of each pair, see `System.body_of`.
        owners: Whose they are: "robot", or things by name.
        own_pairs: Number of pairs of the robot alone, which come first.
        rest_distances: Distances as all is at rest (pairs,) [m], 0 where shapes overlap.
    """

    def __init__(self, robot: Robot | System) -> None:
        self._system = system = System.of(robot)
        robot = system.robot
        self._model = system.model
        self._geometry = robot.shapes.copy()
        bodies, owners = _add_thing_shapes(self._geometry, system)
        self.own_pairs = own_pairs = len(robot.shapes.collisionPairs)
        self._renew_results()
        shapes = self._geometry.geometryObjects
        indices = [(pair.first, pair.second) for pair in self._geometry.collisionPairs]
        pairs = [(shapes[first], shapes[second]) for first, second in indices]
        self.pairs = [(first.name, second.name) for first, second in pairs]
        self.bodies = [frozenset((bodies[first], bodies[second])) for first, second in indices]
        self.owners = [frozenset((owners[first], owners[second])) for first, second in indices]
        relative_motion = [
            _moving_velocities(self._model, second) - _moving_velocities(self._model, first) for first, second in pairs
        ]
        self._relative_motion = np.array(relative_motion).reshape(len(pairs), system.nv)
        reaches = [lever_arm_bounds(robot.model, first, second) for first, second in pairs[:own_pairs]]
        self._lever_bounds = np.array(reaches).reshape(own_pairs, robot.na)
        self._joints_when_measured = np.zeros((own_pairs, robot.na))
        self._latest_distances = np.full(len(pairs), -np.inf)
        self._with_things = np.array(indices[own_pairs:], dtype=int).reshape(-1, 2)
        self._centres, self._radii = _bounding_balls(shapes)
        self.rest_distances = np.maximum(
            [*robot.rest_distances, *self._distances_at_rest(range(own_pairs, len(pairs)))], 0.0
        )

    def _distances_at_rest(self, pairs: range) -> list[float]:
        if not pairs:
            return []
        data = self._model.createData()
        pin.updateGeometryPlacements(self._model, data, self._geometry, self._results, self._system.rest)
        for k in pairs:
            pin.computeDistance(self._geometry, self._results, k)
        return [self._distance_results[k].min_distance for k in pairs]

    def rate_bounds(self, v: Array) -> Array:
        """Upper bounds of the rates of all distances at a velocity (nv,), shape (pairs,) [m/s]; none with things."""
        own = _rate_bounds(self._lever_bounds, v)
        return np.append(own, np.full(len(self._with_things), np.inf)) if len(self._with_things) else own

    def pairs_within(self, data: pin.Data, q: Array, within: Array) -> list[int]:
        """Indices of the pairs whose shapes are less than `within` apart.

        Args:
            data: Pinocchio's, with the places of the joints at q.
            q: Configuration, shape (nq,).
            within: Distance of each pair, shape (pairs,) [m].
        """
        own_pairs = self.own_pairs
        joints = q[7 : 7 + self._system.robot.na]
        own = _pairs_possibly_within(
            self._latest_distances, self._lever_bounds, self._joints_when_measured, joints, within
        )
        due = own
        if len(self._with_things):
            pin.updateGeometryPlacements(self._model, data, self._geometry, self._results)
            places = [place.act(centre) for place, centre in zip(self._results.oMg, self._centres, strict=True)]
            apart = _distances_of_balls(np.array(places), self._radii, self._with_things)
            self._latest_distances[own_pairs:] = apart
            due = np.append(own, own_pairs + np.flatnonzero(apart < within[own_pairs:]))
        if not len(due):
            return []
        if not len(self._with_things):
            pin.updateGeometryPlacements(self._model, data, self._geometry, self._results)
        for k in due.tolist():
            pin.computeDistance(self._geometry, self._results, k)
            self._latest_distances[k] = self._distance_results[k].min_distance
        self._joints_when_measured[own] = joints
        return due[(self._latest_distances < within)[due]].tolist()

    def distances_and_jacobian(self, data: pin.Data, pairs: Sequence[int]) -> tuple[Array, Array]:
        """Distances of n pairs, negative where shapes overlap, shape (n,) [m], and their Jacobian, shape (n, nv).

        Args:
            data: Pinocchio's, with the joints' places and Jacobians at a configuration.
            pairs: Indices of pairs.
        """
        pin.updateGeometryPlacements(self._model, data, self._geometry, self._results)
        for k in pairs:
            pin.computeDistance(self._geometry, self._results, k)
        return self.latest_distances_and_jacobian(data, pairs)

    def latest_distances_and_jacobian(self, data: pin.Data, pairs: Sequence[int]) -> tuple[Array, Array]:
        """Distances and Jacobian, as `distances_and_jacobian`, of pairs that `pairs_within` has just measured."""
        distances, normals, points = np.empty(len(pairs)), np.empty((len(pairs), 3)), np.empty((len(pairs), 3))
        for n, k in enumerate(pairs):
            distances[n], normals[n] = self._distance_results[k].min_distance, self._normals[k]
            points[n] = self._distance_results[k].getNearestPoint2()
        return distances, _distance_jacobian(
            normals, points, self._joint_jacobian(data), self._relative_motion, np.array(pairs, dtype=int)
        )

    def _joint_jacobian(self, data: pin.Data) -> Array:
        """Jacobian of the joints that count here: of a robot among things, its own, which come first."""
        return data.J if data.J.shape[1] == self._system.nv else np.asfortranarray(data.J[:, : self._system.nv])

    def _renew_results(self) -> None:
        self._results = self._geometry.createData()
        self._distance_results = list(
            self._results.distanceResults
        )  # views: looking them up costs more than a distance
        self._normals = [
            result.normal for result in self._distance_results
        ]  # from the first shape to the second; views as well
        for request in self._results.distanceRequests:
            request.gjk_tolerance = GJK_TOLERANCE


def overlap_remarks(robot: Robot, times: Array, q: Array) -> list[str]:
    """Say where a motion brings shapes into each other that may collide: the pair that does so most, and how many do.

    Args:
        robot: The robot.
        times: Of the configurations, shape (n,) [s].
        q: Configurations, shape (n, nq); a few of each second are looked at.
    """
    data, results = robot.model.createData(), robot.shapes.createData()
    rows = [int(k) for k in np.searchsorted(times, np.arange(times[0], times[-1], OVERLAP_CHECK_PERIOD))]
    depths = np.zeros((len(rows), len(results.distanceResults)))
    for depth, row in zip(depths, rows, strict=True):
        pin.computeDistances(robot.model, data, robot.shapes, results, q[row])
        depth[:] = [-result.min_distance for result in results.distanceResults]
    overlapping = int((depths > 0.0).any(axis=0).sum()) if depths.size else 0
    if not overlapping:
        return []
    row, k = divmod(int(depths.argmax()), depths.shape[1])
    pair, shapes = robot.shapes.collisionPairs[k], robot.shapes.geometryObjects
    first, second = (shapes[index].name for index in (pair.first, pair.second))
    others = f", and {overlapping - 1} other pairs do so" if overlapping > 1 else ""
    depth_mm, time = 1e3 * depths[row, k], times[rows[row]]
    return [f"The plan brings {first} and {second} {depth_mm:.0f} mm into each other at {time:.2f} s{others}."]


@compiled
def _rate_bounds(lever_bounds: Array, v: Array) -> Array:
    bounds = np.zeros(len(lever_bounds))
    for k in range(len(lever_bounds)):
        for i in range(lever_bounds.shape[1]):
            bounds[k] += lever_bounds[k, i] * abs(v[6 + i])
    return bounds


@compiled
def _pairs_possibly_within(
    latest: Array, lever_bounds: Array, joints_then: Array, joints: Array, within: Array
) -> Array:
    """Indices of the pairs that may have come nearer than `within` since they were last measured."""
    near = np.empty(len(lever_bounds), np.bool_)
    for k in range(len(lever_bounds)):
        least = latest[k]
        for i in range(len(joints)):
            least -= lever_bounds[k, i] * abs(joints_then[k, i] - joints[i])
        near[k] = least < within[k]
    return np.flatnonzero(near)


@compiled
def _distance_jacobian(normals: Array, points: Array, J: Array, relative_motion: Array, pairs: Array) -> Array:
    """Jacobian of the distances of some pairs, from the normals and the nearest points of the second shapes."""
    out = np.empty((len(pairs), J.shape[1]))
    for n in range(len(pairs)):
        nx, ny, nz = normals[n]
        x, y, z = points[n]
        a, b, c = y * nz - z * ny, z * nx - x * nz, x * ny - y * nx
        for i in range(J.shape[1]):
            slope = nx * J[0, i] + ny * J[1, i] + nz * J[2, i] + a * J[3, i] + b * J[4, i] + c * J[5, i]
            out[n, i] = slope * relative_motion[pairs[n], i]
    return out


@compiled
def _distances_of_balls(centres: Array, radii: Array, pairs: Array) -> Array:
    """Lower bounds of distances: of the balls about the shapes of each pair (n,) [m]."""
    out = np.empty(len(pairs))
    for n in range(len(pairs)):
        a, b = pairs[n, 0], pairs[n, 1]
        x, y, z = centres[a, 0] - centres[b, 0], centres[a, 1] - centres[b, 1], centres[a, 2] - centres[b, 2]
        out[n] = np.sqrt(x * x + y * y + z * z) - radii[a] - radii[b]
    return out


def _bounding_balls(shapes: Sequence[pin.GeometryObject]) -> tuple[list[Array], Array]:
    """Centres in the shapes' own axes, and radii (n,), of balls about shapes [m]."""
    for shape in shapes:
        shape.geometry.computeLocalAABB()
    centres = [np.array(shape.geometry.aabb_center) for shape in shapes]
    return centres, np.array([shape.geometry.aabb_radius for shape in shapes])


def _add_pads(geometry: pin.GeometryModel, system: System) -> list[int]:
    """Add the pads in front of the robot's palms, which meet things but no part of the robot; returns their bodies."""
    bodies = []
    for name, surface in system.robot.surfaces.items():
        if name not in system.robot.feet and surface.point is not None:
            (half, place), frame = surface.pad(), system.model.frames[system.point(surface.point)]
            shape = pin.GeometryObject(name, frame.parentJoint, frame.placement * place, coal.Box(*(2.0 * half)))
            geometry.addGeometryObject(shape)
            bodies.append(int(frame.parentJoint))
    return bodies


def _add_thing_shapes(geometry: pin.GeometryModel, system: System) -> tuple[list[str | int], list[str]]:
    """Add the shapes of things and the pairs in which they may collide; returns body and owner of each shape."""
    bodies: list[str | int] = [int(shape.parentJoint) for shape in geometry.geometryObjects]
    if system.things:
        bodies += _add_pads(geometry, system)
    owners = ["robot"] * len(bodies)
    for thing in system.things:
        for number, (frame, solid) in enumerate(thing.solids):
            own = thing.model.frames[frame]
            joint = system.model.getJointId(thing.model.names[own.parentJoint]) if own.parentJoint else 0
            place, name = own.placement * solid.placement, solid.name or f"{thing.name}/{number}"
            geometry.addGeometryObject(pin.GeometryObject(name, joint, place, solid.coal()))
            bodies.append(joint or thing.name)
            owners.append(thing.name)
    moves = [owner == "robot" or isinstance(body, int) for owner, body in zip(owners, bodies, strict=True)]
    for second, owner in enumerate(owners):
        for first in range(second):
            if owner != "robot" and owners[first] != owner and (moves[first] or moves[second]):
                geometry.addCollisionPair(pin.CollisionPair(first, second))
    return bodies, owners


def _moving_velocities(model: pin.Model, shape: pin.GeometryObject) -> Array:
    """1 for each velocity that moves a shape, 0 for the others; shape (nv,)."""
    moves = np.zeros(model.nv)
    for joint in model.supports[shape.parentJoint]:
        moves[model.idx_vs[joint] : model.idx_vs[joint] + model.nvs[joint]] = 1.0
    return moves


def lever_arm_bounds(model: pin.Model, first: pin.GeometryObject, second: pin.GeometryObject) -> Array:
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
