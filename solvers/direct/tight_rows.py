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
"""Largest number of times that bounds are added which the shortest answer breaks."""


@compiled
def least_squares_on_tight_rows(
    A: Array, b: Array, C: Array, lower: Array, upper: Array, sides: Array, near: Array, tolerance: float
) -> tuple[Array, bool]:
    """The shortest y of those that minimise ``‖A y − b‖²`` with the tight rows of C at their bounds.

    Where many y do equally well, the shortest may break bounds: those are then tight, too. Where that leads nowhere it
    is the y nearest to a known answer.

    Args:
        A, b: Shapes (k, n) and (k,).
        C, lower, upper: Inequalities ``lower <= C y <= upper``, shapes (m, n), (m,) and (m,).
        sides: +1 where a row is tight at its upper bound, -1 at the lower one, 0 elsewhere, shape (m,).
        near: The known answer, to some accuracy, shape (n,).
        tolerance: Violation that counts as none.

    Returns:
        y, shape (n,), and whether it satisfies the inequalities.
    """
    tightened, nowhere = sides.copy(), np.zeros(len(near))
    for _ in range(MAX_TIGHTENINGS):
        y, found = _nearest_on_tight_rows(A, b, C, lower, upper, tightened, nowhere)
        broken = _broken_sides(matrix_vector(C, y), lower, upper, tolerance)
        if not found or (broken * tightened).any():
            break
        if not broken.any():
            return y, True
        tightened += broken
    y, found = _nearest_on_tight_rows(A, b, C, lower, upper, sides, near)
    return y, found and not _broken_sides(matrix_vector(C, y), lower, upper, tolerance).any()


@compiled
def _broken_sides(value: Array, lower: Array, upper: Array, tolerance: float) -> Array:
    """+1 where a value is above its upper bound, -1 below the lower one, 0 elsewhere, shape (m,)."""
    sides = np.zeros(len(value))
    for row in range(len(value)):
        if not value[row] <= upper[row] + tolerance:
            sides[row] = 1.0
        elif not value[row] >= lower[row] - tolerance:
            sides[row] = -1.0
    return sides


@compiled
def _nearest_on_tight_rows(
    A: Array, b: Array, C: Array, lower: Array, upper: Array, sides: Array, origin: Array
) -> tuple[Array, bool]:
    """The y nearest to an origin of those that minimise ``‖A y − b‖²`` with the tight rows at their bounds, and whether
    that could be told."""
    n, tight = C.shape[1], np.flatnonzero(sides)
    rows, target = np.empty((len(tight), n)), np.empty(len(tight))
    for k in range(len(tight)):
        copy_into(rows[k], C[tight[k]])
        target[k] = upper[tight[k]] if sides[tight[k]] > 0.0 else lower[tight[k]]
    L, V, factors, kept, _ = lq_factorization(rows)
    rank, longest, y = len(kept), np.abs(A).max() if A.size else 1.0, np.zeros(n)
    copy_into(y, forward_substitution(L, kept, target - matrix_vector(rows, origin)))
    apply_q_transposed(V, factors, rank, y)
    y += origin
    basis, B = np.zeros((n - rank, n)), np.zeros((len(A), n - rank))
    for k in range(n - rank):
        basis[k, rank + k] = 1.0
        apply_q_transposed(V, factors, rank, basis[k])
    for i in range(len(A)):
        copy_into(B[i], matrix_vector(basis, A[i]))
        if not B[i] @ B[i] > (NEGLIGIBLE_LENGTH * longest) ** 2:
            B[i] = 0.0
    z, solved = _shortest_least_squares(B, b - matrix_vector(A, y))
    for k in range(n - rank):
        for i in range(n):
            y[i] += z[k] * basis[k, i]
    return y, solved


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
