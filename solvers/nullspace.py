"""Least squares and null-space bases, straight on LAPACK.

`numpy.linalg.qr(mode="complete")` takes several times as long as the pivoted `geqp3` with `ormqr` on matrices of a
tick's size, and does not reveal the rank.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from solvers.dense import INDEPENDENT_ABOVE, WELL_CONDITIONED_ABOVE
from solvers.rows import Array

_WORKSPACE_PER_ROW = 64  # LAPACK's block size: workspace per row or column
_UPPER_TRIANGLE = np.triu(np.ones((256, 256)))


@dataclass(slots=True)
class RowFactorization:
    """Complete orthogonal factorisation of one level's rows ``B = A Z`` in the null space of the levels above.

    ``Bᵀ P = Q [R; 0]`` with column pivoting, so that the first `rank` columns of Q span what the level uses and the
    rest is free for the levels below.
    """

    qr: Array
    tau: Array
    pivots: Array
    rank: int

    def least_squares(self, r: Array, damping: float = 0.0) -> Array:
        """Least-norm ``y`` of those that minimise ``‖B y − r‖² + damping² ‖y‖²``; y has shape (n,)."""
        n, k = self.qr.shape[0], self.rank
        y = np.zeros((n, 1), order="F")
        if k:
            target = r[self.pivots]
            if k == len(r) and not damping:
                y[:k, 0], _ = lapack.dtrtrs(self.qr[:k, :k], target, lower=0, trans=1)
            else:
                y[:k, 0] = _least_squares_of_transpose(self.qr[:k] * _UPPER_TRIANGLE[:k, : len(r)], target, damping)
            y = lapack.dormqr("L", "N", self.qr[:, :k], self.tau[:k], y, _WORKSPACE_PER_ROW, overwrite_c=1)[0]
        return y[:, 0]

    def least_norm(self, r: Array) -> Array:
        """Least-norm Y with ``B Y = r`` for rows B of full rank; r has shape (m, c), Y (n, c)."""
        k = self.rank
        y = np.zeros((self.qr.shape[0], r.shape[1]), order="F")
        y[:k], _ = lapack.dtrtrs(self.qr[:k, :k], r[self.pivots], lower=0, trans=1)
        return lapack.dormqr("L", "N", self.qr[:, :k], self.tau[:k], y, _WORKSPACE_PER_ROW * r.shape[1], overwrite_c=1)[
            0
        ]

    def pseudo_inverse(self, damping: float = 0.0) -> Array:
        """Damped pseudo-inverse ``(Bᵀ B + damping² I)⁻¹ Bᵀ`` of the directions that count, Kim (8); shape (n, m)."""
        m, k = self.qr.shape[1], self.rank
        if not k:
            return np.zeros((self.qr.shape[0], m))
        if k == m and not damping:
            return self.least_norm(np.eye(m))
        R = self.qr[:k] * _UPPER_TRIANGLE[:k, :m]
        padded = np.vstack([np.eye(m), np.zeros((k, m))])
        y = np.zeros((self.qr.shape[0], m), order="F")
        y[:k, self.pivots] = np.linalg.lstsq(np.vstack([R.T, damping * np.eye(k)]), padded)[0]
        return lapack.dormqr("L", "N", self.qr[:, :k], self.tau[:k], y, _WORKSPACE_PER_ROW * m, overwrite_c=1)[0]

    def multipliers(self, g: Array) -> Array:
        """Multipliers λ with ``Bᵀ λ = g`` for a g in the range of Bᵀ, shape (m,); 0 for dependent rows."""
        k = self.rank
        out = np.zeros(self.qr.shape[1])
        if k:
            turned = lapack.dormqr("L", "T", self.qr[:, :k], self.tau[:k], g[:, None], _WORKSPACE_PER_ROW)[0]
            out[self.pivots[:k]], _ = lapack.dtrtrs(self.qr[:k, :k], turned[:k, 0], lower=0)
        return out

    def remaining_basis(self, Z: Array) -> Array:
        """Orthonormal basis of the null space of the rows within the span of Z, shape (rows of Z, n - rank)."""
        if not self.rank:
            return Z
        if self.rank == Z.shape[1]:
            return Z[:, :0]
        turned = lapack.dormqr(
            "R", "N", self.qr[:, : self.rank], self.tau[: self.rank], Z, _WORKSPACE_PER_ROW * len(Z)
        )[0]
        return turned[:, self.rank :]


def factorize_rows(B: Array, tolerance: float) -> RowFactorization:
    """Factorise the rows B, shape (m, n); directions shorter than `tolerance` do not count."""
    m, n = B.shape
    if not m or not n:
        return RowFactorization(np.zeros((n, m), order="F"), np.zeros(0), np.zeros(0, dtype=int), 0)
    qr, pivots, tau, _, _ = lapack.dgeqp3(B.T, lwork=_WORKSPACE_PER_ROW * (m + 1))
    pivots -= 1
    rank = min(m, n)
    # The diagonal falls in size: mostly a look at its last entry is enough.
    if abs(qr[rank - 1, rank - 1]) <= tolerance:
        rank = int(np.count_nonzero(np.abs(np.diagonal(qr)) > tolerance))
    return RowFactorization(qr, tau, pivots, rank)


def least_squares_if_determined(B: Array, r: Array, tolerance: float, damping: float = 0.0) -> Array | None:
    """Least-squares solution of rows that leave no null space; None if they leave one, or nearly.

    Normal equations, with a step of refinement where rounding would show: as accurate as a factorisation of B, at a
    fraction of its cost.
    """
    m, n = B.shape
    if m < n or not n:
        return None
    normal = B.T @ B
    if damping:
        normal.flat[:: n + 1] += damping**2
    factor, failed = lapack.dpotrf(normal, lower=0)
    diagonal = factor.diagonal().tolist()
    shortest, longest = min(diagonal), max(diagonal)
    if failed or not shortest > max(tolerance, INDEPENDENT_ABOVE * longest):
        return None
    y, _ = lapack.dpotrs(factor, B.T @ r)
    if shortest > WELL_CONDITIONED_ABOVE * longest:
        return y
    rest, _ = lapack.dpotrs(factor, B.T @ (r - B @ y) - damping**2 * y)
    return y + rest


def _least_squares_of_transpose(R: Array, target: Array, damping: float) -> Array:
    """z that minimises ``‖Rᵀ z − target‖² + damping² ‖z‖²`` for rows R of full rank, shape (k, m)."""
    z = least_squares_if_determined(R.T, target, 0.0, damping)
    if z is None:
        k = len(R)
        z = np.linalg.lstsq(np.vstack([R.T, damping * np.eye(k)]), np.append(target, np.zeros(k)))[0]
    return z
