"""The coordinates in which motions are fitted: y = (base position, roll, pitch, yaw, joints), a vector of nv numbers.

Pinocchio's configuration holds a quaternion and its base velocity is in the base frame; splines and limits want a
vector space. The two agree away from a pitch of ±90°: a robot lying on its face is out of scope.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]


def to_configuration(y: Array) -> Array:
    """Pinocchio configurations (T, nv + 1) of coordinates (T, nv), with quaternions of continuous sign."""
    quaternion = Rotation.from_euler("ZYX", y[:, [5, 4, 3]]).as_quat()
    flips = np.sum(quaternion[1:] * quaternion[:-1], axis=1) < 0.0
    quaternion[1:][np.cumsum(flips) % 2 == 1] *= -1.0
    return np.hstack([y[:, :3], quaternion, y[:, 6:]])


def from_configuration(q: Array) -> Array:
    """Coordinates (T, nv) of Pinocchio configurations (T, nv + 1), with a continuous yaw."""
    yaw, pitch, roll = Rotation.from_quat(q[:, 3:7]).as_euler("ZYX").T
    return np.column_stack([q[:, :3], roll, pitch, np.unwrap(yaw), q[:, 7:]])


def to_velocity(y: Array, dy: Array) -> Array:
    """Pinocchio velocities (T, nv): linear and angular velocity of the base in the base frame, joint velocities."""
    linear = np.einsum("tji,tj->ti", to_rotation(y[:, 3:6]), dy[:, :3])
    angular = np.einsum("tij,tj->ti", rate_matrix(y[:, 3:6]), dy[:, 3:6])
    return np.hstack([linear, angular, dy[:, 6:]])


def to_acceleration(y: Array, dy: Array, ddy: Array) -> Array:
    """Pinocchio accelerations (T, nv): the time derivative of `to_velocity`."""
    v = to_velocity(y, dy)
    linear = np.einsum("tji,tj->ti", to_rotation(y[:, 3:6]), ddy[:, :3]) - np.cross(v[:, 3:6], v[:, :3])
    angular = np.einsum("tij,tj->ti", rate_matrix(y[:, 3:6]), ddy[:, 3:6])
    angular += np.einsum("tij,tj->ti", _rate_matrix_derivative(y[:, 3:6], dy[:, 3:6]), dy[:, 3:6])
    return np.hstack([linear, angular, ddy[:, 6:]])


def to_pinocchio(y: Array, dy: Array, ddy: Array) -> tuple[Array, Array, Array]:
    """q (T, nv + 1), v (T, nv) and a (T, nv) of coordinates and their derivatives, each (T, nv)."""
    return to_configuration(y), to_velocity(y, dy), to_acceleration(y, dy, ddy)


def to_rotation(rpy: Array) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll), (T, 3, 3) from base to world, from angles (T, 3)."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy.T), np.cos(rpy.T)
    R = np.empty((len(rpy), 3, 3))
    R[:, 0, 0], R[:, 0, 1], R[:, 0, 2] = cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr
    R[:, 1, 0], R[:, 1, 1], R[:, 1, 2] = sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr
    R[:, 2, 0], R[:, 2, 1], R[:, 2, 2] = -sp, cp * sr, cp * cr
    return R


def rate_matrix(rpy: Array) -> Array:
    """E (T, 3, 3) with ω = E (roll, pitch, yaw)˙, ω in the base frame, from angles (T, 3)."""
    (sr, sp), (cr, cp) = np.sin(rpy[:, :2].T), np.cos(rpy[:, :2].T)
    E = np.zeros((len(rpy), 3, 3))
    E[:, 0, 0] = 1.0
    E[:, 0, 2] = -sp
    E[:, 1, 1], E[:, 1, 2] = cr, sr * cp
    E[:, 2, 1], E[:, 2, 2] = -sr, cr * cp
    return E


def _rate_matrix_derivative(rpy: Array, rates: Array) -> Array:
    (sr, sp), (cr, cp) = np.sin(rpy[:, :2].T), np.cos(rpy[:, :2].T)
    dr, dp = rates[:, 0], rates[:, 1]
    E = np.zeros((len(rpy), 3, 3))
    E[:, 0, 2] = -cp * dp
    E[:, 1, 1], E[:, 1, 2] = -sr * dr, cr * cp * dr - sr * sp * dp
    E[:, 2, 1], E[:, 2, 2] = -cr * dr, -sr * cp * dr - cr * sp * dp
    return E
