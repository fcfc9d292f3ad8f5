"""A guess at the active set of a hierarchy's last two levels: one quadratic program that weighs the two.

Where many inequalities come and go at once, as those of a foot that is about to lift do, adding the most violated one
and dropping what pulls the wrong way can go round in circles. The dual method of Goldfarb and Idnani does not, but
solves one strictly convex program. A weight instead of the priority moves the answer, and hardly the active set. What
is found here is only where `DirectSolver` starts, which checks it exactly.
"""

import numpy as np
import quadprog

from solvers.rows import Array

LAST_LEVEL_WEIGHT = 1e-6
"""Weight of the last level beside the one above it."""


def guessed_active_sides(
    X: Array, B: Array, b: Array, K: Array, r: Array, wish: Array, C: Array, lower: Array, upper: Array
) -> Array | None:
    """Active sides of ``min ‖W x_1 − b‖² + ε ‖x_2 − wish‖²`` under all rows; None if there is no such x.

    Args:
        X: What x_1 may be, see `solution_space`, shape (1 + f, n_1).
        B, b: ``X Wᵀ`` and the right-hand side of W, shapes (1 + f, w) and (w,).
        K, r: Equalities on x = (x_1, x_2), shapes (c, n) and (c,).
        wish: For x_2, shape (n_2,).
        C, lower, upper: Inequalities on x, shapes (p, n), (p,) and (p,).

    Returns:
        +1 where a row is tight at its upper bound, −1 at the lower one, 0 elsewhere, shape (p,).
    """
    leading, free, trailing = X.shape[1], len(X) - 1, len(wish)
    above, below = np.flatnonzero(upper < np.inf), np.flatnonzero(lower > -np.inf)
    if not free + trailing or not len(above) + len(below):
        return None
    scale = float(np.square(B[1:]).sum(axis=1).mean()) if free else 1.0
    H, pull = np.zeros((free + trailing, free + trailing)), np.zeros(free + trailing)
    H[:free, :free], pull[:free] = B[1:] @ B[1:].T, B[1:] @ (b - B[0])
    np.fill_diagonal(H[free:, free:], LAST_LEVEL_WEIGHT * scale)
    # in (y, x_2 − wish), with x_1 = X[0] + X[1:]ᵀ y
    value = C[:, :leading] @ X[0] + C[:, leading:] @ wish
    rows = np.hstack([C[:, :leading] @ X[1:].T, C[:, leading:]])
    equal = np.hstack([K[:, :leading] @ X[1:].T, K[:, leading:]])
    missing = r - K[:, :leading] @ X[0] - K[:, leading:] @ wish
    try:
        *_, active = quadprog.solve_qp(
            H,
            pull,
            np.vstack([equal, -rows[above], rows[below]]).T,
            np.concatenate([missing, (value - upper)[above], (lower - value)[below]]),
            len(r),
        )
    except ValueError:  # the rows contradict each other, or H is singular
        return None
    sides, active = np.zeros(len(upper)), active - 1 - len(r)
    sides[above[active[(active >= 0) & (active < len(above))]]] = 1.0
    sides[below[active[active >= len(above)] - len(above)]] = -1.0
    return sides
