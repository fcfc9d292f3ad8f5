"""Dense linear algebra of a tick's sizes, compiled: there a call of a library takes longer than what it computes.

Loops run over whole rows, zeros included: that is what becomes vector instructions.
"""

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Array

INDEPENDENT = 1e-5
"""Rows are taken to be independent if none is closer to the others' span than this, relative to the farthest."""
WELL = 1e-3
"""Normal equations whose shortest direction is longer than this, relative to the longest, are solved in one step."""


@compiled
def lq(J: Array) -> tuple[Array, Array, Array]:
    """``J = [L 0] Q`` of m rows of n variables, m ≤ n, by Householder reflections.

    Returns:
        L, lower triangular (m, m); the reflections' vectors V (m, n) and factors (m,):
        ``Qᵀ = (1 − f_0 v_0 v_0ᵀ) (1 − f_1 v_1 v_1ᵀ) …``.
    """
    m, n = J.shape
    L, V, factors = np.zeros((m, m)), J.copy(), np.zeros(m)
    for k in range(m):
        v = V[k]
        for i in range(k):
            L[k, i] = v[i]
            v[i] = 0.0
        square = 0.0
        for i in range(n):
            square += v[i] * v[i]
        diagonal = -np.sqrt(square) if v[k] > 0.0 else np.sqrt(square)
        L[k, k] = diagonal
        if diagonal == 0.0:
            continue
        first = v[k] - diagonal
        for i in range(n):
            v[i] /= first
        v[k] = 1.0
        factors[k] = -first / diagonal
        for j in range(k + 1, m):
            _reflect(v, factors[k], V[j])
    return L, V, factors


@compiled
def _reflect(v: Array, factor: float, x: Array) -> None:
    along = 0.0
    for i in range(len(v)):
        along += v[i] * x[i]
    along *= factor
    for i in range(len(v)):
        x[i] -= along * v[i]


@compiled
def turn(V: Array, factors: Array, x: Array) -> None:
    """``x ← Qᵀ x``, shape (n,)."""
    for k in range(len(factors) - 1, -1, -1):
        _reflect(V[k], factors[k], x)


@compiled
def independent(L: Array) -> bool:
    """Whether the rows that were factorised are; those that hold what is not a number are not."""
    shortest, longest = np.inf, 0.0
    for k in range(len(L)):
        size = abs(L[k, k])
        if not size < np.inf:
            return False
        shortest, longest = min(shortest, size), max(longest, size)
    return shortest > INDEPENDENT * longest or not len(L)


@compiled
def forward(L: Array, b: Array) -> Array:
    """y with ``L y = b``, L lower triangular (m, m)."""
    y = b.copy()
    for k in range(len(y)):
        for i in range(k):
            y[k] -= L[k, i] * y[i]
        y[k] /= L[k, k]
    return y


@compiled
def backward(L: Array, b: Array) -> Array:
    """y with ``Lᵀ y = b``, L lower triangular (m, m)."""
    y = b.copy()
    for k in range(len(y) - 1, -1, -1):
        y[k] /= L[k, k]
        for i in range(k):
            y[i] -= L[k, i] * y[k]
    return y


@compiled
def solutions(J: Array, b: Array) -> tuple[Array, bool]:
    """All x with ``J x = b``: the shortest one, and below it an orthonormal basis of what may be added to it.

    Returns:
        Shape (1 + n − m, n), and whether the m rows are independent, without which it is of no use.
    """
    m, n = J.shape
    X = np.zeros((1 + n - m, n))
    L, V, factors = lq(J)
    if not independent(L):
        return X, False
    X[0, :m] = forward(L, b)
    for k in range(n - m):
        X[1 + k, m + k] = 1.0
    for k in range(len(X)):
        turn(V, factors, X[k])
    return X, True


@compiled
def nearest(X: Array, B: Array, b: Array) -> tuple[Array, bool]:
    """The x of those that `solutions` gave that minimises ``‖W x − b‖²``, where ``B = X Wᵀ``.

    By normal equations, with a step of refinement where rounding would show.

    Returns:
        Shape (n,), and whether W determines it.
    """
    x, free, m = X[0].copy(), len(X) - 1, len(b)
    if not free:
        return x, True
    L = np.zeros((free, free))
    for i in range(free):
        for j in range(i + 1):
            along = 0.0
            for k in range(m):
                along += B[1 + i, k] * B[1 + j, k]
            L[i, j] = along
    if m < free or not _cholesky(L):
        return x, False
    rest = b - B[0]
    for _ in range(2):
        y = np.zeros(free)
        for i in range(free):
            for k in range(m):
                y[i] += B[1 + i, k] * rest[k]
        y = backward(L, forward(L, y))
        for i in range(free):
            for k in range(len(x)):
                x[k] += y[i] * X[1 + i, k]
            for k in range(m):
                rest[k] -= y[i] * B[1 + i, k]
        if _shortest(L) > WELL:
            break
    return x, True


@compiled
def _cholesky(L: Array) -> bool:
    """Replace a symmetric matrix, whose lower half counts, by its factor; whether it is well enough defined."""
    for j in range(len(L)):
        for i in range(j, len(L)):
            for k in range(j):
                L[i, j] -= L[i, k] * L[j, k]
        if not 0.0 < L[j, j] < np.inf:
            return False
        scale = np.sqrt(L[j, j])
        for i in range(j, len(L)):
            L[i, j] /= scale
    return _shortest(L) > INDEPENDENT


@compiled
def _shortest(L: Array) -> float:
    """Shortest of a factor's directions, relative to the longest, or to 1 if that is more."""
    shortest, longest = np.inf, 1.0
    for k in range(len(L)):
        shortest, longest = min(shortest, L[k, k]), max(longest, L[k, k])
    return shortest / longest
