"""Least squares with the tight inequalities as equalities: the exact answer of a program, once these are known."""

import numpy as np

from solvers.compiled import compiled
from solvers.dense import (
    apply_q_transposed,
    backward_substitution,
    copy_into,
    forward_substitution,
    gram_cholesky,
    lq_factorization,
    matrix_vector,
)
from solvers.rows import Array

NEGLIGIBLE_LENGTH = 1e-7
"""Length of a row in what others leave, relative to the largest entry of its matrix, below which it counts as zero."""
MAX_TIGHTENINGS = 4
"""Largest number of times that inequalities are added to the tight ones."""


@compiled
def least_squares_on_tight_rows(
    A: Array, b: Array, C: Array, lower: Array, upper: Array, sides: Array, tolerance: float
) -> tuple[Array, bool]:
    """The shortest y of those that minimise ``‖A y − b‖²`` with the tight rows of C at their bounds.

    Where many y do equally well, the shortest may leave other bounds: those it breaks are tight, too.

    Args:
        A, b: Shapes (k, n) and (k,).
        C, lower, upper: Inequalities ``lower <= C y <= upper``, shapes (m, n), (m,) and (m,).
        sides: +1 where a row is tight at its upper bound, -1 at the lower one, 0 elsewhere, shape (m,); changed.
        tolerance: Violation that counts as none.

    Returns:
        y, shape (n,), and whether it satisfies the inequalities.
    """
    m, n = C.shape
    longest = np.abs(A).max() if A.size else 1.0
    y = np.zeros(n)
    for _ in range(MAX_TIGHTENINGS):
        tight = np.flatnonzero(sides)
        rows, target = np.empty((len(tight), n)), np.empty(len(tight))
        for k in range(len(tight)):
            copy_into(rows[k], C[tight[k]])
            target[k] = upper[tight[k]] if sides[tight[k]] > 0.0 else lower[tight[k]]
        L, V, factors, kept, _ = lq_factorization(rows)
        rank = len(kept)
        y = np.zeros(n)
        copy_into(y, forward_substitution(L, kept, target))
        apply_q_transposed(V, factors, rank, y)
        basis = np.zeros((n - rank, n))
        for k in range(n - rank):
            basis[k, rank + k] = 1.0
            apply_q_transposed(V, factors, rank, basis[k])
        B = np.zeros((len(A), n - rank))
        for i in range(len(A)):
            copy_into(B[i], matrix_vector(basis, A[i]))
            if not B[i] @ B[i] > (NEGLIGIBLE_LENGTH * longest) ** 2:
                B[i] = 0.0
        z, solved = _shortest_least_squares(B, b - matrix_vector(A, y))
        if not solved:
            return y, False
        for k in range(n - rank):
            for i in range(n):
                y[i] += z[k] * basis[k, i]
        broken = False
        for row in range(m):
            value = 0.0
            for i in range(n):
                value += C[row, i] * y[i]
            if not (value <= upper[row] + tolerance and value >= lower[row] - tolerance):
                if sides[row] != 0.0:
                    return y, False
                sides[row] = 1.0 if value > upper[row] else -1.0
                broken = True
        if not broken:
            return y, True
    return y, False


@compiled
def _shortest_least_squares(B: Array, b: Array) -> tuple[Array, bool]:
    """The shortest z of those that minimise ``‖B z − b‖²``, shape (n,), and whether that could be told."""
    z = np.zeros(B.shape[1])
    L, V, factors, kept, _ = lq_factorization(B)
    rank = len(kept)
    columns = np.empty((rank, len(B)))
    for k in range(rank):
        for i in range(len(B)):
            columns[k, i] = L[i, k]
    factor, shortest = gram_cholesky(columns)
    if rank and not shortest > 0.0:
        return z, False
    order, rest = np.arange(rank), b.copy()
    for _ in range(2):  # normal equations, and a step of refinement
        step = backward_substitution(factor, order, forward_substitution(factor, order, matrix_vector(columns, rest)))
        for k in range(rank):
            z[k] += step[k]
            for i in range(len(B)):
                rest[i] -= step[k] * columns[k, i]
    apply_q_transposed(V, factors, rank, z)
    return z, True
