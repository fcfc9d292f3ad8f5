"""Numbers of a contact: what acceleration lays it flat, what its forces amount to, and how they move the system."""

import numpy as np

from solvers.compiled import compiled

Array = np.ndarray


@compiled
def closing_acceleration(
    position: Array,
    rotation: Array,
    velocity: Array,
    origin: Array,
    axes: Array,
    stiffness: float,
    damping: float,
    arrival: Array,
    left: float,
) -> Array:
    """Acceleration that brings a surface, its z axis into its body, onto the plane of others, whose z is its normal.

    A share of the acceleration with which it arrived is left in it.
    """
    wanted = -damping * velocity
    x, y, z = axes[0, 2], axes[1, 2], axes[2, 2]
    gap = x * (position[0] - origin[0]) + y * (position[1] - origin[1]) + z * (position[2] - origin[2])
    wanted[0] -= stiffness * gap * x
    wanted[1] -= stiffness * gap * y
    wanted[2] -= stiffness * gap * z
    # The other's normal seen from one's own: n × e_z is the rotation that brings the surface flat.
    a, b, c = rotation[0, 2], rotation[1, 2], rotation[2, 2]
    wanted[3] += stiffness * (b * z - c * y)
    wanted[4] += stiffness * (c * x - a * z)
    wanted[5] += stiffness * (a * y - b * x)
    if left > 0.0:
        wanted += left * (arrival - wanted)
    return wanted


@compiled
def write_held_pyramids(
    position: Array,
    rotation: Array,
    velocity: Array,
    jacobian: Array,
    drift: Array,
    origin: Array,
    axes: Array,
    stiffness: float,
    damping: float,
    arrival: Array,
    left: float,
    corners: Array,
    scale: float,
    to_wanted: Array,
    to_place: Array,
    to_map: Array,
    to_motion: Array,
) -> bool:
    """Write what a fixed contact with forces at its corners asks for, see `Contact.write_rows`."""
    wanted = closing_acceleration(position, rotation, velocity, origin, axes, stiffness, damping, arrival, left)
    for k in range(6):
        to_wanted[k] = wanted[k] - drift[k]
    for k in range(3):
        to_place[k] = position[k]
    return write_wrench_map_and_motion_columns(jacobian, vertex_wrench_map(rotation, corners), scale, to_map, to_motion)


@compiled
def write_wrench_map_and_motion_columns(
    jacobian: Array, G: Array, scale: float, to_map: Array, to_motion: Array
) -> bool:
    """Write the wrench map G to `to_map`, and ``scale Jᵀ G`` to `to_motion`; returns whether G is finite."""
    total = 0.0  # nan as soon as a value is not finite
    for k in range(6):
        for j in range(G.shape[1]):
            to_map[k, j] = G[k, j]
            total += 0.0 * G[k, j]
    for i in range(to_motion.shape[0]):
        for j in range(to_motion.shape[1]):
            product = 0.0
            for k in range(6):
                product += jacobian[k, i] * G[k, j]
            to_motion[i, j] = scale * product
    return total == 0.0


@compiled
def vertex_wrench_map(rotation: Array, vertices: Array) -> Array:
    """Map from forces at the vertices, point's axes, to the wrench at the point, world axes: shape (6, 3 n)."""
    out = np.empty((6, 3 * len(vertices)))
    for k in range(len(vertices)):
        x, y, z = vertices[k]
        for i in range(3):
            a, b, c = rotation[i, 0], rotation[i, 1], rotation[i, 2]
            out[i, 3 * k], out[i, 3 * k + 1], out[i, 3 * k + 2] = a, b, c
            # The rows of R [p]×.
            out[3 + i, 3 * k], out[3 + i, 3 * k + 1], out[3 + i, 3 * k + 2] = (
                b * z - c * y,
                c * x - a * z,
                a * y - b * x,
            )
    return out
