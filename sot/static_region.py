"""Where the centre of mass may be for a body to rest on any supports: the static stability region."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from sot.errors import InputError
from sot.polygon import Polygon

Array = np.ndarray

TOLERANCE = 0.003
"""Distance by which the region may be told too small [m]."""
MAX_PROGRAMMES = 100
"""Number of linear programmes after which the region is as it is."""
MAX_DISTANCE = 2.0
"""Distance from the middle of the supports at which a region ends that has no end of its own [m]."""
METHODS = ("highs-ds", "highs-ipm")
"""Methods of SciPy's solver, the second for programmes that the first one calls infeasible by rounding."""
PYRAMID_SIDES = 8
"""Sides of the pyramids that stand for friction cones, inside of them."""


class Patch(NamedTuple):
    """A flat patch that carries.

    Attributes:
        points: Where its forces act (n, 3), world [m].
        axes: (3, 3), world; z points from what carries into the body.
        friction: Coulomb coefficient.
        most: Greatest normal force of all its points together [N].
    """

    points: Array
    axes: Array
    friction: float
    most: float = np.inf


def static_region(patches: Sequence[Patch], weight: float, tolerance: float = TOLERANCE) -> Polygon:
    """Places of the centre of mass, seen from above, at which forces on the patches hold a weight [N] at rest.

    With contact forces f at points p, Bretl & Lall (2008):

        Σ f = (0, 0, W),   Σ p × f = c × (0, 0, W),   f in its cone.

    That is convex in c. The region grows from the inside: each linear programme takes it as far as it goes in the
    direction in which most of it may be missing. On one level plane it is the hull of the points.

    Raises:
        InputError: No forces of these patches hold the weight.
    """
    ask = _Programme(patches, weight)
    directions = [np.array(way) for way in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))]
    places = [ask.farthest(direction) for direction in directions]
    while len(places) < MAX_PROGRAMMES:
        gaps = [_gap(directions[k - 1], places[k - 1], directions[k], places[k]) for k in range(len(places))]
        worst = int(np.argmax(gaps))
        if gaps[worst] <= tolerance:
            break
        along = places[worst] - places[worst - 1]
        outward = np.array([along[1], -along[0]]) / np.linalg.norm(along)
        directions.insert(worst, outward)
        places.insert(worst, ask.farthest(outward))
    return Polygon.hull(np.array(places))


def _gap(first: Array, here: Array, second: Array, there: Array) -> float:
    """How far the region may reach beyond the line between two of its places, farthest in two directions [m]."""
    along = there - here
    length = float(np.linalg.norm(along))
    turn = float(first[0] * second[1] - first[1] * second[0])
    if length < 1e-9 or turn < 1e-9:
        return 0.0
    # The corner where the two lines meet beyond which it does not reach.
    corner = (
        np.array([here @ first, there @ second]) @ np.array([[second[1], -second[0]], [-first[1], first[0]]]) / turn
    )
    return float((corner - here) @ np.array([along[1], -along[0]])) / length


class _Programme:
    """Linear programme in the edges' forces λ ≥ 0 [shares of the weight] and the place c of the centre of mass."""

    def __init__(self, patches: Sequence[Patch], weight: float) -> None:
        turns = 2.0 * np.pi * np.arange(PYRAMID_SIDES) / PYRAMID_SIDES
        points = np.vstack([patch.points for patch in patches])
        self._middle = points.mean(axis=0)
        columns, limits, bounds = [], [], []
        for number, patch in enumerate(patches):
            edges = np.column_stack(
                [patch.friction * np.cos(turns), patch.friction * np.sin(turns), np.ones(PYRAMID_SIDES)]
            )
            forces = edges @ patch.axes.T
            for point in patch.points - self._middle:
                columns.append(np.hstack([forces, np.cross(point, forces)]))
            limits += [number] * (PYRAMID_SIDES * len(patch.points))
            bounds.append(patch.most / weight)
        wrenches = np.vstack(columns).T
        place = np.zeros((6, 2))
        place[3, 1], place[4, 0] = -1.0, 1.0  # c × (0, 0, 1) = (c_y, −c_x, 0)
        self._equal = np.hstack([wrenches, place])
        self._wanted = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        limited = [k for k, bound in enumerate(bounds) if np.isfinite(bound)]
        self._load = np.array([[*(np.array(limits) == k), 0.0, 0.0] for k in limited], dtype=float)
        self._most = np.array([bounds[k] for k in limited])
        self._bounds = [(0.0, None)] * len(limits) + [(-MAX_DISTANCE, MAX_DISTANCE)] * 2

    def farthest(self, direction: Array) -> Array:
        """Place (2,) of the region that is farthest in a direction (2,) [m]."""
        cost = np.zeros(self._equal.shape[1])
        cost[-2:] = -direction
        for method in METHODS:
            found = linprog(
                cost,
                A_ub=self._load if len(self._most) else None,
                b_ub=self._most if len(self._most) else None,
                A_eq=self._equal,
                b_eq=self._wanted,
                bounds=self._bounds,
                method=method,
            )
            if found.status == 0:
                break
        else:
            raise InputError(
                "no forces of these supports hold the weight: friction is too small, or a hand bears too little"
            )
        place: Array = found.x[-2:] + self._middle[:2]
        return place
