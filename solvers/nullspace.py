"""Least squares that leave the rest of the space free, straight on LAPACK.

`numpy.linalg.qr(mode="complete")` takes several times as long as the pivoted `geqp3` with `ormqr` on matrices of a
tick's size, and does not reveal the rank.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from solvers.rows import Array

_WORK = 64  # LAPACK's block size: workspace per row or column


@dataclass(slots=True)
class Projection:
    """Complete orthogonal factorisation of one level's rows ``B = A Z`` in what the levels above left.

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
            if k == len(r) and not damping:
                y[:k, 0], _ = lapack.dtrtrs(self.qr[:k, :k], r[self.pivots], lower=0, trans=1)
            else:
                R = np.triu(self.qr[:k, :])
                target = r[self.pivots]
                if damping:
                    y[:k, 0] = np.linalg.solve(R @ R.T + damping**2 * np.eye(k), R @ target)
                else:
                    rows = np.asfortranarray(R.T)
                    _, solution, _ = lapack.dgels(rows, target, lwork=_WORK * (rows.shape[0] + k))
                    y[:k, 0] = solution[:k]
            y = lapack.dormqr("L", "N", self.qr[:, :k], self.tau[:k], y, _WORK)[0]
        return y[:, 0]

    def multipliers(self, g: Array) -> Array:
        """λ with ``Bᵀ λ = g`` for a g in the range of Bᵀ, shape (m,); 0 for rows that others imply."""
        k = self.rank
        out = np.zeros(self.qr.shape[1])
        if k:
            turned = lapack.dormqr("L", "T", self.qr[:, :k], self.tau[:k], g[:, None], _WORK)[0]
            out[self.pivots[:k]], _ = lapack.dtrtrs(self.qr[:k, :k], turned[:k, 0], lower=0)
        return out

    def remaining(self, Z: Array) -> Array:
        """Orthonormal basis of what is left of the columns of Z, shape (rows of Z, n - rank)."""
        if not self.rank:
            return Z
        turned = lapack.dormqr("R", "N", self.qr[:, : self.rank], self.tau[: self.rank], Z, _WORK * len(Z))[0]
        return turned[:, self.rank :]


def project(B: Array, tolerance: float) -> Projection:
    """Factorise the rows B, shape (m, n); singular directions below `tolerance` count as none."""
    m, n = B.shape
    if not m or not n:
        return Projection(np.zeros((n, m), order="F"), np.zeros(0), np.zeros(0, dtype=int), 0)
    qr, pivots, tau, _, _ = lapack.dgeqp3(B.T, lwork=_WORK * (m + 1))
    diagonal = np.abs(np.diagonal(qr))
    return Projection(qr, tau, pivots - 1, int(np.count_nonzero(diagonal > tolerance)))
