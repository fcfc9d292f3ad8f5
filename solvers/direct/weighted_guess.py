"""A guess at the active set of a hierarchy's last two levels: one quadratic program that weighs the two.

Where many inequalities come and go at once, as those of a foot that is about to lift do, adding the most violated one
and dropping what pulls the wrong way can go round in circles. The dual method of Goldfarb and Idnani does not, but
solves one strictly convex program. A weight instead of the priority moves the answer, and hardly the active set. What
is found here is only where `DirectSolver` starts, which checks it exactly.
"""

import numpy as np
import quadprog

from solvers.compiled import compiled
from solvers.dense import copy_into, forward_substitution, gram_cholesky, least_squares_in_solution_space, matrix_vector
from solvers.rows import Array

LAST_LEVEL_WEIGHT = 3e-3
"""Scale of the last level's rows against the level above it."""


def guessed_active_sides(
    X: Array, B: Array, b: Array, K: Array, r: Array, wish: Array, C: Array, lower: Array, upper: Array
) -> Array | None:
    """Sides of the inequalities that are active (p,): +1 at the upper bound, -1 at the lower one, 0 if not.

    Args:
        X: What x_1 may be, see `solution_space`, shape (1 + f, n_1).
        B, b: ``X Wᵀ`` and the right-hand side of W, shapes (1 + f, w) and (w,).
        K, r: Level 0's rows ``K x = r``, shapes (c, n) and (c,).
        wish: for x_2, (n - n_1,).
        C, lower, upper: Inequalities on x, shapes (p, n), (p,) and (p,).

    Returns:
        None if no x satisfies all of that, or W does not determine x_1.
    """
    first, determined = least_squares_in_solution_space(X, B, b)
    factor, shortest = gram_cholesky(B[1:])
    if not determined or not shortest > 0.0:
        return None
    equal, both = len(r), np.vstack([K, C])
    rows, low, high = _distance_rows(X, factor, first, wish, both, np.append(r, lower), np.append(r, upper))
    below, above = np.flatnonzero(low[equal:] > -np.inf), np.flatnonzero(high[equal:] < np.inf)
    normals = np.vstack([rows[:equal], rows[equal + below], -rows[equal + above]])
    bounds = np.concatenate([low[:equal], low[equal + below], -high[equal + above]])
    size = rows.shape[1]
    try:
        found = quadprog.solve_qp(np.eye(size), np.zeros(size), normals.T, bounds, equal, True)
    except ValueError:  # no point satisfies them
        return None
    active = found[5] - 1 - equal
    sides = np.zeros(len(lower))
    sides[below[active[(active >= 0) & (active < len(below))]]] = -1.0
    sides[above[active[active >= len(below)] - len(below)]] = 1.0
    return sides


@compiled
def _distance_rows(
    X: Array, factor: Array, first: Array, wish: Array, rows: Array, lower: Array, upper: Array
) -> tuple[Array, Array, Array]:
    """Rows of length 1 on variables in which the sum of squares is what both levels ask for, with their bounds.

    factor: Cholesky's, of W in X; first: x_1 of the level of W without inequalities.
    """
    count, leading, free = len(rows), X.shape[1], len(factor)
    out = np.zeros((count, free + len(wish)))
    low, high, order = np.empty(count), np.empty(count), np.arange(free)
    for k in range(count):
        copy_into(out[k], forward_substitution(factor, order, matrix_vector(X[1:], rows[k, :leading])))
        value, square = 0.0, 0.0
        for i in range(leading):
            value += rows[k, i] * first[i]
        for i in range(free):
            out[k, i] *= LAST_LEVEL_WEIGHT
            square += out[k, i] ** 2
        for i in range(len(wish)):
            value += rows[k, leading + i] * wish[i]
            out[k, free + i] = rows[k, leading + i]
            square += rows[k, leading + i] ** 2
        length = np.sqrt(square) if square > 0.0 else 1.0
        for i in range(out.shape[1]):
            out[k, i] /= length
        low[k] = LAST_LEVEL_WEIGHT * (lower[k] - value) / length
        high[k] = LAST_LEVEL_WEIGHT * (upper[k] - value) / length
    return out, low, high
