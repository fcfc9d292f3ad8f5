"""The cascade of a tick whose inequalities are active at its last two levels only, or not at all.

Most ticks are of that kind, and they need no null-space basis between levels. With variables (x_1, x_2) as in
`Reduction`, and as long as each level's rows J_k can be met exactly, the lexicographic optimum of

    J_0 x_1 = b_0,  J_1 x_1 = b_1,  ...

are the solutions of all of them together: one factorisation. The first level that has no fewer rows than variables are
left, ``W x_1 = b``, takes these by least squares: that determines x_1. Then x_2 has to answer what level 0 asks of it,
``R x_2 = r − P x_1``, and the last level, which wants ``x_2 = w``, gets the nearest point that does.

Active inequalities are held as equalities. Rows that x_2 can satisfy beside R cost the last level something. Where
there are more than x_2 can satisfy, combinations of them without x_2 are rows on x_1, and cost the level of W.

Which ones are active is tried from the last tick's on, and where that goes round in circles, from `weighted_guess` on.

The result is checked exactly: all inequalities of level 0 hold, and the held ones push the right way at the level that
they cost first. What does not fit is left to others: rows that contradict each other, a level of another kind, an
inequality that bites higher up.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.compiled import compiled
from solvers.dense import (
    DEPENDENT_BELOW,
    INDEPENDENT_ABOVE,
    WELL_CONDITIONED_ABOVE,
    apply_q_transposed,
    backward_substitution,
    copy_into,
    forward_substitution,
    gram_cholesky,
    least_squares_in_solution_space,
    lq_factorization,
    matrix_vector,
    solution_space,
)
from solvers.direct.weighted_guess import guessed_active_sides
from solvers.reduction import leading_count
from solvers.rows import Array, Equality, Level

MAX_ACTIVE_SET_CHANGES = 6
"""Largest number of changes to the active set before the solver gives up."""
IRRATIONAL = 1.0 / np.pi
FOUND, NOT_FOUND, UNFIT = 1, 0, -1
"""How a search for the active set ended; UNFIT: levels that no active set makes a hierarchy of this kind."""


class DirectSolver:
    """Solves a hierarchy by one factorisation where no null spaces between levels are needed.

    Args:
        tolerance: Violation that counts as none.

    Attributes:
        active_sides: Inequalities of level 0 that are held: +1 at their upper bound, -1 at the lower one, 0 if not.
        max_violation: Largest violation of an inequality in the last answer.
        levels_met: How many levels, level 0 included, have all their rows met by the last answer.
    """

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.active_sides = np.zeros(0)
        self.max_violation = 0.0
        self.levels_met = 0
        self._shape = (0, 0)
        self._kind: object | None = None  # of the levels that were solved last
        self._parts: _Structure | None = None  # and what they are made of

    def warm_start(self, rows: Array, side: Array) -> None:
        """Start the next solve with these rows active, at the upper bound where `side` is positive."""
        known = rows < len(self.active_sides)
        self.active_sides[:] = 0.0
        self.active_sides[rows[known]] = side[known]

    def solve(self, levels: Sequence[Level]) -> Array | None:
        """The optimum, shape (n,), or None if this is not a hierarchy of that kind."""
        hard, size = levels[0], levels[0].size
        if hard.structure_key is None or hard.structure_key is not self._kind:
            self._kind, self._parts = hard.structure_key, _Structure.of(levels)
            shape = len(hard.lower), size
            if shape != self._shape:
                self._shape, self.active_sides = shape, np.zeros(len(hard.lower))
        parts = self._parts
        if parts is None:
            return None
        leading, last, x = parts.leading, parts.last, np.empty(size)
        if last is not None:
            np.divide(last.b, last.scale, out=x[leading:])
        X, independent = solution_space(*_stacked_rows(parts.exact, leading))
        if not independent:
            return None
        K, r = _stacked_rows(parts.coupled, size)
        W, b = _row_products(parts.overdetermined, X)
        bounds, wish = (hard.C, hard.lower, hard.upper), x[leading:].copy()
        outcome, self.max_violation = _active_set_optimum(X, W, b, K, r, x, *bounds, self.active_sides, self.tolerance)
        if outcome == NOT_FOUND:
            sides = guessed_active_sides(X, W, b, K, r, wish, *bounds, self.active_sides)
            if sides is None:
                return None
            self.active_sides, x[leading:] = sides, wish
            outcome, self.max_violation = _active_set_optimum(X, W, b, K, r, x, *bounds, sides, self.tolerance)
        self.levels_met = parts.levels_met
        return x if outcome == FOUND else None


@dataclass(slots=True)
class _Structure:
    """A hierarchy's equalities, sorted by how they are solved.

    `leading` variables make up x_1, and the first `levels_met` levels have exact rows only.
    """

    leading: int
    exact: list[Equality]
    overdetermined: list[Equality]
    coupled: list[Equality]
    last: Equality | None
    levels_met: int

    @classmethod
    def of(cls, levels: Sequence[Level]) -> "_Structure | None":
        """Sort the equalities of a hierarchy; None if it is of another structure."""
        leading, met = leading_count(levels), 1
        trailing = levels[0].size - leading
        thin: list[Equality] = []
        coupled: list[Equality] = []
        for e in levels[0].equalities:
            (coupled if e.start + e.A.shape[1] > leading else thin).append(e)
        used = sum(len(e.b) for e in thin)
        wide: list[Equality] = []
        last: Equality | None = None
        if used > leading:
            return None
        for level in levels[1:]:
            if len(level.lower):
                return None
            if last is not None or not level.equalities:
                continue
            if level.leading_columns > leading:
                last = level.equalities[0]
                if used < leading or len(level.equalities) > 1:
                    return None
                if last.start != leading or last.selects != slice(0, trailing):
                    return None
            elif used < leading:
                rows = sum(len(e.b) for e in level.equalities)
                if used + rows < leading:
                    thin.extend(level.equalities)
                    met += 1
                else:
                    wide = level.equalities
                used += rows
        if used < leading or (last is None and trailing):
            return None
        return cls(leading, thin, wide, coupled, last, met)


def least_norm_solution(exact: Sequence[Equality], overdetermined: Sequence[Equality], count: int) -> Array | None:
    """Least-norm x with all `exact` rows met and the `overdetermined` ones by least squares in their null space.

    Args:
        exact: No more rows than there are variables.
        overdetermined: Rows that determine what the others leave; none if that stays 0.
        count: Number of variables.

    Returns:
        x, shape (count,), or None if rows depend on each other.
    """
    X, solved = solution_space(*_stacked_rows(exact, count))
    if not solved or not overdetermined:
        return X[0] if solved else None
    x, solved = least_squares_in_solution_space(X, *_row_products(overdetermined, X))
    return x if solved else None


def _stacked_rows(equalities: Sequence[Equality], count: int) -> tuple[Array, Array]:
    """Rows stacked to one matrix on the leading variables, and their right-hand side."""
    used = 0
    for e in equalities:
        used += len(e.b)
    J, target = np.zeros((used, count)), np.empty(used)
    row = 0
    for e in equalities:
        _copy_scaled_rows(J, target, row, e.start, e.A, e.scale, e.b)
        row += len(e.b)
    return J, target


@compiled
def _copy_scaled_rows(J: Array, target: Array, row: int, start: int, A: Array, scale: float, b: Array) -> None:
    for i in range(len(b)):
        target[row + i] = b[i]
        for k in range(A.shape[1]):
            J[row + i, start + k] = scale * A[i, k]


def _row_products(equalities: Sequence[Equality], X: Array) -> tuple[Array, Array]:
    """Rows W and right-hand side b of the leading variables as ``X Wᵀ`` and b."""
    count = 0
    for e in equalities:
        count += len(e.b)
    products, target = np.empty((len(X), count)), np.empty(count)
    row = 0
    for e in equalities:
        own = slice(row, row := row + len(e.b))
        e.write_row_products(X, products[:, own])
        target[own] = e.b
    return products, target


@compiled
def _active_set_optimum(
    X: Array,
    B: Array,
    b: Array,
    K: Array,
    r: Array,
    x: Array,
    C: Array,
    lower: Array,
    upper: Array,
    held: Array,
    tolerance: float,
) -> tuple[int, float]:
    """Find x by an active-set iteration over the inequalities.

    Args:
        X: What x_1 may be, see `solution_space`, shape (1 + f, n_1).
        B, b: ``X Wᵀ`` and the right-hand side of W, shapes (1 + f, w) and (w,).
        K, r: Level 0's rows ``P x_1 + R x_2 = r`` as a matrix on x, shapes (c, n) and (c,).
        x: Ends with the wish for x_2, shape (n,); replaced by the answer.
        C, lower, upper: Inequalities on x, shapes (p, n), (p,) and (p,).
        held: Side on which a row is held first, shape (p,); replaced by those that turned out right.
        tolerance: Violation that counts as none.

    Returns:
        FOUND, NOT_FOUND or UNFIT, and the largest violation in the answer.
    """
    leading = X.shape[1]
    first, determined = least_squares_in_solution_space(X, B, b)
    if not determined:
        return UNFIT, 0.0
    wish, side, x_1 = x[leading:].copy(), held.copy(), first
    factor, shortest = np.zeros((0, 0)), 1.0
    for row in range(len(side)):
        # A bound that has gone, a ramp's at its end say, holds nothing any more.
        if side[row] != 0.0 and not abs(upper[row] if side[row] > 0.0 else lower[row]) < np.inf:
            side[row] = 0.0
    keys = np.zeros(MAX_ACTIVE_SET_CHANGES)  # of the active sets tried so far
    for trial in range(MAX_ACTIVE_SET_CHANGES):
        count = len(r)
        for row in range(len(side)):
            if side[row] != 0.0:
                count += 1
                keys[trial] += side[row] * np.sqrt(row + IRRATIONAL)  # no two sets have the same sum
        for earlier in range(trial):
            if keys[earlier] == keys[trial]:
                return NOT_FOUND, 0.0  # it goes round in circles
        rows, target = np.empty((count, len(x))), np.empty(count)
        owner = np.full(count, -1)
        for k in range(len(r)):
            copy_into(rows[k], K[k])
            target[k] = r[k]
        k = len(r)
        for row in range(len(side)):
            if side[row] != 0.0:
                copy_into(rows[k], C[row])
                target[k], owner[k] = upper[row] if side[row] > 0.0 else lower[row], row
                k += 1
        L, V, factors, kept, certain = lq_factorization(rows[:, leading:].copy())
        if not certain or len(kept) < len(r) or (len(r) and kept[len(r) - 1] >= len(r)):
            return NOT_FOUND, 0.0
        costs = np.zeros(count)  # multipliers of the rows at the level of W
        x_1 = first
        if len(kept) < count:
            if not len(factor):
                factor, shortest = gram_cholesky(B[1:])
            if not shortest > WELL_CONDITIONED_ABOVE:
                return UNFIT, 0.0
            x_1, costs, certain = _nearest_leading_and_multipliers(X, first, factor, rows, target, L, kept)
            if not certain:
                return NOT_FOUND, 0.0
        missing = target - matrix_vector(rows[:, :leading], x_1) - matrix_vector(rows[:, leading:], wish)
        step = np.zeros(len(wish))
        copy_into(step, forward_substitution(L, kept, missing))
        pushes = backward_substitution(L, kept, step[: len(kept)])
        apply_q_transposed(V, factors, len(kept), step)
        for i in range(leading):
            x[i] = x_1[i]
        for i in range(len(wish)):
            x[leading + i] = wish[i] + step[i]
        pulls = False
        for k in range(count):
            if owner[k] >= 0 and side[owner[k]] * costs[k] > tolerance:
                side[owner[k]] = 0.0
                pulls = True
        if pulls:
            continue
        for k, row in enumerate(kept):
            if owner[row] >= 0 and abs(costs[row]) <= tolerance and side[owner[row]] * pushes[k] > 0.0:
                side[owner[row]] = 0.0
                pulls = True
        if pulls:
            continue
        worst, chosen, above = -np.inf, -1, False
        for row in range(len(side)):
            value = 0.0
            for i in range(len(x)):
                value += C[row, i] * x[i]
            excess = max(value - upper[row], lower[row] - value)
            if not excess <= worst:
                worst, chosen, above = excess, row, value > upper[row]
        if worst <= tolerance:
            copy_into(held, side)
            return FOUND if x @ x < np.inf else UNFIT, max(worst, 0.0)
        if side[chosen] != 0.0:
            return NOT_FOUND, 0.0
        side[chosen] = 1.0 if above else -1.0
    return NOT_FOUND, 0.0


@compiled
def _nearest_leading_and_multipliers(
    X: Array, first: Array, factor: Array, rows: Array, target: Array, L: Array, kept: Array
) -> tuple[Array, Array, bool]:
    """The x_1 nearest to its first choice, in the norm of the level of W, for which x_2 can satisfy all rows.

    Args:
        X: What x_1 may be.
        first: What it would be without the rows, shape (n_1,).
        factor: Cholesky's, of W in X.
        rows, target: On x, shapes (m, n) and (m,).
        L, kept: Factor of the rows as far as they are on x_2, and which of them x_2 can answer.

    Returns:
        x_1, the rows' multipliers at that level, shape (m,), and whether there is no doubt about them.
    """
    free, leading, m = len(X) - 1, X.shape[1], len(rows)
    answered = np.zeros(m, np.bool_)
    for row in kept:
        answered[row] = True
    over = np.flatnonzero(~answered)
    shares = np.zeros((len(over), len(kept)))
    A, missing = np.zeros((len(over), free)), np.zeros(len(over))
    order, longest = np.arange(free), np.sqrt(np.sum(rows[:, :leading] ** 2))
    for k, row in enumerate(over):
        copy_into(shares[k], backward_substitution(L, kept, L[row, : len(kept)].copy()))
        combined, gap = rows[row, :leading].copy(), target[row]
        for j, other in enumerate(kept):
            if shares[k, j] != 0.0:
                gap -= shares[k, j] * target[other]
                for i in range(leading):
                    combined[i] -= shares[k, j] * rows[other, i]
        size, most = 0.0, 1.0
        for i in range(leading):
            gap -= combined[i] * first[i]
            size += combined[i] ** 2
        for j in range(len(kept)):
            most = max(most, abs(shares[k, j]))
        movable = matrix_vector(X[1:], combined)
        # What is left of a row that others imply, or that no x_1 can change, is rounding.
        if size > (DEPENDENT_BELOW * most * longest) ** 2 and movable @ movable > INDEPENDENT_ABOVE**2 * size:
            copy_into(A[k], forward_substitution(factor, order, movable))  # where the level of W is a distance
            missing[k] = gap
    L_1, V, factors, held, certain = lq_factorization(A)
    step = np.zeros(free)
    copy_into(step, forward_substitution(L_1, held, missing))
    nu = backward_substitution(L_1, held, step[: len(held)])
    apply_q_transposed(V, factors, len(held), step)
    y = backward_substitution(factor, order, step)
    x_1, costs = first.copy(), np.zeros(m)
    for i in range(free):
        for k in range(leading):
            x_1[k] += y[i] * X[1 + i, k]
    for k in range(len(held)):
        costs[over[held[k]]] += nu[k]
        for j in range(len(kept)):
            costs[kept[j]] -= shares[held[k], j] * nu[k]
    return x_1, costs, certain
