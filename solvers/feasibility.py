"""A test by the simplex method whether linear inequalities have a solution.

The general form of Dutertre and de Moura ("A fast linear-arithmetic solver for DPLL(T)", CAV 2006) fits: values
``s = A y`` with bounds, y free. Each s starts as a function of y; whichever is outside its bounds is moved onto the
nearer one by another variable that has room, and the two trade places. No objective is needed, and where no variable
has room, that row proves that there is no solution.
"""

import numpy as np

from solvers.rows import Array

MIN_RELATIVE_PIVOT = 1e-9
"""Smallest pivot, relative to the largest entry of A; smaller coefficients are rounding."""
GREEDY_PIVOTS_PER_ROW = 4
"""Pivots, per row of A, that are chosen by the largest violation; later ones follow Bland's rule, which terminates."""


def is_feasible(A: Array, lower: Array, upper: Array, tolerance: float) -> bool:
    """Whether some y has ``lower - tolerance <= A y <= upper + tolerance``.

    Args:
        A: Matrix, shape (m, n).
        lower, upper: Bounds, shapes (m,), infinite where there is none.
        tolerance: Violation that counts as none.
    """
    m, n = A.shape
    if (lower > upper + tolerance).any():
        return False
    T = A.copy()  # values of the variables in `basic` as functions of those in `others`
    smallest = MIN_RELATIVE_PIVOT * float(np.abs(A).max(initial=0.0))
    low, high = np.concatenate([np.full(n, -np.inf), lower]), np.concatenate([np.full(n, np.inf), upper])
    basic, others = np.arange(n, n + m), np.arange(n)
    value, at = np.zeros(m), np.zeros(n)
    trade = 0
    while True:
        greedy = trade < GREEDY_PIVOTS_PER_ROW * m
        violation = np.maximum(low[basic] - value, value - high[basic])
        if violation.max(initial=0.0) <= tolerance:
            return True
        r = int(np.argmax(violation) if greedy else _smallest_variable(violation > tolerance, basic))
        rising = bool(value[r] < low[basic[r]])
        slope = T[r] if rising else -T[r]
        room = ((slope > smallest) & (at < high[others])) | ((slope < -smallest) & (at > low[others]))
        if not room.any():
            return False
        j = int(np.argmax(np.where(room, np.abs(slope), 0.0)) if greedy else _smallest_variable(room, others))
        bound = float(low[basic[r]] if rising else high[basic[r]])
        step = (bound - value[r]) / T[r, j]
        value += step * T[:, j]
        value[r], at[j] = at[j] + step, bound
        basic[r], others[j] = others[j], basic[r]
        column, row = T[:, j].copy(), T[r] / -T[r, j]
        row[j] = 1.0 / T[r, j]
        T[:, j] = 0.0
        T += np.outer(column, row)
        T[r] = row
        trade += 1


def _smallest_variable(which: Array, variables: Array) -> int:
    """Index of the smallest variable number among those that qualify."""
    return int(np.argmin(np.where(which, variables, np.iinfo(int).max)))
