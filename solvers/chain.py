"""The cascade for known active sets: a chain of least-squares problems in shrinking null spaces.

An inequality that keeps level k from doing better is an equality for level k and all below it. Once these active sets
are known, the cascade is a chain: each level meets first its held rows, then its own equalities, in the null space that
is left. Whether the active sets were right is checked exactly:

- the last point satisfies all inequalities, and
- at each level the held rows push the right way: with g the gradient of the level's objective in its space,
  ``g + Dᵀ λ = 0`` and λ > 0 at upper bounds, λ < 0 at lower ones. What does not push at all, λ = 0, must not be held
  there: it would keep lower levels from leaving the bound. At the last level it may be.

These are the optimality conditions of every level at once, so that a guess that passes is the optimum.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import lapack

from solvers.nullspace import RowFactorization, factorize_rows, least_squares_if_determined
from solvers.rows import Array, Level

MIN_ROW_LENGTH = 1e-12
"""Rows shorter than this count as zero."""


@dataclass(slots=True)
class ActiveSet:
    """Inequalities held at a level: their rows among all inequalities, and +1 at the upper bound, -1 at the lower."""

    rows: Array = field(default_factory=lambda: np.zeros(0, dtype=int))
    side: Array = field(default_factory=lambda: np.zeros(0))

    def with_finite_bounds(self, lower: Array, upper: Array) -> "ActiveSet":
        """The rows whose bound is still finite."""
        if not len(self.rows):
            return self
        left = np.isfinite(np.where(self.side > 0.0, upper[self.rows], lower[self.rows]))
        return self if left.all() else self.subset(left)

    def subset(self, chosen: Array) -> "ActiveSet":
        """The rows that a mask selects."""
        return ActiveSet(self.rows[chosen], self.side[chosen])

    def union(self, others: "ActiveSet") -> "ActiveSet":
        """These rows and the others."""
        return ActiveSet(np.append(self.rows, others.rows), np.append(self.side, others.side))


class NullSpace:
    """The null space that the levels above leave: the span of the orthonormal columns of ``Z``.

    As long as no rows have coupled the leading variables to the others, Z is diag(U, W), and rows that involve one of
    them only are solved in that one: half the size, an eighth of the work.

    Args:
        U: Basis of the leading variables, shape (leading, a).
        W: Basis of the others, shape (others, b).
        Z: The whole basis where it does not split; U and W are then of no meaning.
    """

    __slots__ = ("U", "W", "_Z", "split")

    def __init__(self, U: Array, W: Array, Z: Array | None = None) -> None:
        self.U, self.W, self._Z = U, W, Z
        self.split = Z is None

    @property
    def size(self) -> int:
        """Dimension of the null space."""
        return self.U.shape[1] + self.W.shape[1] if self._Z is None else self._Z.shape[1]

    @property
    def Z(self) -> Array:  # noqa: N802
        """The whole basis, shape (n, dimension)."""
        if self._Z is None:
            (n, a), (others, b) = self.U.shape, self.W.shape
            self._Z = np.zeros((n + others, a + b), order="F")
            self._Z[:n, :a], self._Z[n:, a:] = self.U, self.W
        return self._Z

    def least_squares(
        self, A: Array, columns: int, b: Array, x: Array, tolerance: float, damping: float = 0.0
    ) -> tuple[Array, "NullSpace"]:
        """Solve ``A x = b`` by least squares in this space; returns the new x and the null space that is left.

        Only the first `columns` columns of A are other than zero; directions shorter than `tolerance` count as none.
        """
        where, basis, rows = self._part_for_rows(A, columns)
        B, r = rows @ basis, b - A @ x
        y = least_squares_if_determined(B, r, tolerance, damping)
        if y is None:
            projection = factorize_rows(B, tolerance)
            y, left = projection.least_squares(r, damping), projection.remaining_basis(basis)
        else:
            left = basis[:, :0]
        x = x.copy()
        x[where] += basis @ y
        return x, self._remaining_space(where, left)

    def hold_rows(
        self, D: Array, target: Array, x: Array, tolerance: float
    ) -> tuple[Array, "NullSpace", RowFactorization]:
        """As `least_squares` with all columns; also returns the factorisation that the multipliers need."""
        where, basis, rows = self._part_for_rows(D, D.shape[1])
        projection = factorize_rows(rows @ basis, tolerance)
        y = projection.least_squares(target - D @ x)
        x = x.copy()
        x[where] += basis @ y
        return x, self._remaining_space(where, projection.remaining_basis(basis)), projection

    def _part_for_rows(self, A: Array, columns: int) -> tuple[slice, Array, Array]:
        """Variables that the rows A need, the basis of their null space, and the rows on these variables."""
        n = len(self.U)
        if self.split and columns <= n:
            return slice(0, n), self.U, A[:, :n]
        if self.split and not self.U.shape[1]:
            return slice(n, None), self.W, A[:, n:]
        return slice(None), self.Z, A

    def _remaining_space(self, where: slice, basis: Array) -> "NullSpace":
        if where.start == 0:
            return NullSpace(basis, self.W)
        return NullSpace(self.U, basis) if where.start else NullSpace(self.U, self.W, basis)

    def coordinates(self, g: Array) -> Array:
        """``Zᵀ g`` in the part of the space in which `hold_rows` works."""
        where, basis, _ = self._part_for_rows(g[None], len(g))
        return basis.T @ g[where]


class Chain:
    """Runs the chain and keeps the null space and the answer of each level.

    Args:
        levels: The hierarchy.
        C, lower, upper: All its inequalities, shapes (p, n), (p,), (p,).
        rank_tolerance, damping: As for `Cascade`.

    Attributes:
        null_spaces: Null space in which level k is solved, before its held rows.
        points: The answer after each level, (n,).
    """

    def __init__(
        self, levels: Sequence[Level], C: Array, lower: Array, upper: Array, rank_tolerance: float, damping: float
    ) -> None:
        self.levels, self.C, self.lower, self.upper = levels, C, lower, upper
        self.rank_tolerance, self.damping = rank_tolerance, damping
        count, size = len(levels), levels[0].size
        leading = min(level.leading_columns for level in levels)
        whole = NullSpace(np.eye(leading, order="F"), np.eye(size - leading, order="F"))
        self.null_spaces: list[NullSpace] = [whole] * (count + 1)
        self.points: list[Array] = [np.zeros(size)] * count
        self._held_factorizations: list[RowFactorization | None] = [None] * count

    def run(self, held: Sequence[ActiveSet] | None = None, first: int = 0) -> None:
        """Solve from level `first` on; the results of the levels above are kept."""
        for k in range(first, len(self.levels)):
            level, space = self.levels[k], self.null_spaces[k]
            x = self.points[k - 1] if k else np.zeros(level.size)
            self._held_factorizations[k] = None
            if held is not None and len(rows := held[k].rows):
                D = self.C[rows]
                target = np.where(held[k].side > 0.0, self.upper[rows], self.lower[rows])
                x, space, self._held_factorizations[k] = space.hold_rows(D, target, x, self._tolerance(D))
            if len(level.b):
                damping = self.damping if k else 0.0
                x, space = space.least_squares(
                    level.A, level.leading_columns, level.b, x, self._tolerance(level.A), damping
                )
            self.points[k], self.null_spaces[k + 1] = x, space

    def multipliers(self, k: int) -> Array:
        """λ of the rows held at level k, positive where they push against an upper bound."""
        hold = self._held_factorizations[k]
        if hold is None:
            return np.zeros(0)
        level, x = self.levels[k], self.points[k]
        gradient = level.A.T @ (level.A @ x - level.b)
        if self.damping:
            gradient += self.damping**2 * (x - self.points[k - 1])
        return hold.multipliers(-self.null_spaces[k].coordinates(gradient))

    def _tolerance(self, A: Array) -> float:
        return self.rank_tolerance * max(MIN_ROW_LENGTH, lapack.dlange("M", A.T))
