"""Nearest points of rounded shapes in closed form: a segment or a box, its core, and all within a radius of that.

Spheres and capsules are rounded segments, boxes have the radius 0. Distances of two rounded shapes are those of their
cores less the radii, also where they overlap, as long as the cores do not. Two boxes are left to a general solver.
"""

from collections.abc import Sequence
from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin

from solvers.compiled import compiled

Array = np.ndarray
Point = tuple[float, float, float]

GENERAL, SEGMENT, BOX = range(3)
"""Kinds of cores: none that is known here, a segment along the shape's z axis, a box along its axes."""
MIN_CORE_DISTANCE = 1e-9
"""Distance [m] of two cores below which the direction from one to the other is not told."""
MAX_PARALLEL_SINE_SQUARED = 1e-12
"""Squared sine of the angle between two segments below which they count as parallel."""


class Cores(NamedTuple):
    """The cores of m shapes.

    Attributes:
        kinds: GENERAL, SEGMENT or BOX (m,).
        halves: Half lengths of the cores along the shapes' axes (m, 3) [m].
        radii: (m,) [m].
    """

    kinds: Array
    halves: Array
    radii: Array

    @staticmethod
    def of(shapes: Sequence[pin.GeometryObject]) -> "Cores":
        """Those of shapes."""
        cores = Cores(np.full(len(shapes), GENERAL), np.zeros((len(shapes), 3)), np.zeros(len(shapes)))
        for k, shape in enumerate(shapes):
            match shape.geometry:
                case coal.Sphere() as sphere:
                    cores.kinds[k], cores.radii[k] = SEGMENT, sphere.radius
                case coal.Capsule() as capsule:
                    cores.kinds[k], cores.radii[k], cores.halves[k, 2] = SEGMENT, capsule.radius, capsule.halfLength
                case coal.Box() as box:
                    cores.kinds[k], cores.halves[k] = BOX, box.halfSide
        return cores


@compiled
def measure_cores(
    indices: Array,
    pairs: Array,
    kinds: Array,
    halves: Array,
    radii: Array,
    rotations: Array,
    translations: Array,
    distances: Array,
    normals: Array,
    points: Array,
) -> bool:
    """Write what is between the shapes of some pairs; returns whether all of it could be told.

    Args:
        indices: Shapes of all pairs (pairs, 2).
        pairs: Which of them to measure (n,).
        kinds, halves, radii: See `Cores`.
        rotations, translations: Of the shapes, (m, 3, 3) and (m, 3).
        distances, normals, points: What is written, of all pairs: distances, negative where shapes overlap and nan
            where they could not be told, (pairs,) [m]; normals from the first shapes to the second ones and nearest
            points of these, world axes, (pairs, 3).
    """
    all_told = True
    for pair in pairs:
        first, second = indices[pair]
        if kinds[first] == SEGMENT and kinds[second] == SEGMENT:
            here, there = _nearest_of_segments(
                *(_place(translations, first), _axis(rotations, first), halves[first, 2]),
                *(_place(translations, second), _axis(rotations, second), halves[second, 2]),
            )
        elif kinds[first] == SEGMENT and kinds[second] == BOX:
            here, there = _nearest_of_segment_and_box(first, second, halves, rotations, translations)
        elif kinds[first] == BOX and kinds[second] == SEGMENT:
            there, here = _nearest_of_segment_and_box(second, first, halves, rotations, translations)
        else:
            here = there = _place(translations, second)
        x, y, z = there[0] - here[0], there[1] - here[1], there[2] - here[2]
        apart = np.sqrt(x * x + y * y + z * z)
        if apart < MIN_CORE_DISTANCE:
            distances[pair], all_told = np.nan, False
            continue
        distances[pair] = apart - radii[first] - radii[second]
        normal, point, radius = normals[pair], points[pair], radii[second]
        normal[0], normal[1], normal[2] = x / apart, y / apart, z / apart
        for i in range(3):
            point[i] = there[i] - radius * normal[i]
    return all_told


@compiled
def _nearest_of_segments(p: Point, u: Point, half: float, q: Point, v: Point, other_half: float) -> tuple[Point, Point]:
    """Nearest points of two segments about p and q, along the unit vectors u and v."""
    d = p[0] - q[0], p[1] - q[1], p[2] - q[2]
    cosine, along, along_other = _dot(u, v), _dot(u, d), _dot(v, d)
    sine_squared = 1.0 - cosine * cosine
    s = 0.0
    if sine_squared > MAX_PARALLEL_SINE_SQUARED:
        s = min(max((cosine * along_other - along) / sine_squared, -half), half)
    t = min(max(cosine * s + along_other, -other_half), other_half)
    s = min(max(cosine * t - along, -half), half)
    return (
        (p[0] + s * u[0], p[1] + s * u[1], p[2] + s * u[2]),
        (q[0] + t * v[0], q[1] + t * v[1], q[2] + t * v[2]),
    )


@compiled
def _nearest_of_segment_and_box(
    segment: int, box: int, halves: Array, rotations: Array, translations: Array
) -> tuple[Point, Point]:
    """Nearest points of a segment and a box, shapes of these numbers.

    Half the square of the distance to the box is convex along the segment, and its slope piecewise linear: it bends
    where the segment crosses one of the planes of the box's sides.
    """
    at, axis, origin = _place(translations, segment), _axis(rotations, segment), _place(translations, box)
    R, half = rotations[box], halves[segment, 2]
    centre, along, ends = np.empty(3), np.empty(3), np.empty(8)
    ends[0], count = -half, 1
    for i in range(3):
        centre[i] = along[i] = 0.0
        for k in range(3):
            centre[i] += R[k, i] * (at[k] - origin[k])
            along[i] += R[k, i] * axis[k]
        for side in (-halves[box, i], halves[box, i]):
            if abs(side - centre[i]) < half * abs(along[i]):
                ends[count] = (side - centre[i]) / along[i]
                count += 1
    ends[count] = half
    ends[1:count].sort()
    t, slope = -half, _slope(centre, along, halves[box], -half)
    for n in range(1, count + 1):
        if slope >= 0.0:
            break
        after = _slope(centre, along, halves[box], ends[n])
        t = ends[n] if after <= 0.0 else t - slope * (ends[n] - t) / (after - slope)
        slope = after
    x, y, z = origin
    for i in range(3):
        inside = min(max(centre[i] + t * along[i], -halves[box, i]), halves[box, i])
        x, y, z = x + R[0, i] * inside, y + R[1, i] * inside, z + R[2, i] * inside
    return (at[0] + t * axis[0], at[1] + t * axis[1], at[2] + t * axis[2]), (x, y, z)


@compiled
def _slope(centre: Array, along: Array, half: Array, t: float) -> float:
    """Slope, along a line, of half the squared distance to a box about the origin."""
    slope = 0.0
    for i in range(3):
        x = centre[i] + t * along[i]
        slope += along[i] * (x - min(max(x, -half[i]), half[i]))
    return slope


@compiled
def _place(translations: Array, shape: int) -> Point:
    return translations[shape, 0], translations[shape, 1], translations[shape, 2]


@compiled
def _axis(rotations: Array, shape: int) -> Point:
    return rotations[shape, 0, 2], rotations[shape, 1, 2], rotations[shape, 2, 2]


@compiled
def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
