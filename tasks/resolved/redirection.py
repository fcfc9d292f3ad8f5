"""Points of collision led along the surfaces they come near, Dariush (17)-(23)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from solvers import damped_inverse
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.resolved.pairs import Distances

Array = np.ndarray

CRITICAL_DISTANCE = 0.05
"""d_c of the paper [m]."""
BLENDING_RATE = 15.0
"""α of (23), the paper's."""
LEAST_SHARE = 0.01
"""Share of (23) below which a pair is left alone."""
PUSH_RATE = 10.0
"""Rate [1/s] at which mended redirection leads a distance that is too small back to the one that is kept."""
KEPT_DISTANCE = 0.01
"""Distance that mended redirection keeps [m]."""
RATE_TOLERANCE = 1e-4
"""Rate of a distance that counts as none [m/s]."""


def blending(ratio: float | Array, shift: float, rate: float = BLENDING_RATE) -> Array:
    """b of Dariush (23) for ``d / d_c``, with δ = shift: 1 of what touches, 0 of what is far."""
    value: Array = 1.0 / (1.0 + np.exp(rate * (np.asarray(ratio) - shift)))
    return value


@dataclass(frozen=True)
class CollisionPoints:
    """The nearest points of two shapes.

    Args:
        distance: Negative where they overlap [m].
        normal: n̂_a, from the first shape to the second, shape (3,).
        jacobians: Of the point of each shape, in the joints of the upper body alone, shapes (3, nv).
    """

    distance: float
    normal: Array
    jacobians: tuple[Array, Array]


class Redirection:
    """Joint velocities that lead the points of collision past each other, and task velocities blended with them.

    (18) takes the motion along the normal from a point of collision: it comes no nearer, and no further away.

    Args:
        robot: The robot; the base and the legs are no part of this.
        pairs: Indices of pairs of its shapes.
        shift: δ of (23).
        damping: λ of the inverse.
        mended: Whether (18) pushes out.
    """

    def __init__(self, robot: Robot, pairs: Sequence[int], shift: float, damping: float, mended: bool = False) -> None:
        self._robot, self._pairs, self._shift, self._damping, self._mended = robot, pairs, shift, damping, mended
        self._shapes = robot.shapes.copy()
        self._results = self._shapes.createData()
        self._upper = upper_body_velocities(robot)

    def nearest(self, tick: Tick) -> list[CollisionPoints]:
        """The points of each pair that is so near that (23) blends it."""
        pin.updateGeometryPlacements(self._robot.model, tick.data, self._shapes, self._results)
        found = []
        for k in self._pairs:
            result = pin.computeDistance(self._shapes, self._results, k)
            if blending(result.min_distance / CRITICAL_DISTANCE, self._shift) > LEAST_SHARE:
                pair = self._shapes.collisionPairs[k]
                places = (result.getNearestPoint1(), result.getNearestPoint2())
                jacobians = tuple(
                    self._upper
                    * point_jacobian(
                        self._robot.model, tick.data, self._shapes.geometryObjects[shape].parentJoint, place
                    )
                    for shape, place in zip((pair.first, pair.second), places, strict=True)
                )
                found.append(
                    CollisionPoints(result.min_distance, np.array(result.normal), (jacobians[0], jacobians[1]))
                )
        return found

    def joint_velocities(self, points: Sequence[CollisionPoints], velocities: Array) -> Array:
        """q̇' of (19): the joints that move the points of collision redirect them, the others go on."""
        if not points:
            return velocities
        wanted = [_redirected_motions(found, velocities) for found in points]
        stacked = np.vstack([jacobian for found in points for jacobian in found.jacobians])
        redirected = damped_inverse(stacked, self._damping) @ np.concatenate(wanted)
        return np.where(stacked.any(axis=0), redirected, velocities)

    def blended(self, tick: Tick, velocities: Array) -> tuple[Array, float, float]:
        """The q̇' of all pairs together, for the q̇ of (9); the largest b of (23); and the least distance [m]."""
        points = self.nearest(tick)
        least = min((found.distance for found in points), default=np.inf)
        share = float(blending(least / CRITICAL_DISTANCE, self._shift)) if points else 0.0
        return self.joint_velocities(points, velocities), share, least


def _redirected_motions(points: CollisionPoints, velocities: Array) -> Array:
    """ṗ'_a of (18), and the same of the other shape's point, shape (6,) [m/s]."""
    out = []
    for jacobian, sign in zip(points.jacobians, (1.0, -1.0), strict=True):
        motion, normal = jacobian @ velocities, sign * points.normal  # towards the other shape
        out.append(motion - (motion @ normal) * normal)
    return np.concatenate(out)


def kept_apart(distances: Distances, velocities: Array, moving: Array, damping: float) -> Array:
    """Joint velocities, nearest to given ones, at which no pair approaches faster than its distance allows: mended.

    (19) prescribes all of the motion of each pair's points, six rows a pair, and contradicts itself where several pairs
    are near. Here only the rate of a distance is prescribed, where it falls too fast: ``ḋ >= −κ (d − d_kept)``, which
    leads apart what is too near.

    Args:
        distances: Of the pairs.
        velocities: q̇ of the tasks, shape (nv,).
        moving: 1 of the velocities that may change, 0 of the others, shape (nv,).
        damping: λ of the inverse.
    """
    least = -PUSH_RATE * (distances.values - KEPT_DISTANCE)
    jacobian, kept = distances.jacobian * moving, velocities
    held = np.zeros(len(least), dtype=bool)
    for _ in range(len(least)):
        fast = distances.jacobian @ kept < least - RATE_TOLERANCE
        if not (fast & ~held).any():
            break
        held |= fast
        missing = least[held] - distances.jacobian[held] @ velocities
        kept = velocities + damped_inverse(jacobian[held], damping) @ missing
    return kept


def upper_body_velocities(robot: Robot) -> Array:
    """1 of the velocities of chest, head and arms, 0 of the others, shape (nv,)."""
    upper = np.zeros(robot.nv)
    for group in ("chest", "head", "arms"):
        upper[[6 + joint for joint in robot.groups[group]]] = 1.0
    return upper


def point_jacobian(model: pin.Model, data: pin.Data, joint: int, place: Array) -> Array:
    """Jacobian (3, nv) of a point of a joint's body, at a place in the world."""
    moves = np.zeros(model.nv)
    for k in model.supports[joint]:
        moves[model.idx_vs[k] : model.idx_vs[k] + model.nvs[k]] = 1.0
    linear, angular = data.J[:3], data.J[3:]
    jacobian: Array = moves * (linear + np.cross(angular.T, place).T)
    return jacobian
