"""Errors and rates of orientations, Hammam (12), Dariush (3), (4), (11)."""

import numpy as np

from solvers.compiled import compiled

Array = np.ndarray


@compiled
def orientation_error(rotation: Array, wanted: Array) -> Array:
    """``½ (n × n_d + s × s_d + c × c_d)``, Hammam (12): the axis from one rotation to another times the sine of the
    angle, world axes, shape (3,). Beyond a right angle it falls again, and at half a turn it is zero."""
    error = np.zeros(3)
    for k in range(3):
        a, b = rotation[:, k], wanted[:, k]
        error[0] += 0.5 * (a[1] * b[2] - a[2] * b[1])
        error[1] += 0.5 * (a[2] * b[0] - a[0] * b[2])
        error[2] += 0.5 * (a[0] * b[1] - a[1] * b[0])
    return error


def euler_rate_matrix(angles: Array) -> Array:
    """H with ``ω = H(Θ) Θ̇``, Dariush (3), for ``R = R_z(yaw) R_y(pitch) R_x(roll)``, angles roll, pitch, yaw [rad].

    ω is in world axes; H is singular at a pitch of a right angle.
    """
    _, pitch, yaw = angles
    return np.array(
        [
            [np.cos(yaw) * np.cos(pitch), -np.sin(yaw), 0.0],
            [np.sin(yaw) * np.cos(pitch), np.cos(yaw), 0.0],
            [-np.sin(pitch), 0.0, 1.0],
        ]
    )


def angular_velocity(rotation: Array, rotation_rate: Array) -> Array:
    """ω of ``ω̃ = Ṙ Rᵀ``, Dariush (4), world axes, shape (3,) [rad/s]."""
    skew = rotation_rate @ rotation.T
    return 0.5 * np.array([skew[2, 1] - skew[1, 2], skew[0, 2] - skew[2, 0], skew[1, 0] - skew[0, 1]])
