"""A guess at the active set of a hierarchy's last two levels: one quadratic program that weighs the two.

Where many inequalities come and go at once, as those of a foot that is about to lift do, adding the most violated one
and dropping what pulls the wrong way can go round in circles. The dual method of Goldfarb and Idnani does not, but
solves one strictly convex program. A weight instead of the priority moves the answer, and hardly the active set. What
is found here is only where `DirectSolver` starts, which checks it exactly.
"""

import numpy as np

from solvers.compiled import compiled
from solvers.direct.dual_active_set import active_rows
from solvers.rows import Array

LAST_LEVEL_WEIGHT = 1e-6
"""Weight of the last level beside the one above it."""


def guessed_active_sides(
    X: Array, B: Array, b: Array, K: Array, r: Array, wish: Array, C: Array, lower: Array, upper: Array, last: Array
) -> Array | None:
    """Active sides of ``min ‖W x_1 − b‖² + ε ‖x_2 − wish‖²`` under all rows; None if there is no such x.

    Args:
        X: What x_1 may be, see `solution_space`, shape (1 + f, n_1).
        B, b: ``X Wᵀ`` and the right-hand side of W, shapes (1 + f, w) and (w,).
        K, r: Equalities on x = (x_1, x_2), shapes (c, n) and (c,).
        wish: For x_2, shape (n_2,).
        C, lower, upper: Inequalities on x, shapes (p, n), (p,) and (p,).
        last: The answer to a program much like this one, zeros if there was none, shape (p,).

    Returns:
        +1 where a row is tight at its upper bound, −1 at the lower one, 0 elsewhere, shape (p,).
    """
    sides, found = _tight_sides(X, B, b, K, r, wish, C, lower, upper, last)
    return sides if found else None


@compiled
def _tight_sides(
    X: Array, B: Array, b: Array, K: Array, r: Array, wish: Array, C: Array, lower: Array, upper: Array, last: Array
) -> tuple[Array, bool]:
    """As `guessed_active_sides`, and whether there are any."""
    sides = np.zeros(len(upper))
    H, pull, rows, bounds, owner = _weighted_program(X, B, b, K, r, wish, C, lower, upper)
    if not len(H) or len(bounds) == len(r):
        return sides, False
    expected, count = np.empty(len(bounds), np.int64), 0
    for row in range(len(r), len(bounds)):
        if owner[row] * last[abs(owner[row]) - 1] > 0.0:
            expected[count] = row
            count += 1
    active, found = active_rows(H, pull, rows, bounds, len(r), expected[:count])
    for row in active:
        if owner[row] != 0:
            sides[abs(owner[row]) - 1] = 1.0 if owner[row] > 0 else -1.0
    return sides, found


@compiled
def _weighted_program(
    X: Array, B: Array, b: Array, K: Array, r: Array, wish: Array, C: Array, lower: Array, upper: Array
) -> tuple[Array, Array, Array, Array, Array]:
    """The program in z = (y, x_2 − wish), with x_1 = X[0] + X[1:]ᵀ y.

    Returns:
        H, pull: of ½ zᵀHz − pullᵀz, which is to be least.
        rows, bounds: ``rows z >= bounds``, the first of which are equalities.
        owner: of each row the number of its inequality, from 1 on, negative at a lower bound; 0 of equalities.
    """
    free, trailing, count = len(X) - 1, len(wish), len(r)
    size = free + trailing
    for i in range(len(upper)):
        count += int(upper[i] < np.inf) + int(lower[i] > -np.inf)
    H, pull, scale = np.zeros((size, size)), np.zeros(size), 0.0
    for i in range(free):
        for j in range(i + 1):
            total = 0.0
            for k in range(B.shape[1]):
                total += B[1 + i, k] * B[1 + j, k]
            H[i, j] = H[j, i] = total
        scale += H[i, i] / free
        for k in range(B.shape[1]):
            pull[i] += B[1 + i, k] * (b[k] - B[0, k])
    for i in range(free, size):
        H[i, i] = LAST_LEVEL_WEIGHT * (scale if free else 1.0)
    rows, bounds, owner, row = np.empty((count, size)), np.empty(count), np.zeros(count, np.int64), len(r)
    for i in range(len(r)):
        bounds[i] = r[i] - _write_row(K[i], X, wish, rows[i])
    for i in range(len(upper)):
        has_upper, has_lower = upper[i] < np.inf, lower[i] > -np.inf
        if not (has_upper or has_lower):
            continue
        value = _write_row(C[i], X, wish, rows[row])
        if has_lower:
            bounds[row], owner[row] = lower[i] - value, -i - 1
            row += 1
        if has_upper:
            bounds[row], owner[row] = value - upper[i], i + 1
            for k in range(size):
                rows[row, k] = -rows[row - int(has_lower), k]
            row += 1
    return H, pull, rows, bounds, owner


@compiled
def _write_row(row: Array, X: Array, wish: Array, out: Array) -> float:
    """Write a row on x as one on z, and return its value at z = 0."""
    leading, value, first = X.shape[1], 0.0, 0
    while first < leading and row[first] == 0.0:  # many rows are on x_2 alone, or on one joint
        first += 1
    stop = leading
    while stop > first and row[stop - 1] == 0.0:
        stop -= 1
    for i in range(len(X)):
        total = 0.0
        for k in range(first, stop):
            total += row[k] * X[i, k]
        if i:
            out[i - 1] = total
        else:
            value = total
    for k in range(len(wish)):
        out[len(X) - 1 + k] = row[leading + k]
        value += row[leading + k] * wish[k]
    return value
