"""The weighted damped pseudo-inverse, and least squares by it."""

import numpy as np
from scipy.linalg import lapack

from solvers.nullspace import factorize_rows
from solvers.rows import Array

LENGTH_TOLERANCE = 1e-10
"""Directions shorter than this, relative to the largest entry, do not count where there is no damping."""


def damped_inverse(J: Array, damping: float, weight: Array | None = None) -> Array:
    """``J† = W⁻¹ Jᵀ (J W⁻¹ Jᵀ + λ² I)⁻¹``, Hammam (10), Dariush (10); shape (n, m)."""
    along = J.T if weight is None else np.linalg.solve(weight, J.T)
    return np.linalg.solve(J @ along + damping**2 * np.eye(len(J)), along.T).T


def damped_least_squares(J: Array, b: Array, damping: float) -> Array:
    """``Jᵀ (J Jᵀ + λ² I)⁻¹ b``, shape (n,); the least-norm solution if λ is 0."""
    m, n = J.shape
    if not m or not n:
        return np.zeros(n)
    if not damping:
        return factorize_rows(J, LENGTH_TOLERANCE * float(np.abs(J).max())).least_squares(b)
    if m > n:
        return np.linalg.solve(J.T @ J + damping**2 * np.eye(n), J.T @ b)
    normal = J @ J.T
    normal.flat[:: m + 1] += damping**2
    factor, failed = lapack.dpotrf(normal, lower=1)
    if failed:
        return np.linalg.lstsq(np.vstack([J, damping * np.eye(n)]), np.append(b, np.zeros(n)))[0]
    return J.T @ lapack.dpotrs(factor, b, lower=1)[0]
