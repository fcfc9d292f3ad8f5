"""The active set of a strictly convex program, by the dual method of Goldfarb and Idnani (1983), compiled."""

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Array

MAX_STEPS_PER_VARIABLE = 10
"""Steps after which the method gives up, for each variable."""
NEGLIGIBLE_VIOLATION = 1e-10
"""Distance beyond a row that counts as none."""
DEPENDENT_SHARE = 1e-10
"""Length of a row in what the active ones leave, relative to its own, below which it depends on them."""


@compiled
def active_rows(
    H: Array, pull: Array, rows: Array, bounds: Array, equalities: int, expected: Array
) -> tuple[Array, bool]:
    """The rows that are tight where ``½ xᵀHx − pullᵀx`` is least with ``rows x >= bounds``.

    From the least without any rows one violated row after the other is taken in, the farthest first; as long as any of
    the expected ones is violated, the others are not looked at. On the way there, active ones whose multipliers would
    become negative are dropped: the objective only grows, so that no active set comes twice.

    Args:
        H, pull: Objective, shapes (n, n), positive definite, and (n,).
        rows, bounds: Shapes (m, n) and (m,); the first `equalities` are equalities.
        expected: Numbers of inequalities that are likely tight, which only makes it faster.

    Returns:
        Numbers of the tight rows, shape (k,), and whether they were found: not if rows contradict each other, depend on
        each other, or H is not positive definite.
    """
    n, m = len(pull), len(bounds)
    active, none = np.empty(n, np.int64), np.zeros(0, np.int64)
    J, is_definite = _inverse_factor_rows(H)
    if not is_definite:
        return none, False
    x, largest = np.zeros(n), _largest_square(J)
    for k in range(n):
        along = 0.0
        for i in range(n):
            along += J[k, i] * pull[i]
        for i in range(n):
            x[i] += along * J[k, i]
    lengths, is_active = np.empty(m), np.zeros(m, np.bool_)
    for i in range(m):
        lengths[i] = 0.0
        for k in range(n):
            lengths[i] += rows[i, k] ** 2
        lengths[i] = np.sqrt(lengths[i])
    inequalities = np.arange(equalities, m)
    R, u = np.zeros((n, n)), np.zeros(n)  # R's columns are rows here
    q = taken = 0
    entering, multiplier, missing = -1, 0.0, 0.0
    d, r, z = np.zeros(n), np.zeros(n), np.zeros(n)
    sign = 1.0
    for _ in range(MAX_STEPS_PER_VARIABLE * (n + equalities)):
        if entering < 0:
            if taken < equalities:
                entering, missing = taken, _excess(x, rows, bounds, taken)
                taken += 1
            else:
                entering, missing = _farthest_row(x, rows, bounds, lengths, is_active, expected)
                if entering < 0:
                    entering, missing = _farthest_row(x, rows, bounds, lengths, is_active, inequalities)
            if entering < 0:
                return active[:q], True
            sign, multiplier = 1.0 if missing <= 0.0 else -1.0, 0.0
            missing = -abs(missing)
        room = 0.0
        for k in range(n):
            d[k] = 0.0
            for i in range(n):
                d[k] += J[k, i] * rows[entering, i]
            d[k] *= sign
            if k >= q:
                room += d[k] ** 2
            r[k] = d[k]
        for j in range(q - 1, -1, -1):
            r[j] /= R[j, j]
            for i in range(j):
                r[i] -= r[j] * R[j, i]
        dual_step, leaving = np.inf, -1
        for j in range(q):
            if active[j] >= equalities and r[j] > 0.0 and u[j] < dual_step * r[j]:
                dual_step, leaving = u[j] / r[j], j
        is_free = q < n and room > (DEPENDENT_SHARE * lengths[entering]) ** 2 * largest
        primal_step = -missing / room if is_free else np.inf
        step = min(dual_step, primal_step)
        if not step < np.inf:
            return none, False
        for j in range(q):
            u[j] -= step * r[j]
        multiplier += step
        if is_free:
            for i in range(n):
                z[i] = 0.0
            for k in range(q, n):
                for i in range(n):
                    z[i] += d[k] * J[k, i]
            for i in range(n):
                x[i] += step * z[i]
            missing += step * room
        if primal_step <= dual_step:
            for k in range(n - 1, q, -1):
                _turn(d, k - 1, J, k - 1, k)
            for k in range(q + 1):
                R[q, k] = d[k]
            active[q], u[q], is_active[entering] = entering, multiplier, True
            q, entering = q + 1, -1
        else:
            is_active[active[leaving]] = False
            for j in range(leaving, q - 1):
                active[j], u[j] = active[j + 1], u[j + 1]
                for k in range(j + 2):
                    R[j, k] = R[j + 1, k]
            q -= 1
            for j in range(leaving, q):
                _turn_columns(R, q, j, J)
    return none, False


@compiled
def _farthest_row(
    x: Array, rows: Array, bounds: Array, lengths: Array, is_active: Array, among: Array
) -> tuple[int, float]:
    """The row that x is farthest beyond, -1 if there is none, and its value less its bound."""
    chosen, worst, missing = -1, -NEGLIGIBLE_VIOLATION, 0.0
    for i in among:
        if is_active[i]:
            continue
        value = _excess(x, rows, bounds, i)
        if value < worst * lengths[i]:
            chosen, worst, missing = i, value / lengths[i], value
    return chosen, missing


@compiled
def _excess(x: Array, rows: Array, bounds: Array, row: int) -> float:
    """A row's value less its bound."""
    value: float = -bounds[row]
    for k in range(len(x)):
        value += rows[row, k] * x[k]
    return value


@compiled
def _inverse_factor_rows(H: Array) -> tuple[Array, bool]:
    """The rows of L⁻¹ with ``H = L Lᵀ``, and whether H is positive definite."""
    n = len(H)
    L, J = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        for j in range(i + 1):
            rest = H[i, j]
            for k in range(j):
                rest -= L[i, k] * L[j, k]
            if j < i:
                L[i, j] = rest / L[j, j]
            elif rest > 0.0:
                L[i, i] = np.sqrt(rest)
            else:
                return J, False
    for i in range(n):
        J[i, i] = 1.0
        for j in range(i):
            for k in range(j + 1):
                J[i, k] -= L[i, j] * J[j, k]
        for k in range(i + 1):
            J[i, k] /= L[i, i]
    return J, True


@compiled
def _largest_square(J: Array) -> float:
    """The largest squared entry of a matrix."""
    most = 0.0
    for i in range(len(J)):
        for k in range(J.shape[1]):
            most = max(most, J[i, k] ** 2)
    return most


@compiled
def _turn(d: Array, place: int, J: Array, first: int, second: int) -> None:
    """Turn two rows of J so that the entry of d after a place becomes zero."""
    a, b = d[place], d[place + 1]
    length = np.hypot(a, b)
    if b == 0.0 or length == 0.0:
        return
    cosine, sine = a / length, b / length
    d[place], d[place + 1] = length, 0.0
    for i in range(J.shape[1]):
        one, other = J[first, i], J[second, i]
        J[first, i], J[second, i] = cosine * one + sine * other, cosine * other - sine * one


@compiled
def _turn_columns(R: Array, q: int, j: int, J: Array) -> None:
    """Make column j of R triangular again, whose entry below the diagonal is not zero, and turn the rest alike."""
    a, b = R[j, j], R[j, j + 1]
    length = np.hypot(a, b)
    if length == 0.0:
        return
    cosine, sine = a / length, b / length
    for column in range(j, q):
        one, other = R[column, j], R[column, j + 1]
        R[column, j], R[column, j + 1] = cosine * one + sine * other, cosine * other - sine * one
    for i in range(J.shape[1]):
        one, other = J[j, i], J[j + 1, i]
        J[j, i], J[j + 1, i] = cosine * one + sine * other, cosine * other - sine * one
