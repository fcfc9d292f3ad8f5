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
def rolling_acceleration(
    position: Array,
    rotation: Array,
    velocity: Array,
    origin: Array,
    axes: Array,
    stiffness: float,
    damping: float,
    edge: Array,
    turned: Array,
    turning: Array,
    turn_acceleration: Array,
) -> Array:
    """Acceleration of a surface that turns about an edge of its own, along its y axis, as a reference turns.

    Seen from the edge, what is beyond the reference's turn is closed as by `closing_acceleration`, whose arguments the
    first ones are.

    Args:
        edge: A point of the edge, from the surface's origin, in its axes (3,) [m].
        turned: Rotation (3, 3) of the reference, flat where its z axis is vertical.
        turning, turn_acceleration: Its velocity and acceleration (6,), of which the angular parts count.
    """
    angle, rate, bend = np.arctan2(-turned[2, 0], turned[2, 2]), 0.0, 0.0
    for k in range(3):
        rate += turned[k, 1] * turning[3 + k]
        bend += turned[k, 1] * turn_acceleration[3 + k]
    cosine, sine = np.cos(angle), np.sin(angle)
    flat, place, lever = np.empty((3, 3)), np.empty(3), np.empty(3)  # the lever leads from the edge to the origin
    for k in range(3):
        flat[k, 0] = cosine * rotation[k, 0] + sine * rotation[k, 2]
        flat[k, 1] = rotation[k, 1]
        flat[k, 2] = cosine * rotation[k, 2] - sine * rotation[k, 0]
        lever[k] = -(rotation[k, 0] * edge[0] + rotation[k, 1] * edge[1] + rotation[k, 2] * edge[2])
        place[k] = position[k] - lever[k]
    spin, beyond, none = velocity[3:].copy(), velocity.copy(), np.zeros(6)
    beyond[:3] -= np.cross(spin, lever)
    beyond[3:] -= rate * rotation[:, 1]
    wanted = closing_acceleration(place, flat, beyond, origin, axes, stiffness, damping, none, 0.0)
    wanted[3:] += bend * rotation[:, 1]
    wanted[:3] += np.cross(wanted[3:].copy(), lever) + np.cross(spin, np.cross(spin, lever))
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
