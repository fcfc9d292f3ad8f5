"""The cascade with its active inequalities known: a chain of least squares in shrinking null spaces.

An inequality that keeps level k from doing better is an equality for level k and all below it. Once it is known which
ones these are, and at which level, the cascade is a chain: at each level first the held rows, then the level's own
equalities, each in what is left. Whether the guess was right is checked exactly:

- the last point satisfies all inequalities, and
- at each level the held rows push the right way: with g the gradient of the level's objective in its space,
  ``g + Dᵀ λ = 0`` and λ ≥ 0 at upper bounds, λ ≤ 0 at lower ones.

These are the optimality conditions of every level at once, so that a guess that passes is the optimum.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import lapack

from solvers.nullspace import Projection, project
from solvers.rows import Array, Level

SMALLEST = 1e-12
"""Rows shorter than this are no rows."""


@dataclass(slots=True)
class Held:
    """Inequalities held at a level: their rows among all inequalities, and +1 at the upper bound, -1 at the lower."""

    rows: Array = field(default_factory=lambda: np.zeros(0, dtype=int))
    side: Array = field(default_factory=lambda: np.zeros(0))


class Chain:
    """Runs the chain and keeps what each level leaves.

    Args:
        levels: The hierarchy.
        C, lower, upper: All its inequalities, shapes (p, n), (p,), (p,).
        rank_tolerance, damping: As for `Cascade`.

    Attributes:
        bases: What level k has to work in, an orthonormal basis (n, n_k), before its held rows.
        points: The answer after each level, (n,).
    """

    def __init__(
        self, levels: Sequence[Level], C: Array, lower: Array, upper: Array, rank_tolerance: float, damping: float
    ) -> None:
        self.levels, self.C, self.lower, self.upper = levels, C, lower, upper
        self.rank_tolerance, self.damping = rank_tolerance, damping
        count = len(levels)
        size = levels[0].A.shape[1]
        self.bases: list[Array] = [np.eye(size, order="F")] * (count + 1)
        # While only leading variables have been used, Z = diag(Z_lead, 1): the number of columns of Z_lead, else -1.
        self._leading = min(size if level.columns is None else level.columns for level in levels)
        self._lead = [self._leading] + [-1] * count
        self.points: list[Array] = [np.zeros(size)] * count
        self._holds: list[Projection | None] = [None] * count

    def run(self, held: Sequence[Held] | None = None, first: int = 0) -> None:
        """Solve from level `first` on; what the levels above left is kept."""
        for k in range(first, len(self.levels)):
            level = self.levels[k]
            x = self.points[k - 1] if k else np.zeros(self.bases[0].shape[0])
            self._holds[k] = None
            damping = self.damping if k else 0.0
            if (held is None or not len(held[k].rows)) and self._lead[k] >= 0 and level.columns == self._leading:
                self._run_leading(k, x, damping)
                continue
            Z = self.bases[k]
            if held is not None and len(held[k].rows):
                D = self.C[held[k].rows]
                target = np.where(held[k].side > 0.0, self.upper[held[k].rows], self.lower[held[k].rows])
                hold = self._holds[k] = project(D @ Z, self.rank_tolerance * _scale(D))
                x = x + Z @ hold.least_squares(target - D @ x)
                Z = hold.remaining(Z)
            self._lead[k + 1] = -1
            if not len(level.b):
                self.points[k], self.bases[k + 1] = x, Z
                continue
            projection = project(level.A @ Z, self.rank_tolerance * _scale(level.A))
            self.points[k] = x + Z @ projection.least_squares(level.b - level.A @ x, damping)
            if k < len(self.levels) - 1:
                self.bases[k + 1] = projection.remaining(Z)

    def _run_leading(self, k: int, x: Array, damping: float) -> None:
        """Solve a level whose space splits into that of the leading variables and all of the others."""
        level, Z, n, lead = self.levels[k], self.bases[k], self._leading, self._lead[k]
        self.points[k], self.bases[k + 1], self._lead[k + 1] = x, Z, lead
        if not len(level.b) or not lead:
            return
        A, Z_lead = level.A[:, :n], Z[:n, :lead]
        projection = project(A @ Z_lead, self.rank_tolerance * _scale(A))
        self.points[k] = x = x.copy()
        x[:n] += Z_lead @ projection.least_squares(level.b - A @ x[:n], damping)
        left = projection.remaining(np.asfortranarray(Z_lead))
        others = len(x) - n
        basis = np.zeros((len(x), left.shape[1] + others), order="F")
        basis[:n, : left.shape[1]] = left
        basis[n:, left.shape[1] :] = self._others(others)
        self.bases[k + 1], self._lead[k + 1] = basis, left.shape[1]

    def _others(self, count: int) -> Array:
        return self.bases[0][:count, :count]

    def multipliers(self, k: int) -> Array:
        """λ of the rows held at level k, positive where they push against an upper bound."""
        hold = self._holds[k]
        if hold is None:
            return np.zeros(0)
        level, x = self.levels[k], self.points[k]
        gradient = level.A.T @ (level.A @ x - level.b)
        if self.damping:
            gradient += self.damping**2 * (x - self.points[k - 1])
        return hold.multipliers(-(self.bases[k].T @ gradient))


def _scale(A: Array) -> float:
    return max(SMALLEST, lapack.dlange("M", A.T))
