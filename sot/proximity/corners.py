"""A second point of each pair of shapes: the corner that has been the nearest before, or is going to be."""

from typing import NamedTuple

import numpy as np

from solvers.compiled import compiled
from sot.proximity.movement import moved_along, speed_along

Array = np.ndarray

DISTANCE_TOLERANCE = 1e-4
"""Distance [m] by which a second point may be nearer than the nearest one along the same normal: what is nearer is no
point of that face any more."""


class Corners(NamedTuple):
    """What is remembered of n pairs.

    Attributes:
        nearest: Nearest points of both shapes when they were last told, each in its shape's axes (n, 2, 3) [m].
        second: The second points, likewise.
        is_told: Whether there is any of the first, and of the second kind (n, 2).
        points: Places of both shapes' second points, world axes (n, 2, 3) [m].
        distances: Of the second points along the normals of the nearest ones (n,) [m].
    """

    nearest: Array
    second: Array
    is_told: Array
    points: Array
    distances: Array

    @staticmethod
    def of(pairs: int) -> "Corners":
        """Nothing, of so many pairs."""
        nearest, second = np.zeros((2, pairs, 2, 3))
        return Corners(nearest, second, np.zeros((pairs, 2), dtype=np.bool_), np.zeros((pairs, 2, 3)), np.zeros(pairs))


@compiled
def second_corners(
    indices: Array,
    pairs: Array,
    least: float,
    rotations: Array,
    translations: Array,
    distances: Array,
    normals: Array,
    points: Array,
    to_rotations: Array,
    to_translations: Array,
    to_distances: Array,
    to_normals: Array,
    to_points: Array,
    nearest: Array,
    second: Array,
    is_told: Array,
    at: Array,
    apart: Array,
) -> Array:
    """Whether some of the pairs have a second point (n,).

    Where the nearest point has jumped since it was told last, the old one is remembered, and where it is going to jump,
    the new one.

    Args:
        indices: Shapes of all pairs (pairs, 2).
        pairs: Which of them (n,).
        least: Distance from the nearest point within which there is no second one [m].
        rotations, translations, distances, normals, points: Places of the shapes now, and what was measured.
        to_rotations, to_translations, to_distances, to_normals, to_points: The same later.
        nearest, second, is_told, at, apart: See `Corners`; they are written.
    """
    has = np.zeros(len(pairs), np.bool_)
    own, there, world = np.empty((2, 3)), np.empty((2, 3)), np.empty((2, 3))
    for n in range(len(pairs)):
        pair = pairs[n]
        for side in range(2):
            shape = indices[pair, side]
            for i in range(3):
                own[side, i] = there[side, i] = 0.0
                for k in range(3):
                    now, later = points[pair, k], to_points[pair, k]
                    if side == 0:
                        now, later = (
                            now - distances[pair] * normals[pair, k],
                            later - to_distances[pair] * to_normals[pair, k],
                        )
                    own[side, i] += rotations[shape, k, i] * (now - translations[shape, k])
                    there[side, i] += to_rotations[shape, k, i] * (later - to_translations[shape, k])
        if is_told[pair, 0] and _far(own[1], nearest[pair, 1], least):
            second[pair], is_told[pair, 1] = nearest[pair], True
        if to_distances[pair] > 0.0 and _far(own[1], there[1], least):
            second[pair], is_told[pair, 1] = there, True
        nearest[pair], is_told[pair, 0] = own, True
        if not is_told[pair, 1]:
            continue
        for side in range(2):
            shape = indices[pair, side]
            for i in range(3):
                world[side, i] = translations[shape, i]
                for k in range(3):
                    world[side, i] += rotations[shape, i, k] * second[pair, side, k]
        apart[pair] = 0.0
        for i in range(3):
            apart[pair] += normals[pair, i] * (world[1, i] - world[0, i])
        beyond = apart[pair] - distances[pair]
        has[n] = -DISTANCE_TOLERANCE < beyond < least and _far(own[1], second[pair, 1], least)
        at[pair] = world
    return has


@compiled
def corner_motion(
    indices: Array,
    pairs: Array,
    normals: Array,
    points: Array,
    J: Array,
    v: Array,
    period: float,
    relative_motion: Array,
    twists: Array,
    rotations: Array,
    translations: Array,
    to_rotations: Array,
    to_translations: Array,
) -> tuple[Array, Array, Array]:
    """Jacobian (n, nv), rates (n,) and J̇ v (n,) of the distances between points of some pairs, along normals that stay.

    Args:
        indices: Shapes of all pairs (pairs, 2).
        pairs: Which of them (n,).
        normals, points: Of all pairs: from the first shapes to the second ones (pairs, 3), and a point of each of both
            (pairs, 2, 3).
        J, v, relative_motion: See `movement.distance_jacobian`.
        period: In which the points are carried along [s].
        twists: Of the bodies after it (n, 2, 6).
        rotations, translations, to_rotations, to_translations: Places of the shapes now and after it.
    """
    out, rates, drifts = np.zeros((len(pairs), J.shape[1])), np.zeros(len(pairs)), np.empty(len(pairs))
    for n in range(len(pairs)):
        pair = pairs[n]
        for i in range(J.shape[1]):
            if relative_motion[pair, i] != 0.0:
                side = 1 if relative_motion[pair, i] > 0.0 else 0
                out[n, i] = relative_motion[pair, i] * speed_along(normals[pair], J[:, i], points[pair, side])
                rates[n] += out[n, i] * v[i]
        ahead = 0.0
        for side in range(2):
            shape = indices[pair, side]
            there = moved_along(points[pair, side], shape, rotations, translations, to_rotations, to_translations)
            ahead += (2 * side - 1) * speed_along(normals[pair], twists[n, side], there)
        drifts[n] = (ahead - rates[n]) / period
    return out, rates, drifts


@compiled
def _far(here: Array, there: Array, least: float) -> bool:
    """Whether two places (3,) are farther apart than a distance."""
    square = 0.0
    for i in range(3):
        square += (here[i] - there[i]) ** 2
    return bool(square > least**2)
