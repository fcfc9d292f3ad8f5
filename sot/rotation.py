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


@compiled
def rotation_of_vector(turn: Array) -> Array:
    """The rotation (3, 3) about an axis by an angle, given as axis times angle (3,): inverse of `rotation_vector`."""
    angle = np.sqrt(turn[0] ** 2 + turn[1] ** 2 + turn[2] ** 2)
    sine = 1.0 - angle**2 / 6.0 if angle < 1e-4 else np.sin(angle) / angle
    versine = 0.5 - angle**2 / 24.0 if angle < 1e-4 else (1.0 - np.cos(angle)) / angle**2
    R = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            R[i, j] = versine * turn[i] * turn[j]
        R[i, i] += 1.0 - versine * angle**2
    R[2, 1] += sine * turn[0]
    R[1, 2] -= sine * turn[0]
    R[0, 2] += sine * turn[1]
    R[2, 0] -= sine * turn[1]
    R[1, 0] += sine * turn[2]
    R[0, 1] -= sine * turn[2]
    return R


@compiled
def cross(a: Array, b: Array) -> Array:
    """The vector product a × b (3,)."""
    return np.array((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


@compiled
def product(A: Array, B: Array) -> Array:
    """A B (n, k) of two small matrices (n, m) and (m, k), for which calling a library takes longer than the sums."""
    out = np.zeros((len(A), B.shape[1]))
    for i in range(len(A)):
        for m in range(len(B)):
            for j in range(B.shape[1]):
                out[i, j] += A[i, m] * B[m, j]
    return out


@compiled
def rotated(R: Array, a: Array) -> Array:
    """R a (3,) of a matrix (3, 3) and a vector (3,)."""
    out = np.empty(3)
    for i in range(3):
        out[i] = R[i, 0] * a[0] + R[i, 1] * a[1] + R[i, 2] * a[2]
    return out


@compiled
def quaternion(R: Array) -> Array:
    """A unit quaternion (x, y, z, w) of a rotation matrix (3, 3); either sign may come."""
    out = np.empty(4)
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    if trace > 0.0:
        double = np.sqrt(trace + 1.0)
        out[3] = 0.5 * double
        out[0], out[1], out[2] = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
        out[:3] *= 0.5 / double
        return out
    i = 0  # the longest of the vector's parts divides the others
    for axis in range(1, 3):
        i = axis if R[axis, axis] > R[i, i] else i
    j, k = (i + 1) % 3, (i + 2) % 3
    double = np.sqrt(R[i, i] - R[j, j] - R[k, k] + 1.0)
    out[i] = 0.5 * double
    out[j], out[k], out[3] = R[j, i] + R[i, j], R[k, i] + R[i, k], R[k, j] - R[j, k]
    out[j], out[k], out[3] = 0.5 / double * out[j], 0.5 / double * out[k], 0.5 / double * out[3]
    return out
