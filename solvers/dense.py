"""Compiled dense linear algebra for the small matrices of a tick, where a library call costs more than its arithmetic.

Loops run over whole rows, zeros included: that is what becomes vector instructions.
"""

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Array

DEPENDENT_BELOW = 1e-9
"""Distance from the span of the rows before it, relative to a row's length, below which it is dependent."""
INDEPENDENT_ABOVE = 1e-5
"""The same distance above which a row is independent; between the two there is doubt."""
WELL_CONDITIONED_ABOVE = 1e-3
"""Ratio of the shortest to the longest direction above which normal equations need no step of refinement."""


@compiled
def lq_factorization(J: Array) -> tuple[Array, Array, Array, Array, bool]:
    """Factorise ``J = L Q``, m rows of n variables, by Householder reflections, row after row.

    Returns:
        L, shape (m, m), of which row k uses the columns up to its rank, lower triangular in the independent rows;
        the reflections' vectors V (m, n) and factors (m,), ``Qᵀ = (1 − f_0 v_0 v_0ᵀ) (1 − f_1 v_1 v_1ᵀ) …``; indices of
        the independent rows, shape (rank,); and whether these are beyond doubt.
    """
    m, n = J.shape
    L, V, factors, rows, rank, certain = np.zeros((m, m)), np.zeros((m, n)), np.zeros(m), np.zeros(m, np.int64), 0, True
    v = np.empty(n)
    for k in range(m):
        length = 0.0
        for i in range(n):
            v[i] = J[k, i]
            length += v[i] * v[i]
        for j in range(rank):
            _reflect(V[j], factors[j], v)
        square = 0.0
        for i in range(rank):
            L[k, i] = v[i]
            v[i] = 0.0
        for i in range(n):
            square += v[i] * v[i]
        if not square > DEPENDENT_BELOW**2 * length:
            certain &= square < np.inf
            continue
        certain &= square > INDEPENDENT_ABOVE**2 * length
        diagonal = -np.sqrt(square) if v[rank] > 0.0 else np.sqrt(square)
        first = v[rank] - diagonal
        for i in range(n):
            V[rank, i] = v[i] / first
        V[rank, rank] = 1.0
        L[k, rank], factors[rank], rows[rank] = diagonal, -first / diagonal, k
        rank += 1
    return L, V, factors, rows[:rank], certain


@compiled
def _reflect(v: Array, factor: float, x: Array) -> None:
    along = 0.0
    for i in range(len(v)):
        along += v[i] * x[i]
    along *= factor
    for i in range(len(v)):
        x[i] -= along * v[i]


@compiled
def apply_q_transposed(V: Array, factors: Array, rank: int, x: Array) -> None:
    """``x ← Qᵀ x``, shape (n,)."""
    for k in range(rank - 1, -1, -1):
        _reflect(V[k], factors[k], x)


@compiled
def forward_substitution(L: Array, rows: Array, b: Array) -> Array:
    """y with ``L y = b`` in the independent rows, shape (rank,); b has shape (m,)."""
    y = np.empty(len(rows))
    for k, row in enumerate(rows):
        y[k] = b[row]
        for i in range(k):
            y[k] -= L[row, i] * y[i]
        y[k] /= L[row, k]
    return y


@compiled
def backward_substitution(L: Array, rows: Array, b: Array) -> Array:
    """y with ``Lᵀ y = b``, L the independent rows, shapes (rank,)."""
    y = b.copy()
    for k in range(len(rows) - 1, -1, -1):
        y[k] /= L[rows[k], k]
        for i in range(k):
            y[i] -= L[rows[k], i] * y[k]
    return y


@compiled
def solution_space(J: Array, b: Array) -> tuple[Array, bool]:
    """All x with ``J x = b``: the shortest one, and below it an orthonormal basis of the null space of J.

    Returns:
        Shape (1 + n − m, n), and whether the m rows are independent, without which it is of no use.
    """
    m, n = J.shape
    X = np.zeros((1 + n - m, n))
    L, V, factors, rows, certain = lq_factorization(J)
    if len(rows) < m or not certain:
        return X, False
    copy_into(X[0], forward_substitution(L, rows, b))
    for k in range(n - m):
        X[1 + k, m + k] = 1.0
    for k in range(len(X)):
        apply_q_transposed(V, factors, m, X[k])
    return X, True


@compiled
def gram_cholesky(B: Array) -> tuple[Array, float]:
    """Cholesky factor L of ``B Bᵀ = L Lᵀ``, and its smallest diagonal entry relative to the largest (at least 1); 0 if
    there is no such L."""
    m, n = B.shape
    L, shortest, longest = np.zeros((m, m)), np.inf, 1.0
    for i in range(m):
        for j in range(i + 1):
            along = 0.0
            for k in range(n):
                along += B[i, k] * B[j, k]
            for k in range(j):
                along -= L[i, k] * L[j, k]
            if i > j:
                L[i, j] = along / L[j, j]
                continue
            if not 0.0 < along < np.inf:
                return L, 0.0
            L[i, i] = np.sqrt(along)
            shortest, longest = min(shortest, L[i, i]), max(longest, L[i, i])
    return L, shortest / longest


@compiled
def least_squares_in_solution_space(X: Array, B: Array, b: Array) -> tuple[Array, bool]:
    """The x within `solution_space` that minimises ``‖W x − b‖²``, where ``B = X Wᵀ``.

    By normal equations, with a step of refinement where rounding would show.

    Returns:
        Shape (n,), and whether W determines it.
    """
    x, free = X[0].copy(), len(X) - 1
    if not free:
        return x, True
    L, shortest = gram_cholesky(B[1:])
    if len(b) < free or not shortest > INDEPENDENT_ABOVE:
        return x, False
    rows, rest = np.arange(free), b - B[0]
    for _ in range(2):
        y = backward_substitution(L, rows, forward_substitution(L, rows, matrix_vector(B[1:], rest)))
        for i in range(free):
            for k in range(len(x)):
                x[k] += y[i] * X[1 + i, k]
            for k in range(len(b)):
                rest[k] -= y[i] * B[1 + i, k]
        if shortest > WELL_CONDITIONED_ABOVE:
            break
    return x, True


@compiled
def matrix_vector(A: Array, x: Array) -> Array:
    """``A x``."""
    out = np.zeros(len(A))
    for i in range(len(A)):
        for k in range(len(x)):
            out[i] += A[i, k] * x[k]
    return out


@compiled
def copy_into(out: Array, values: Array) -> None:
    """Write values (k,) to the start of an array; ``out[:k] = values`` takes ten times as long to compile."""
    for i in range(len(values)):
        out[i] = values[i]
