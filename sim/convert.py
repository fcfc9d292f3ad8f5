"""Pinocchio's configuration and velocity to MuJoCo's and back: the one place that knows how they differ.

Pinocchio: quaternion xyzw, base linear velocity in the base frame. MuJoCo: quaternion wxyz, base linear velocity in
the world. Base position, base angular velocity (in the base frame) and
the joints and their order agree.
"""

import numpy as np


def state_to_mujoco(q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Configuration (7 + na,) and velocity (6 + na,) of Pinocchio as MuJoCo's qpos and qvel, new arrays."""
    qpos, qvel = q.copy(), v.copy()
    x, y, z, w = q[3:7].tolist()
    qpos[3:7] = w, x, y, z
    qvel[:3] = _rotated(w, x, y, z, v[:3].tolist())
    return qpos, qvel


def state_from_mujoco(qpos: np.ndarray, qvel: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """MuJoCo's qpos (7 + na,) and qvel (6 + na,) as Pinocchio's configuration and velocity, new arrays."""
    q, v = qpos.copy(), qvel.copy()
    w, x, y, z = qpos[3:7].tolist()
    q[3:7] = x, y, z, w
    v[:3] = _rotated(w, -x, -y, -z, qvel[:3].tolist())
    return q, v


def _rotated(w: float, x: float, y: float, z: float, u: list[float]) -> tuple[float, float, float]:
    """R(quaternion) u. In scalars: a tenth of the time that three-vectors take in numpy."""
    a, b, c = u
    # t = 2 r × u,  R u = u + w t + r × t
    tx, ty, tz = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    return (
        a + w * tx + y * tz - z * ty,
        b + w * ty + z * tx - x * tz,
        c + w * tz + x * ty - y * tx,
    )
