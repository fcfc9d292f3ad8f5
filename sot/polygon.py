"""Convex polygons on the floor."""

from dataclasses import dataclass

import numpy as np

from solvers.compiled import compiled

Array = np.ndarray

POINT_GRID_M = 2.0**-40
"""Points nearer to each other than this count as one [m]."""

CORNER_GRID_M, PARALLEL_BELOW = 1e-9, 1e-9
"""Grid of corners [m], within which a corner may be outside; sine of an angle between edges that never meet."""


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
        """The convex hull of points (m, 2), which must not all lie on one line."""
        return cls(*_hull_edges(np.ascontiguousarray(points)))

    @property
    def vertices(self) -> Array:
        """Corners, counter-clockwise, shape (k, 2) [m]; none if the polygon is empty."""
        corners = _corners(np.ascontiguousarray(self.normals), np.ascontiguousarray(self.offsets))
        around = corners - corners.mean(axis=0) if len(corners) else corners
        order: Array = corners[np.argsort(np.arctan2(around[:, 1], around[:, 0]))]
        return order

    @property
    def centre(self) -> Array:
        """Mean of the vertices (2,) [m]."""
        return self.vertices.mean(axis=0)

    def margin(self, points: Array) -> Array:
        """Distance of points (..., 2) to the nearest edge's line [m], negative outside."""
        return np.min(self.offsets - points @ self.normals.T, axis=-1)

    def shrunk(self, x: float, y: float, heading: float = 0.0) -> "Polygon":
        """The polygon with edges moved inward by up to x along X and y along Y of axes turned by a heading [rad]."""
        cosine, sine = np.cos(heading), np.sin(heading)
        along, across = self.normals @ [cosine, sine], self.normals @ [-sine, cosine]
        return Polygon(self.normals, self.offsets - np.hypot(along * x, across * y))

    def inset(self, by: float) -> "Polygon":
        """The polygon with its edges moved inward by a distance [m]."""
        return Polygon(self.normals, self.offsets - by)

    def nearest_point(self, point: Array) -> Array:
        """The point of the polygon that is nearest to a point (2,); the point itself if the polygon is empty."""
        return nearest_point(self.normals, self.offsets, point)


WHOLE_FLOOR = Polygon(np.zeros((0, 2)), np.zeros(0))
"""The whole floor."""


@compiled
def nearest_point(normals: Array, offsets: Array, point: Array) -> Array:
    """`Polygon.nearest_point`."""
    x, y = point[0], point[1]
    best_x, best_y, least = x, y, np.inf
    for k in range(len(normals)):
        nx, ny = normals[k, 0], normals[k, 1]
        excess = nx * x + ny * y - offsets[k]
        if excess <= 0.0:
            continue
        # Along the edge's line, from the projection of the point, how far the other edges let it go.
        on_x, on_y = x - excess * nx, y - excess * ny
        low, high, exists = -np.inf, np.inf, True
        for j in range(len(normals)):
            slope = normals[j, 1] * nx - normals[j, 0] * ny
            room = offsets[j] - normals[j, 0] * on_x - normals[j, 1] * on_y
            if slope > 1e-9:
                high = min(high, room / slope)
            elif slope < -1e-9:
                low = max(low, room / slope)
            elif room < -1e-9:
                exists = False
        shift = min(max(0.0, low), high)
        if exists and low <= high + 1e-9 and excess**2 + shift**2 < least:
            best_x, best_y, least = on_x - shift * ny, on_y + shift * nx, excess**2 + shift**2
    return np.array((best_x, best_y))


@compiled
def _corners(normals: Array, offsets: Array) -> Array:
    """Where two edges' lines meet inside all others (k, 2), on a grid of CORNER_GRID_M, by x, then y, each once."""
    corners, count = np.empty((len(offsets) * (len(offsets) - 1) // 2, 2)), 0
    for i in range(len(offsets)):
        for j in range(i + 1, len(offsets)):
            turn = normals[i, 0] * normals[j, 1] - normals[i, 1] * normals[j, 0]
            if not abs(turn) > PARALLEL_BELOW:
                continue
            x = (offsets[i] * normals[j, 1] - normals[i, 1] * offsets[j]) / turn
            y = (normals[i, 0] * offsets[j] - offsets[i] * normals[j, 0]) / turn
            is_inside = True
            for k in range(len(offsets)):
                is_inside = is_inside and offsets[k] - normals[k, 0] * x - normals[k, 1] * y > -CORNER_GRID_M
            if not is_inside:
                continue
            x, y = np.rint(x / CORNER_GRID_M) * CORNER_GRID_M, np.rint(y / CORNER_GRID_M) * CORNER_GRID_M
            place = count
            while place and (corners[place - 1, 0] > x or (corners[place - 1, 0] == x and corners[place - 1, 1] > y)):
                place -= 1
            if place and corners[place - 1, 0] == x and corners[place - 1, 1] == y:
                continue
            for k in range(count, place, -1):
                corners[k, 0], corners[k, 1] = corners[k - 1, 0], corners[k - 1, 1]
            corners[place, 0], corners[place, 1] = x, y
            count += 1
    return corners[:count]


@compiled
def _hull_edges(points: Array) -> tuple[Array, Array]:
    """Normals and offsets of the hull's edges: sorted by x, then y, points form a lower and an upper chain (Andrew)."""
    points = _sorted_on_grid(points)
    corners, count = np.empty((2 * len(points), 2)), 0
    for way in (1, -1):
        first = count
        for n in range(len(points)):
            k = n if way > 0 else len(points) - 1 - n
            x, y = points[k, 0], points[k, 1]
            while count - first >= 2 and _turn_direction(corners, count, x, y) <= 0.0:
                count -= 1
            corners[count, 0], corners[count, 1] = x, y
            count += 1
        count -= 1  # the last corner of a chain is the first of the other
    normals, offsets = np.empty((count, 2)), np.empty(count)
    for k in range(count):
        next = (k + 1) % count
        x, y = corners[next, 1] - corners[k, 1], corners[k, 0] - corners[next, 0]
        length = np.sqrt(x * x + y * y)
        normals[k, 0], normals[k, 1] = x / length, y / length
        offsets[k] = (x * corners[k, 0] + y * corners[k, 1]) / length
    return normals, offsets


@compiled
def _sorted_on_grid(points: Array) -> Array:
    """Points by x, then y, on a grid: so that differences are exact, and lines found to be lines."""
    out = np.empty_like(points)
    for k in range(len(points)):
        x, y = np.rint(points[k, 0] / POINT_GRID_M) * POINT_GRID_M, np.rint(points[k, 1] / POINT_GRID_M) * POINT_GRID_M
        place = k
        while place and (out[place - 1, 0] > x or (out[place - 1, 0] == x and out[place - 1, 1] > y)):
            out[place, 0], out[place, 1] = out[place - 1, 0], out[place - 1, 1]
            place -= 1
        out[place, 0], out[place, 1] = x, y
    return out


@compiled
def _turn_direction(corners: Array, count: int, x: float, y: float) -> float:
    """Positive if the way over the last two of so many corners to (x, y) turns left."""
    ax, ay, bx, by = corners[count - 2, 0], corners[count - 2, 1], corners[count - 1, 0], corners[count - 1, 1]
    return (bx - ax) * (y - by) - (by - ay) * (x - bx)
