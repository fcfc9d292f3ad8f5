"""Convex polygons on the floor."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

Array = np.ndarray


@dataclass(frozen=True)
class Polygon:
    """A convex region of the floor, {p : normals p <= offsets}.

    Args:
        normals: Outward unit normals of the edges, shape (n, 2).
        offsets: Their distances from the origin, shape (n,) [m].
    """

    normals: Array
    offsets: Array

    @classmethod
    def hull(cls, points: Array) -> "Polygon":
        """The convex hull of points (m, 2)."""
        _, unique = np.unique((equations := ConvexHull(points).equations).round(9), axis=0, return_index=True)
        return cls(equations[unique, :2], -equations[unique, 2])

    def margin(self, points: Array) -> Array:
        """Distance of points (..., 2) to the nearest edge's line [m], negative outside."""
        return np.min(self.offsets - points @ self.normals.T, axis=-1)

    def shrunk(self, x: float, y: float) -> "Polygon":
        """With its edges moved inward by up to x along X and y along Y."""
        return Polygon(self.normals, self.offsets - np.hypot(self.normals[:, 0] * x, self.normals[:, 1] * y))

    def nearest(self, point: Array, rounds: int = 8) -> Array:
        """The point of the polygon that is nearest to a point (2,), by Dykstra's alternating projections."""
        excess = self.normals @ point - self.offsets
        if excess.max() <= 0.0:
            return point
        position, corrections = point.copy(), np.zeros_like(self.normals)
        for _ in range(rounds):
            for k, normal in enumerate(self.normals):
                moved = position + corrections[k]
                beyond = max(float(normal @ moved - self.offsets[k]), 0.0)
                position = moved - beyond * normal
                corrections[k] = moved - position
        return position
