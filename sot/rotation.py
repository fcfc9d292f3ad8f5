"""Rotations."""

import numpy as np

from solvers.compiled import compiled

Array = np.ndarray


@compiled
def rotation_vector(R: Array) -> Array:
    """Axis times angle, 0..π, of a rotation matrix (3, 3); shape (3,) [rad]."""
    w = 0.5 * np.array((R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]))
    sine, cosine = np.sqrt(w[0] ** 2 + w[1] ** 2 + w[2] ** 2), 0.5 * (R[0, 0] + R[1, 1] + R[2, 2] - 1.0)
    angle = np.arctan2(sine, cosine)
    if cosine > -0.9:
        return w * (angle / sine) if sine > 1e-9 else w
    # Near half a turn the axis shows in what is symmetric, (1 − cos) a aᵀ + cos 1: its longest column, and w's side.
    k = 0
    for i in range(1, 3):
        k = i if R[i, i] > R[k, k] else k
    axis = np.empty(3)
    for i in range(3):
        axis[i] = 0.5 * (R[i, k] + R[k, i]) - (cosine if i == k else 0.0)
    along, square = 0.0, 0.0
    for i in range(3):
        along, square = along + axis[i] * w[i], square + axis[i] ** 2
    return axis * ((angle if along >= 0.0 else -angle) / np.sqrt(square))
