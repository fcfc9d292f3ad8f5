"""How shapes move: how much and how fast distances may change, and where shapes are after a period.

Twists are those of joints' bodies at the world's origin, linear over angular, world axes; J has the joints' own, as
Pinocchio keeps them.
"""

import numpy as np

from solvers.compiled import compiled
from sot.proximity.cores import measure_cores

Array = np.ndarray

SERIES_ANGLE = 1e-4
"""Angle [rad] below which the coefficients of a rotation are those of a series."""
MAX_SLIDE_SPEED = 5.0
"""Speed [m/s] at which a nearest point may slide along its shape; one that is faster has jumped to another corner."""


@compiled
def rate_bounds(
    J: Array,
    v: Array,
    parents: Array,
    starts: Array,
    counts: Array,
    joints: Array,
    rotations: Array,
    translations: Array,
    centres: Array,
    radii: Array,
    pairs: Array,
) -> Array:
    """Upper bounds of how fast the distances of pairs of shapes change, shape (n,) [m/s].

    Args:
        J, v: Twists of the joints, (6, nv), and velocities (nv,).
        parents, starts, counts: Of each joint: the one before it, its first velocity, and how many it has.
        joints: Of the shapes (m,).
        rotations, translations: Of the shapes, (m, 3, 3) and (m, 3).
        centres, radii: Of balls about the shapes, in their axes, (m, 3) and (m,).
        pairs: Of shapes (n, 2).
    """
    twists = np.zeros((len(parents), 6))
    for j in range(1, len(parents)):
        for i in range(6):
            twists[j, i] = twists[parents[j], i]
            for k in range(starts[j], starts[j] + counts[j]):
                twists[j, i] += J[i, k] * v[k]
    bounds = np.empty(len(pairs))
    for n in range(len(pairs)):
        first, second = pairs[n]
        one, other = twists[joints[first]], twists[joints[second]]
        x, y, z = _centre(second, rotations, translations, centres)
        a, b, c = other[3] - one[3], other[4] - one[4], other[5] - one[5]
        u = other[0] - one[0] + b * z - c * y
        w = other[1] - one[1] + c * x - a * z
        s = other[2] - one[2] + a * y - b * x
        bounds[n] = np.sqrt(u * u + w * w + s * s) + radii[second] * np.sqrt(a * a + b * b + c * c)
    return bounds


@compiled
def pairs_possibly_within(
    within: Array,
    distances: Array,
    poses: Array,
    rotations: Array,
    translations: Array,
    centres: Array,
    radii: Array,
    pairs: Array,
) -> Array:
    """Indices of the pairs that may be nearer than `within` (n,); the poses of these become the present ones.

    A distance has changed by no more than any point of the second shape has moved as seen from the first one.

    Args:
        distances, poses: Of the pairs when they were last measured (n,) [m]: and the second shape's axes and the centre
            of its ball, as seen from the first shape, (n, 12).
        rotations, translations, centres, radii, pairs: See `rate_bounds`.
    """
    near = np.zeros(len(pairs), np.bool_)
    pose = np.empty(12)
    for n in range(len(pairs)):
        if within[n] == -np.inf:
            continue
        first, second = pairs[n]
        x, y, z = _centre(second, rotations, translations, centres)
        x, y, z = x - translations[first, 0], y - translations[first, 1], z - translations[first, 2]
        turned = moved = 0.0
        for i in range(3):
            a, b, c = rotations[first, 0, i], rotations[first, 1, i], rotations[first, 2, i]
            for k in range(3):
                entry = a * rotations[second, 0, k] + b * rotations[second, 1, k] + c * rotations[second, 2, k]
                pose[3 * i + k] = entry
                turned += (entry - poses[n, 3 * i + k]) ** 2
            pose[9 + i] = a * x + b * y + c * z
            moved += (pose[9 + i] - poses[n, 9 + i]) ** 2
        # The change of a rotation by an angle moves a point at the distance 1 by 2 sin(angle / 2), and no further.
        if distances[n] - np.sqrt(moved) - radii[second] * np.sqrt(0.5 * turned) < within[n]:
            near[n] = True
            for i in range(12):
                poses[n, i] = pose[i]
    return np.flatnonzero(near)


@compiled
def distance_jacobian(
    normals: Array, points: Array, J: Array, v: Array, relative_motion: Array, pairs: Array
) -> tuple[Array, Array]:
    """Jacobian of the distances of some of the pairs (n, nv), and ``J v`` (n,).

    They come from normals and nearest points of the second shapes of all pairs.

    `relative_motion` says of each pair (n, nv) which velocities move the second shape alone, 1, and the first one, -1.
    """
    out, rates = np.empty((len(pairs), J.shape[1])), np.zeros(len(pairs))
    for n in range(len(pairs)):
        nx, ny, nz = normals[pairs[n]]
        x, y, z = points[pairs[n]]
        a, b, c = y * nz - z * ny, z * nx - x * nz, x * ny - y * nx
        for i in range(J.shape[1]):
            slope = nx * J[0, i] + ny * J[1, i] + nz * J[2, i] + a * J[3, i] + b * J[4, i] + c * J[5, i]
            out[n, i] = slope * relative_motion[pairs[n], i]
            rates[n] += out[n, i] * v[i]
    return out, rates


@compiled
def move_pairs(
    J: Array,
    v: Array,
    period: float,
    starts: Array,
    counts: Array,
    chains: Array,
    indices: Array,
    pairs: Array,
    rotations: Array,
    translations: Array,
    to_rotations: Array,
    to_translations: Array,
) -> Array:
    """Write where the joints' velocities, if they are kept, bring the shapes of some pairs within a period.

    Args:
        J, v, starts, counts: See `rate_bounds`.
        period: The period [s].
        chains: Joints that move each shape, from the root outwards, 0 after the last, (m, joints).
        indices: Shapes of all pairs (pairs, 2).
        pairs: Those that are moved (n,).
        rotations, translations: Of the shapes now, (m, 3, 3) and (m, 3).
        to_rotations, to_translations: These shapes' after the period.

    Returns:
        Twists of the shapes' bodies after the period, (n, 2, 6).
    """
    twists = np.zeros((len(pairs), 2, 6))
    turn, shift = np.empty((3, 3)), np.empty(3)  # of the body before the next joint
    for n in range(len(pairs)):
        for side in range(2):
            for i in range(3):
                shift[i] = 0.0
                for k in range(3):
                    turn[i, k] = 1.0 if i == k else 0.0
            shape = indices[pairs[n], side]
            for joint in chains[shape]:
                if not joint:
                    break
                x = y = z = a = b = c = 0.0
                for k in range(starts[joint], starts[joint] + counts[joint]):
                    x, y, z = x + J[0, k] * v[k], y + J[1, k] * v[k], z + J[2, k] * v[k]
                    a, b, c = a + J[3, k] * v[k], b + J[4, k] * v[k], c + J[5, k] * v[k]
                _add_moved_twist(twists[n, side], turn, shift, (x, y, z), (a, b, c))
                _append_exponential(
                    turn, shift, (period * x, period * y, period * z), (period * a, period * b, period * c)
                )
            x, y, z = _rotated(turn, translations[shape, 0], translations[shape, 1], translations[shape, 2])
            place, axes = to_translations[shape], to_rotations[shape]
            place[0], place[1], place[2] = x + shift[0], y + shift[1], z + shift[2]
            for k in range(3):
                axes[0, k], axes[1, k], axes[2, k] = _rotated(
                    turn, rotations[shape, 0, k], rotations[shape, 1, k], rotations[shape, 2, k]
                )
    return twists


@compiled
def distance_drifts(
    indices: Array,
    pairs: Array,
    twists: Array,
    rates: Array,
    period: float,
    rotations: Array,
    translations: Array,
    distances: Array,
    normals: Array,
    points: Array,
    to_rotations: Array,
    to_translations: Array,
    to_normals: Array,
    to_points: Array,
    max_slide_speed: float,
) -> Array:
    """J̇ v of the distances of some of the pairs (n,), by how their rates (n,) change within a period.

    Where the nearest point jumps to another corner meanwhile, the points that are the nearest now are carried along,
    and their normal stays: J is of those. The other's speed over a period would be an acceleration that no joint has.

    Args:
        indices: Shapes of all pairs (pairs, 2).
        pairs: Which of them (n,).
        twists: Of their bodies after the period (n, 2, 6).
        rates: J v now (n,).
        period: The period [s].
        rotations, translations, distances, normals, points: Places of the shapes now, and of all pairs distances,
            normals and nearest points of the second shapes.
        to_rotations, to_translations, to_normals, to_points: The same after the period.
        max_slide_speed: At which a nearest point may slide along its shape; a faster one has jumped [m/s].
    """
    drifts, carried, here = np.empty(len(pairs)), np.empty((2, 3)), np.empty(3)
    for n in range(len(pairs)):
        pair = pairs[n]
        for side in range(2):
            for i in range(3):
                here[i] = points[pair, i] - (distances[pair] * normals[pair, i] if side == 0 else 0.0)
            carried[side] = moved_along(
                here, indices[pair, side], rotations, translations, to_rotations, to_translations
            )
        x, y, z = to_points[pair]
        slide = np.sqrt((x - carried[1, 0]) ** 2 + (y - carried[1, 1]) ** 2 + (z - carried[1, 2]) ** 2)
        if slide > max_slide_speed * period:
            ahead = speed_along(normals[pair], twists[n, 1], carried[1])
            ahead -= speed_along(normals[pair], twists[n, 0], carried[0])
        else:
            ahead = speed_along(to_normals[pair], twists[n, 1] - twists[n, 0], to_points[pair])
        drifts[n] = (ahead - rates[n]) / period
    return drifts


@compiled
def moved_along(
    place: Array, shape: int, rotations: Array, translations: Array, to_rotations: Array, to_translations: Array
) -> Array:
    """Where a place (3,) on a shape is when that is elsewhere."""
    there = to_translations[shape].copy()
    for k in range(3):
        own = 0.0
        for i in range(3):
            own += rotations[shape, i, k] * (place[i] - translations[shape, i])
        for i in range(3):
            there[i] += to_rotations[shape, i, k] * own
    return there


@compiled
def speed_along(way: Array, twist: Array, place: Array) -> float:
    """Speed along a way (3,) of a place (3,) that moves with a twist (6,)."""
    u, v, w, a, b, c = twist
    x, y, z = place
    return way[0] * (u + b * z - c * y) + way[1] * (v + c * x - a * z) + way[2] * (w + a * y - b * x)


@compiled
def core_distance_motion(
    indices: Array,
    pairs: Array,
    kinds: Array,
    halves: Array,
    radii: Array,
    J: Array,
    v: Array,
    period: float,
    starts: Array,
    counts: Array,
    chains: Array,
    relative_motion: Array,
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
) -> tuple[bool, Array, Array, Array, Array]:
    """All of `DistanceMotion` in one call, for which measuring does without a general solver; and whether that did.

    For the arguments see `measure_cores`, `distance_jacobian` and `move_pairs`.
    """
    told = measure_cores(indices, pairs, kinds, halves, radii, rotations, translations, distances, normals, points)
    jacobian, rates = distance_jacobian(normals, points, J, v, relative_motion, pairs)
    twists = move_pairs(
        J, v, period, starts, counts, chains, indices, pairs, rotations, translations, to_rotations, to_translations
    )
    told &= measure_cores(
        indices, pairs, kinds, halves, radii, to_rotations, to_translations, to_distances, to_normals, to_points
    )
    drifts = distance_drifts(
        *(indices, pairs, twists, rates, period),
        *(rotations, translations, distances, normals, points),
        *(to_rotations, to_translations, to_normals, to_points, MAX_SLIDE_SPEED),
    )
    return told, distances[pairs], rates, jacobian, drifts


@compiled
def _centre(shape: int, rotations: Array, translations: Array, centres: Array) -> tuple[float, float, float]:
    """Centre of the ball about a shape, world axes."""
    x, y, z = _rotated(rotations[shape], centres[shape, 0], centres[shape, 1], centres[shape, 2])
    return translations[shape, 0] + x, translations[shape, 1] + y, translations[shape, 2] + z


@compiled
def _add_moved_twist(
    twist: Array, turn: Array, shift: Array, along: tuple[float, float, float], about: tuple[float, float, float]
) -> None:
    """Add to a twist (6,) another, (along, about), moved by a displacement (turn, shift)."""
    x, y, z = _rotated(turn, along[0], along[1], along[2])
    a, b, c = _rotated(turn, about[0], about[1], about[2])
    twist[0] += x + shift[1] * c - shift[2] * b
    twist[1] += y + shift[2] * a - shift[0] * c
    twist[2] += z + shift[0] * b - shift[1] * a
    twist[3] += a
    twist[4] += b
    twist[5] += c


@compiled
def _rotated(turn: Array, x: float, y: float, z: float) -> tuple[float, float, float]:
    return (
        turn[0, 0] * x + turn[0, 1] * y + turn[0, 2] * z,
        turn[1, 0] * x + turn[1, 1] * y + turn[1, 2] * z,
        turn[2, 0] * x + turn[2, 1] * y + turn[2, 2] * z,
    )


@compiled
def _append_exponential(
    turn: Array, shift: Array, along: tuple[float, float, float], about: tuple[float, float, float]
) -> None:
    """Multiply a displacement (turn, shift) from the right by the exponential of a twist (along, about)."""
    x, y, z = about
    square = x * x + y * y + z * z
    angle = np.sqrt(square)
    if angle < SERIES_ANGLE:
        sine, cosine, rest = 1.0 - square / 6.0, 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
    else:
        sine, cosine = np.sin(angle) / angle, (1.0 - np.cos(angle)) / square
        rest = (1.0 - sine) / square
    u, v, w = along
    a, b, c = y * w - z * v, z * u - x * w, x * v - y * u  # about × along
    own_shift = (
        u + cosine * a + rest * (y * c - z * b),
        v + cosine * b + rest * (z * a - x * c),
        w + cosine * c + rest * (x * b - y * a),
    )
    own_turn = (
        (1.0 - cosine * (y * y + z * z), cosine * x * y - sine * z, cosine * x * z + sine * y),
        (cosine * x * y + sine * z, 1.0 - cosine * (x * x + z * z), cosine * y * z - sine * x),
        (cosine * x * z - sine * y, cosine * y * z + sine * x, 1.0 - cosine * (x * x + y * y)),
    )
    for i in range(3):
        a, b, c = turn[i, 0], turn[i, 1], turn[i, 2]
        shift[i] += a * own_shift[0] + b * own_shift[1] + c * own_shift[2]
        for k in range(3):
            turn[i, k] = a * own_turn[0][k] + b * own_turn[1][k] + c * own_turn[2][k]
