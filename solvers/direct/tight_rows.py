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


def least_squares_on_tight_rows(
    A: Array, b: Array, C: Array, lower: Array, upper: Array, sides: Array, near: Array, tolerance: float
) -> Array | None:
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
        y, shape (n,), or None if it breaks bounds.
    """
    tightened, nowhere = sides.copy(), np.zeros_like(near)
    for _ in range(MAX_TIGHTENINGS):
        y, broken = _nearest_on_tight_rows(A, b, C, lower, upper, tightened, nowhere, tolerance)
        if not broken.any():
            return y
        if (broken * tightened).any():
            break
        tightened += broken
    y, broken = _nearest_on_tight_rows(A, b, C, lower, upper, sides, near, tolerance)
    return None if broken.any() else y


@compiled
def _nearest_on_tight_rows(
    A: Array, b: Array, C: Array, lower: Array, upper: Array, sides: Array, origin: Array, tolerance: float
) -> tuple[Array, Array]:
    """The y nearest to an origin of those that minimise ``‖A y − b‖²`` with the tight rows at their bounds.

    Returns:
        y, shape (n,), and +1 where it breaks an upper bound, -1 at a lower one, 0 elsewhere, shape (m,).
    """
    m, n = C.shape
    count = 0
    for row in range(m):
        count += sides[row] != 0.0
    rows, missing, k = np.empty((count, n)), np.empty(count), 0
    for row in range(m):
        if sides[row] != 0.0:
            missing[k] = upper[row] if sides[row] > 0.0 else lower[row]
            for i in range(n):
                rows[k, i] = C[row, i]
                missing[k] -= C[row, i] * origin[i]
            k += 1
    L, V, factors, kept, _ = lq_factorization(rows)
    rank, y = len(kept), np.zeros(n)
    copy_into(y, forward_substitution(L, kept, missing))
    apply_q_transposed(V, factors, rank, y)
    basis, B = np.zeros((n - rank, n)), np.zeros((len(A), n - rank))
    for k in range(n - rank):
        basis[k, rank + k] = 1.0
        apply_q_transposed(V, factors, rank, basis[k])
    longest, rest = 0.0, np.empty(len(A))
    for i in range(n):
        y[i] += origin[i]
        for k in range(len(A)):
            longest = max(longest, abs(A[k, i]))
    for k in range(len(A)):
        rest[k] = b[k]
        for i in range(n):
            rest[k] -= A[k, i] * y[i]
        left, square = matrix_vector(basis, A[k]), 0.0
        for i in range(n - rank):
            square += left[i] * left[i]
        if square > (NEGLIGIBLE_LENGTH * longest) ** 2:
            copy_into(B[k], left)
    z = _shortest_least_squares(B, rest)
    for k in range(n - rank):
        for i in range(n):
            y[i] += z[k] * basis[k, i]
    value, broken = matrix_vector(C, y), np.zeros(m)
    for row in range(m):
        if not value[row] <= upper[row] + tolerance:
            broken[row] = 1.0
        elif not value[row] >= lower[row] - tolerance:
            broken[row] = -1.0
    return y, broken


@compiled
def _shortest_least_squares(B: Array, b: Array) -> Array:
    """The shortest z of those that minimise ``‖B z − b‖²``, shape (n,); not a number where that cannot be told."""
    z = np.zeros(B.shape[1])
    L, V, factors, kept, _ = lq_factorization(B)
    rank = len(kept)
    columns, rest = np.empty((rank, len(B))), b.copy()
    for k in range(rank):
        for i in range(len(B)):
            columns[k, i] = L[i, k]
    factor, _ = gram_cholesky(columns)
    order = np.arange(rank)
    for _ in range(2):  # normal equations, and a step of refinement
        step = backward_substitution(factor, order, forward_substitution(factor, order, matrix_vector(columns, rest)))
        for k in range(rank):
            z[k] += step[k]
            for i in range(len(B)):
                rest[i] -= step[k] * columns[k, i]
    apply_q_transposed(V, factors, rank, z)
    return z
