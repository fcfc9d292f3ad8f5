"""Pinocchio's state and Jacobians of one moment, for the coordinates in which motions are fitted."""

import numpy as np
from numpy.typing import NDArray

from solvers.compiled import compiled

Array = NDArray[np.float64]


@compiled
def pinocchio_state(y: Array, dy: Array, ddy: Array) -> tuple[Array, Array, Array]:
    """q (nv + 1,), v and a (nv,) of coordinates and derivatives (nv,): `coordinates.to_pinocchio` for one row."""
    size = len(y)
    q, v, a = np.empty(size + 1), np.empty(size), np.empty(size)
    for k in range(3):
        q[k] = y[k]
    for k in range(6, size):
        q[k + 1], v[k], a[k] = y[k], dy[k], ddy[k]
    sr, cr = np.sin(0.5 * y[3]), np.cos(0.5 * y[3])
    sp, cp = np.sin(0.5 * y[4]), np.cos(0.5 * y[4])
    sy, cy = np.sin(0.5 * y[5]), np.cos(0.5 * y[5])
    q[3] = sr * cp * cy - cr * sp * sy
    q[4] = cr * sp * cy + sr * cp * sy
    q[5] = cr * cp * sy - sr * sp * cy
    q[6] = cr * cp * cy + sr * sp * sy
    sr, cr, sp, cp, sy, cy = np.sin(y[3]), np.cos(y[3]), np.sin(y[4]), np.cos(y[4]), np.sin(y[5]), np.cos(y[5])
    R = np.array(
        (
            (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
            (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
            (-sp, cp * sr, cp * cr),
        )
    )
    for k in range(3):
        v[k] = R[0, k] * dy[0] + R[1, k] * dy[1] + R[2, k] * dy[2]
        a[k] = R[0, k] * ddy[0] + R[1, k] * ddy[1] + R[2, k] * ddy[2]
    dr, dp, dw = dy[3], dy[4], dy[5]
    v[3] = dr - sp * dw
    v[4] = cr * dp + sr * cp * dw
    v[5] = -sr * dp + cr * cp * dw
    a[3] = ddy[3] - sp * ddy[5] - cp * dp * dw
    a[4] = cr * ddy[4] + sr * cp * ddy[5] - sr * dr * dp + (cr * cp * dr - sr * sp * dp) * dw
    a[5] = -sr * ddy[4] + cr * cp * ddy[5] - cr * dr * dp + (-sr * cp * dr - cr * sp * dp) * dw
    a[0] -= v[4] * v[2] - v[5] * v[1]
    a[1] -= v[5] * v[0] - v[3] * v[2]
    a[2] -= v[3] * v[1] - v[4] * v[0]
    return q, v, a


@compiled
def coordinate_columns(J: Array, y: Array) -> Array:
    """A Jacobian (n, nv) on Pinocchio's velocities, as one on the rates of coordinates (nv,): only the base differs."""
    out = np.empty(J.shape)
    sr, cr, sp, cp, sy, cy = np.sin(y[3]), np.cos(y[3]), np.sin(y[4]), np.cos(y[4]), np.sin(y[5]), np.cos(y[5])
    R = np.array(
        (
            (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
            (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
            (-sp, cp * sr, cp * cr),
        )
    )
    for i in range(len(J)):
        for k in range(3):
            out[i, k] = J[i, 0] * R[k, 0] + J[i, 1] * R[k, 1] + J[i, 2] * R[k, 2]
        out[i, 3] = J[i, 3]
        out[i, 4] = cr * J[i, 4] - sr * J[i, 5]
        out[i, 5] = -sp * J[i, 3] + cp * (sr * J[i, 4] + cr * J[i, 5])
        for k in range(6, J.shape[1]):
            out[i, k] = J[i, k]
    return out
