"""The cascade of a tick on which inequalities bite at its last level only, or not at all.

Most ticks are of that kind, and they need no null-space basis between levels. With variables (x_1, x_2) as in
`Reduction`, and as long as each level's rows J_k can be met exactly, the lexicographic optimum of

    J_0 x_1 = b_0,  J_1 x_1 = b_1,  ...

is the least-norm solution of all of them together: one factorisation ``[J_0; J_1; ...]ᵀ = Q R``, one triangular solve.
The first level with more rows than there are variables left takes these by least squares. Then x_2 has to answer
what level 0 asks of it, ``R x_2 = r − P x_1``, and the last level, which wants ``x_2 = b``, gets the nearest point:

    x_2 = b + T⁺ (t − T b),   T the rows R and those inequalities on x_2 that are held.

The result is checked exactly: all inequalities of level 0 hold, and the held ones push the right way. What does not
fit is left to others: rows that contradict each other, a level of another kind, an inequality that bites higher up.
"""

from collections.abc import Sequence

import numpy as np

from solvers.compiled import compiled
from solvers.dense import backward, forward, independent, lq, nearest, solutions, turn
from solvers.rows import Array, Equality, Level

ROUNDS = 8
"""Changes of the held inequalities before it is given up."""


class Direct:
    """Solves the ticks that need no null spaces.

    Args:
        tolerance: Violation that counts as none.

    Attributes:
        held: Inequalities of level 0 held at the last level: +1 at their upper bound, -1 at the lower one, 0 if not.
        excess: Largest violation of an inequality in the last answer.
        met: How many levels, level 0 included, have all their rows met by the last answer.
    """

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.held = np.zeros(0)
        self.excess = 0.0
        self.met = 0
        self._shape = (0, 0, 0)

    def expect(self, rows: Array, side: Array) -> None:
        """Start the next time with these rows held, at the upper bound where `side` is positive."""
        known = rows < len(self.held)
        self.held[:] = 0.0
        self.held[rows[known]] = side[known]

    def solve(self, levels: Sequence[Level], leading: int) -> Array | None:
        """The optimum, shape (n,), or None if this is not a hierarchy of that kind."""
        hard, size = levels[0], levels[0].size
        shape = len(hard.lower), size, leading
        if shape != self._shape:
            self._shape, self.held = shape, np.zeros(len(hard.lower))
        if any(len(level.lower) for level in levels[1:]):
            return None
        thin: list[Equality] = []
        coupled: list[Equality] = []
        for e in hard.equalities:
            (coupled if e.start + e.A.shape[1] > leading else thin).append(e)
        used, self.met = sum(len(e.b) for e in thin), 1
        wide: list[Equality] = []
        last: Equality | None = None
        for level in levels[1:]:
            if last is not None or not level.equalities:
                continue
            if level.columns > leading:
                last = level.equalities[0]
                if used < leading or len(level.equalities) > 1 or last.selects != slice(0, size - leading):
                    return None
                if last.start != leading:
                    return None
            elif used < leading:
                rows = sum(len(e.b) for e in level.equalities)
                if used + rows <= leading:
                    thin.extend(level.equalities)
                    self.met += 1
                else:
                    wide = level.equalities
                used += rows
        if used < leading or (last is None and size > leading) or sum(len(e.b) for e in thin) > leading:
            return None
        x = np.empty(size)
        first = at_once(thin, wide, leading)
        if first is None:
            return None
        x[:leading] = first
        return self._trailing(hard, coupled, last, x, leading)

    def _trailing(
        self, hard: Level, coupled: Sequence[Equality], last: Equality | None, x: Array, leading: int
    ) -> Array | None:
        """Fill in x_2, and hold what has to be."""
        known = sum(len(e.b) for e in coupled)
        T, target = np.zeros((known, len(x) - leading)), np.empty(known)
        row = 0
        for e in coupled:
            rows, before = slice(row, row + len(e.b)), max(leading - e.start, 0)
            first = e.start + before - leading
            np.multiply(e.A[:, before:], e.scale, out=T[rows, first : first + e.A.shape[1] - before])
            target[rows] = e.b
            if before:
                target[rows] -= e.scale * (e.A[:, :before] @ x[e.start : leading])
            row = rows.stop
        if last is not None:
            np.divide(last.b, last.scale, out=x[leading:])
        solved, self.excess = _fill_in(T, target, x, leading, hard.C, hard.lower, hard.upper, self.held, self.tolerance)
        return x if solved else None


def at_once(thin: Sequence[Equality], wide: Sequence[Equality], count: int) -> Array | None:
    """Least-norm x with all `thin` rows exactly, in any order, and the `wide` ones by least squares in what they leave.

    Args:
        thin: No more rows than there are variables.
        wide: Rows that determine what the others leave; none if that stays 0.
        count: Number of variables.

    Returns:
        x, shape (count,), or None if rows depend on each other.
    """
    used = sum(len(e.b) for e in thin)
    J, target = np.zeros((used, count)), np.empty(used)
    row = 0
    for e in thin:
        rows = slice(row, row + len(e.b))
        np.multiply(e.A, e.scale, out=J[rows, e.start : e.start + e.A.shape[1]])
        target[rows] = e.b
        row = rows.stop
    X, solved = solutions(J, target)
    if not solved:
        return None
    if not wide:
        return X[0]
    seen = [e.seen(X) for e in wide]
    if len(seen) == 1:
        x, solved = nearest(X, seen[0], wide[0].b)
    else:
        x, solved = nearest(X, np.hstack(seen), np.hstack([e.b for e in wide]))
    return x if solved else None


@compiled
def _fill_in(
    T: Array,
    target: Array,
    x: Array,
    leading: int,
    C: Array,
    lower: Array,
    upper: Array,
    held: Array,
    tolerance: float,
) -> tuple[bool, float]:
    """x_2 nearest to its wish with ``T x_2 = target`` and the inequalities that have to be held.

    Args:
        T, target: Rows that hold, shapes (k, n_2) and (k,).
        x: All variables, shape (n,): x_1, and the wish for x_2, which is replaced.
        leading: Number of variables in x_1.
        C, lower, upper: Inequalities on x, shapes (p, n), (p,) and (p,).
        held: Side on which a row is held first, shape (p,); replaced by those that turned out right.
        tolerance: Violation that counts as none.

    Returns:
        Whether that is the answer, and the largest violation in it.
    """
    known, count = T.shape
    wish, side = x[leading:].copy(), held.copy()
    for row in range(len(side)):
        # A bound that has gone, a ramp's at its end say, holds nothing any more.
        if side[row] != 0.0 and not abs(upper[row] if side[row] > 0.0 else lower[row]) < np.inf:
            side[row] = 0.0
    values = np.empty(len(side))
    for _ in range(ROUNDS):
        rows: list[int] = [row for row in range(len(side)) if side[row] != 0.0]
        used = known + len(rows)
        if used > count:
            return False, 0.0
        J, missing = np.empty((used, count)), np.empty(used)
        J[:known], missing[:known] = T, target
        for k, row in enumerate(rows):
            J[known + k] = C[row, leading:]
            missing[known + k] = upper[row] if side[row] > 0.0 else lower[row]
        for k in range(used):
            for i in range(count):
                missing[k] -= J[k, i] * wish[i]
        L, V, factors = lq(J)
        if not independent(L):
            return False, 0.0
        step = np.zeros(count)
        step[:used] = forward(L, missing)
        pushes = -backward(L, step[:used])
        turn(V, factors, step)
        for i in range(count):
            x[leading + i] = wish[i] + step[i]
        pulls = False
        for k, row in enumerate(rows):
            if side[row] * pushes[known + k] < 0.0:
                side[row] = 0.0
                pulls = True
        if pulls:
            continue
        worst, movable, chosen = -np.inf, tolerance, -1
        for row in range(len(side)):
            value = 0.0
            for i in range(len(x)):
                value += C[row, i] * x[i]
            values[row] = value
            excess = max(value - upper[row], lower[row] - value)
            if not excess <= worst:
                worst = excess
            if excess > movable and not C[row, :leading].any():
                movable, chosen = excess, row
        if worst <= tolerance:
            held[:] = side
            return bool(x @ x < np.inf), max(worst, 0.0)
        if chosen < 0 or side[chosen] != 0.0:
            return False, 0.0
        side[chosen] = 1.0 if values[chosen] > upper[chosen] else -1.0
    return False, 0.0
