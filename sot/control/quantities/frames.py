"""Frames: where a point of a body is and how it moves, on its own and relative to another body."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.robots.surface import INWARD, Surface

Array = np.ndarray


@dataclass(slots=True)
class FrameState:
    """State of a frame of the robot, in world axes.

    Args:
        position: Origin, shape (3,) [m].
        rotation: Axes in the world, shape (3, 3).
        velocity: Linear velocity of the origin and angular velocity, world axes, shape (6,) [m/s, rad/s].
        jacobian: ``velocity = J v``, shape (6, nv).
        drift: J̇ v, the classical acceleration of the frame when v̇ is zero, shape (6,) [m/s², rad/s²].
    """

    position: Array
    rotation: Array
    velocity: Array
    jacobian: Array
    drift: Array

    def floor_projection(self, points: Array) -> Array:
        """Horizontal positions (n, 2) in the world of points (n, 3) of the frame [m]."""
        places: Array = _horizontal_places(self.position, self.rotation, points)
        return places


@compiled
def _horizontal_places(position: Array, rotation: Array, points: Array) -> Array:
    """`FrameState.floor_projection`."""
    places = np.empty((len(points), 2))
    for k in range(len(points)):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        for i in range(2):
            places[k, i] = position[i] + (rotation[i, 0] * x + rotation[i, 1] * y + rotation[i, 2] * z)
    return places


def moving_velocities(model: pin.Model, frame: int) -> tuple[np.ndarray, int]:
    """Indices of the velocities that move a frame, from the root outwards; how many of them a free root has."""
    joints = [joint for joint in model.supports[model.frames[frame].parentJoint] if joint]
    moving = [model.idx_vs[joint] + k for joint in joints for k in range(model.nvs[joint])]
    return np.array(moving, dtype=int), 6 if joints and model.nvs[joints[0]] == 6 else 0


class RelativeMotion:
    """Motion of a surface's origin relative to the material point of another's body that is there.

    Args:
        surface: Of a robot or thing.
        on: The other one.
        nv: Number of velocities.
    """

    def __init__(self, surface: Surface, on: Surface, nv: int) -> None:
        self._turn, self._offset = surface.placement.rotation @ INWARD, surface.placement.translation
        self._is_own = on.point is None and not self._offset.any() and np.array_equal(self._turn, np.eye(3))
        self._state = FrameState(np.empty(3), np.empty((3, 3)), np.empty(6), np.empty((6, nv)), np.empty(6))
        self._world = FrameState(np.zeros(3), np.eye(3), np.zeros(6), np.zeros((6, 0)), np.zeros(6))

    def state(self, own: FrameState, other: FrameState | None) -> FrameState:
        """Its state, in world axes, from those of the two surfaces' points; `other` is None for the world.

        The rotation is the one of the surface's axes turned so that z points into its body: for a sole, the foot's.
        """
        if self._is_own:
            return own
        at = self._state
        there = other if other is not None else self._world
        _write_relative_frame(
            *(own.position, own.rotation, own.velocity, own.jacobian, own.drift, self._offset, self._turn),
            *(there is other, there.position, there.velocity, there.jacobian, there.drift),
            *(at.position, at.rotation, at.velocity, at.jacobian, at.drift),
        )
        return at


@compiled
def write_placed_axes(
    position: Array, rotation: Array, offset: Array, turn: Array, to_origin: Array, to_axes: Array
) -> None:
    """Write origin (3,) and axes (3, 3) in the world of what has an offset and axes in a frame."""
    for i in range(3):
        to_origin[i] = position[i]
        for k in range(3):
            to_origin[i] += rotation[i, k] * offset[k]
            to_axes[i, k] = rotation[i, 0] * turn[0, k] + rotation[i, 1] * turn[1, k] + rotation[i, 2] * turn[2, k]


@compiled
def _write_relative_frame(
    position: Array,
    rotation: Array,
    velocity: Array,
    jacobian: Array,
    drift: Array,
    offset: Array,
    turn: Array,
    other_moves: bool,
    other_position: Array,
    other_velocity: Array,
    other_jacobian: Array,
    other_drift: Array,
    to_position: Array,
    to_rotation: Array,
    to_velocity: Array,
    to_jacobian: Array,
    to_drift: Array,
) -> None:
    """Write the motion of a point of a frame's body, given at an offset (3,) and with axes (3, 3) in the frame.

    If another frame moves, it is the motion relative to the point of that one's body that is there.
    """
    write_placed_axes(position, rotation, offset, turn, to_position, to_rotation)
    for i in range(6):
        to_velocity[i] = to_drift[i] = 0.0
        for k in range(to_jacobian.shape[1]):
            to_jacobian[i, k] = 0.0
    _add_material_point(position, velocity, jacobian, drift, 1.0, to_position, to_velocity, to_jacobian, to_drift)
    if other_moves:
        _add_material_point(
            other_position,
            other_velocity,
            other_jacobian,
            other_drift,
            -1.0,
            to_position,
            to_velocity,
            to_jacobian,
            to_drift,
        )


@compiled
def _add_material_point(
    position: Array,
    velocity: Array,
    jacobian: Array,
    drift: Array,
    sign: float,
    at: Array,
    to_velocity: Array,
    to_jacobian: Array,
    to_drift: Array,
) -> None:
    x, y, z = at[0] - position[0], at[1] - position[1], at[2] - position[2]
    a, b, c = velocity[3], velocity[4], velocity[5]
    u, v, w = b * z - c * y, c * x - a * z, a * y - b * x  # the point's velocity from the turning of the frame
    to_velocity[0] += sign * (velocity[0] + u)
    to_velocity[1] += sign * (velocity[1] + v)
    to_velocity[2] += sign * (velocity[2] + w)
    d, e, f = drift[3], drift[4], drift[5]
    to_drift[0] += sign * (drift[0] + e * z - f * y + b * w - c * v)
    to_drift[1] += sign * (drift[1] + f * x - d * z + c * u - a * w)
    to_drift[2] += sign * (drift[2] + d * y - e * x + a * v - b * u)
    for i in range(3):
        to_velocity[3 + i] += sign * velocity[3 + i]
        to_drift[3 + i] += sign * drift[3 + i]
    for k in range(jacobian.shape[1]):
        d, e, f = jacobian[3, k], jacobian[4, k], jacobian[5, k]
        to_jacobian[0, k] += sign * (jacobian[0, k] + e * z - f * y)
        to_jacobian[1, k] += sign * (jacobian[1, k] + f * x - d * z)
        to_jacobian[2, k] += sign * (jacobian[2, k] + d * y - e * x)
        to_jacobian[3, k] += sign * d
        to_jacobian[4, k] += sign * e
        to_jacobian[5, k] += sign * f


@compiled
def write_point_motion(
    J: Array,
    v: Array,
    moving_velocities: Array,
    free: int,
    position: Array,
    velocity: Array,
    jacobian: Array,
    drift: Array,
) -> None:
    """Write a point's velocity, Jacobian and drift, from the joints' Jacobian J with twists about the world's origin.

    A joint's axis is carried by what it turns: ``J̇_k = V × J_k`` with the twist V (linear, angular) of the body before
    it; the `free` ones of a free root together carry themselves, ``V × V = 0``.
    """
    px, py, pz = position[0], position[1], position[2]
    twist, change = np.zeros(6), np.zeros(6)
    for n in range(len(moving_velocities)):
        k = moving_velocities[n]
        x, y, z, a, b, c = J[0, k], J[1, k], J[2, k], J[3, k], J[4, k], J[5, k]
        jacobian[0, k], jacobian[1, k], jacobian[2, k] = x + b * pz - c * py, y + c * px - a * pz, z + a * py - b * px
        jacobian[3, k], jacobian[4, k], jacobian[5, k] = a, b, c
        x, y, z, a, b, c = x * v[k], y * v[k], z * v[k], a * v[k], b * v[k], c * v[k]
        if n >= free:
            u, w = twist[:3], twist[3:]
            change[0] += w[1] * z - w[2] * y + u[1] * c - u[2] * b
            change[1] += w[2] * x - w[0] * z + u[2] * a - u[0] * c
            change[2] += w[0] * y - w[1] * x + u[0] * b - u[1] * a
            change[3] += w[1] * c - w[2] * b
            change[4] += w[2] * a - w[0] * c
            change[5] += w[0] * b - w[1] * a
        twist[0] += x
        twist[1] += y
        twist[2] += z
        twist[3] += a
        twist[4] += b
        twist[5] += c
    _write_shifted_twist(twist, position, velocity)
    _write_shifted_twist(change, position, drift)
    # What turns and moves on leaves its place on a curve.
    drift[0] += twist[4] * velocity[2] - twist[5] * velocity[1]
    drift[1] += twist[5] * velocity[0] - twist[3] * velocity[2]
    drift[2] += twist[3] * velocity[1] - twist[4] * velocity[0]


@compiled
def _write_shifted_twist(twist: Array, to: Array, out: Array) -> None:
    """Write a twist about the world's origin as one about the point `to`."""
    out[:] = twist
    out[0] += twist[4] * to[2] - twist[5] * to[1]
    out[1] += twist[5] * to[0] - twist[3] * to[2]
    out[2] += twist[3] * to[1] - twist[4] * to[0]
