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
from math import isfinite

import numpy as np
from scipy.linalg import lapack

from solvers.nullspace import determined
from solvers.rows import Array, Equality, Level

INDEPENDENT = 1e-5
"""Rows are taken to be independent if none is closer to the others' span than this, relative to the farthest."""
ROUNDS = 8
"""Changes of the held inequalities before it is given up."""
_WORK = 64 * 64


class Direct:
    """Solves the ticks that need no null spaces.

    Args:
        tolerance: Violation that counts as none.

    Attributes:
        held: Inequalities of level 0 held at the last level: row -> +1 at its upper bound, -1 at its lower one.
        excess: Largest violation of an inequality in the last answer.
        met: How many levels, level 0 included, have all their rows met by the last answer.
    """

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.held: dict[int, float] = {}
        self.excess = 0.0
        self.met = 0
        self._shape = (0, 0, 0)

    def expect(self, rows: Array, side: Array) -> None:
        """Start the next time with these rows held, at the upper bound where `side` is positive."""
        self.held = dict(zip(rows.tolist(), side.tolist(), strict=True))

    def solve(self, levels: Sequence[Level], leading: int) -> Array | None:
        """The optimum, shape (n,), or None if this is not a hierarchy of that kind."""
        hard, size = levels[0], levels[0].size
        shape = len(hard.lower), size, leading
        if shape != self._shape:
            self._shape, self.held = shape, {}
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
        count = len(x) - leading
        known = sum(len(e.b) for e in coupled)
        wish = last.b / last.scale if last is not None else x[leading:]
        T = np.zeros((count, count), order="F")
        target = np.empty(count)
        row = 0
        for e in coupled:
            m, before = len(e.b), max(leading - e.start, 0)
            end = e.start + e.A.shape[1] - leading
            np.multiply(e.A[:, before:].T, e.scale, out=T[end - e.A.shape[1] + before : end, row : row + m])
            target[row : row + m] = e.b
            if before:
                target[row : row + m] -= e.scale * (e.A[:, :before] @ x[e.start : leading])
            row += m
        # A bound that has gone, a ramp's at its end say, holds nothing any more.
        held = {r: side for r, side in self.held.items() if isfinite(hard.upper[r] if side > 0.0 else hard.lower[r])}
        for _ in range(ROUNDS):
            rows = list(held)
            used = known + len(rows)
            if used > count:
                return None
            if rows:
                T[:, known:used] = hard.C[rows, leading:].T
                target[known:used] = [hard.upper[r] if side > 0.0 else hard.lower[r] for r, side in held.items()]
            x[leading:] = wish
            if used:
                nearest = _nearest(T[:, :used], target[:used], wish, len(rows))
                if nearest is None:
                    return None
                x[leading:], pushes = nearest
                if pulls := [r for r, push in zip(rows, pushes.tolist(), strict=True) if held[r] * push < 0.0]:
                    for r in pulls:
                        del held[r]
                    continue
            value = hard.C @ x
            above, below = value - hard.upper, hard.lower - value
            excess = np.maximum(above, below)
            worst = float(np.maximum.reduce(excess)) if len(excess) else 0.0
            if worst <= self.tolerance:
                self.held, self.excess = held, max(worst, 0.0)
                return x if x @ x < np.inf else None
            excess[hard.C[:, :leading].any(axis=1)] = 0.0
            r = int(np.argmax(excess))
            if not excess[r] > self.tolerance or r in held:
                return None
            held[r] = 1.0 if above[r] > below[r] else -1.0
        return None


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
    J, target = np.empty((count, used), order="F"), np.empty(used)
    row = 0
    for e in thin:
        end = row + len(e.b)
        if e.A.shape[1] < count or e.start:
            J[:, row:end] = 0.0
        J[e.start : e.start + e.A.shape[1], row:end] = e.A.T
        if e.scale != 1.0:
            J[:, row:end] *= e.scale
        target[row:end] = e.b
        row = end
    turned = np.zeros((count, 1 + count - used), order="F")
    if used < count:
        turned.reshape(-1, order="F")[count + used :: count + 1] = 1.0
    if used:
        qr, tau, _, _ = lapack.dgeqrf(J, lwork=_WORK, overwrite_a=1)
        if not _independent(qr):
            return None
        turned[:used, 0], _ = lapack.dtrtrs(qr[:used], target, lower=0, trans=1)
        turned, _, _ = lapack.dormqr("L", "N", qr, tau, turned, _WORK, overwrite_c=1)
    x = turned[:, 0]
    if wide:
        Z = turned[:, 1:]
        B, r = [e.times(Z[e.start : e.start + e.A.shape[1]]) for e in wide], [e.residual(x) for e in wide]
        y = (
            determined(B[0], r[0], INDEPENDENT)
            if len(wide) == 1
            else determined(np.vstack(B), np.hstack(r), INDEPENDENT)
        )
        if y is None:
            return None
        x = x - Z @ y
    return x


def _nearest(T: Array, target: Array, wish: Array, held: int) -> tuple[Array, Array] | None:
    """The point nearest to `wish` with ``Tᵀ x = target``, and the last `held` of λ, ``wish − x = T λ``."""
    missing, used = target - wish @ T, len(target)
    qr, tau, _, _ = lapack.dgeqrf(T, lwork=_WORK)
    if not _independent(qr):
        return None
    R = qr[:used]
    turned = np.zeros((len(T), 1), order="F")
    turned[:used, 0], _ = lapack.dtrtrs(R, missing, lower=0, trans=1)
    multipliers = -lapack.dtrtrs(R, turned[:used, 0], lower=0)[0][used - held :] if held else missing[:0]
    turned, _, _ = lapack.dormqr("L", "N", qr, tau, turned, _WORK, overwrite_c=1)
    return wish + turned[:, 0], multipliers


def _independent(qr: Array) -> bool:
    """Whether the columns that were factorised are independent; what is not a number is not."""
    size = [abs(r) for r in qr.diagonal().tolist()]
    return min(size) > INDEPENDENT * max(size)
