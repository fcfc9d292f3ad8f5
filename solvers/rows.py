"""Input and output of a solver: rows, levels, solutions.

Nothing here knows a robot: a row is ``lower <= A x <= upper``, an equality where both sides agree, and it has a name
and a unit so that whoever reads a result knows what was asked for.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from math import sqrt
from typing import Protocol

import numpy as np

from solvers.compiled import compiled

Array = np.ndarray


ACTIVE_TOLERANCE = 1e-6
"""Distance from its bound within which an inequality is reported as active."""


class Status(IntEnum):
    """How an answer came about; the higher, the worse."""

    SOLVED = 0
    SECOND_SOLVER = 1
    """A QP went to the second solver, which solved it, or level 0 was solved in parts without any giving way."""
    RELAXED = 2
    """Level 0 had no solution: some of its rows gave way."""
    FAILED = 3
    """No answer. The levels above the failed one keep theirs; without any of them ``x`` is not to be used."""
    INVALID = 4
    """No question: the state, the rows or the answer hold values that cannot be used."""


@dataclass(slots=True)
class Rows:
    """Rows ``lower <= A x <= upper`` of one task or limit.

    Args:
        name: Who asks for the rows.
        unit: Unit of ``A x``.
        A: Matrix, shape (m, n).
        lower: Lower bounds, shape (m,); ``-inf`` where there is none.
        upper: Upper bounds, shape (m,); ``+inf`` where there is none.
        weight: Scale of the rows' violation within their level.
        gives_way: For rows of level 0 only: 0 if they must always hold, otherwise their place in the order in which
            level 0 is relaxed when it has no solution (1 gives way first).
        optional: For rows of level 0 only: whether they are left out where a level above the last two would pay for
            them.
        selects: If A is a run of rows of the identity, which ones: who multiplies by A may then take rows instead.
    """

    name: str
    unit: str
    A: Array
    lower: Array
    upper: Array
    weight: float = 1.0
    gives_way: int = 0
    optional: bool = False
    selects: slice | None = None


@dataclass(slots=True)
class Block:
    """The part of a level's stacked rows that belongs to one task or limit.

    `labels` name the rows one by one, as far as their owner does.
    """

    name: str
    unit: str
    weight: float
    equality: bool
    rows: slice
    gives_way: int = 0
    labels: Sequence[str] = ()
    optional: bool = False


@dataclass(slots=True)
class Equality:
    """Rows ``scale A x[start : start + k] = b`` on a run of k variables.

    Args:
        A: Matrix, shape (m, k).
        b: Right-hand side, shape (m,), scaled already.
        scale: Of the rows.
        start: The first variable that they involve.
        selects: If A is a run of rows of the identity, which ones.
    """

    A: Array
    b: Array
    scale: float = 1.0
    start: int = 0
    selects: slice | None = None

    def product(self, Z: Array) -> Array:
        """``scale A Z`` for the rows Z of the variables it involves, shape (k, any)."""
        out = Z[self.selects] if self.selects is not None else self.A @ Z
        return out if self.scale == 1.0 else self.scale * out

    def write_row_products(self, X: Array, out: Array) -> None:
        """Write ``scale A x`` of all variables x in each row of X to an array, shape (any, m)."""
        if self.selects is not None:
            _write_scaled_columns(X, self.start + self.selects.start, self.scale, out)
        else:
            _write_row_products(X, self.start, self.A, self.scale, out)

    def residual(self, x: Array) -> Array:
        """``scale A x - b`` of all variables x, shape (m,)."""
        return self.product(x[self.start : self.start + self.A.shape[1]]) - self.b


@compiled
def _write_scaled_columns(X: Array, start: int, scale: float, out: Array) -> None:
    for i in range(len(X)):
        for k in range(out.shape[1]):
            out[i, k] = scale * X[i, start + k]


@compiled
def _write_row_products(X: Array, start: int, A: Array, scale: float, out: Array) -> None:
    for i in range(len(X)):
        for j in range(len(A)):
            total = 0.0
            for k in range(A.shape[1]):
                total += X[i, start + k] * A[j, k]
            out[i, j] = scale * total


@dataclass(slots=True)
class Level:
    """Rows of one priority: equalities, and ``lower <= C x <= upper``, all multiplied by their weights.

    Args:
        name: The level's name.
        size: Number n of variables.
        equalities: In the order of their blocks.
        C: Inequalities, shape (p, n).
        lower, upper: Bounds, shape (p,).
        blocks: Who owns which rows; those of equalities count through all of them.
        structure_key: If not None, hierarchies whose first levels have the same one differ in nothing but numbers, and
            are made of the same objects.
    """

    name: str
    size: int
    equalities: list[Equality]
    C: Array
    lower: Array
    upper: Array
    blocks: list[Block] = field(default_factory=list)
    structure_key: object | None = None
    _A: Array | None = None
    _b: Array | None = None

    @property
    def A(self) -> Array:  # noqa: N802
        """All equalities as one matrix, shape (m, n)."""
        if self._A is None:
            if len(self.equalities) == 1 and self.equalities[0].A.shape[1] == self.size:
                one = self.equalities[0]
                self._A = one.A if one.scale == 1.0 else one.scale * one.A
            else:
                self._A = np.zeros((len(self.b), self.size))
                row = 0
                for e in self.equalities:
                    np.multiply(e.A, e.scale, out=self._A[row : row + len(e.b), e.start : e.start + e.A.shape[1]])
                    row += len(e.b)
        return self._A

    @property
    def b(self) -> Array:
        """Right-hand side of all equalities, shape (m,)."""
        if self._b is None:
            parts = [e.b for e in self.equalities]
            self._b = parts[0] if len(parts) == 1 else np.concatenate(parts) if parts else np.zeros(0)
        return self._b

    def clear_cache(self) -> None:
        """Forget the stacked A and b; to be called when the numbers of the level have been replaced."""
        self._A = self._b = None

    @property
    def leading_columns(self) -> int:
        """Number of leading variables that the equalities involve; all of them if there are none."""
        return max((e.start + e.A.shape[1] for e in self.equalities), default=self.size)

    def leave_out_optional(self) -> bool:
        """Take the bounds of optional inequalities away; returns whether any had one."""
        had_any = False
        for block in self.blocks:
            if block.optional and not block.equality:
                lower, upper = self.lower[block.rows], self.upper[block.rows]
                had_any = had_any or bool((lower > -np.inf).any() or (upper < np.inf).any())
                lower[:], upper[:] = -np.inf, np.inf
        return had_any

    def copy(self) -> "Level":
        """A copy that shares no arrays with this level."""
        C, lower, upper = self.C.copy(), self.lower.copy(), self.upper.copy()
        blocks = [replace(block) for block in self.blocks]
        return Level(self.name, self.size, [Equality(self.A.copy(), self.b.copy())], C, lower, upper, blocks)

    @classmethod
    def stack(cls, name: str, rows: Sequence[Rows], size: int) -> "Level":
        """Stack rows of ``size`` variables; rows whose bounds agree are equalities, the others inequalities.

        Raises:
            ValueError: If a matrix has another number of columns, bounds of another length, a lower bound above its
                upper one, or an entry that is not a number.
        """
        equalities: list[Equality] = []
        inequalities: list[tuple[Array, Array, Array]] = []
        blocks: list[Block] = []
        n_equal = n_unequal = 0
        for row in rows:
            A, lower, upper = (np.asarray(part, dtype=float) for part in (row.A, row.lower, row.upper))
            if A.ndim != 2 or A.shape[1] != size or lower.shape != (len(A),) or upper.shape != (len(A),):
                raise ValueError(f"{row.name}: A is {A.shape}, lower {lower.shape}, upper {upper.shape}; n is {size}")
            if not np.isfinite(A).all() or np.isnan(lower).any() or np.isnan(upper).any():
                raise ValueError(f"{row.name}: a row holds a value that is not a number")
            if (lower > upper).any():
                raise ValueError(f"{row.name}: a lower bound lies above its upper bound")
            equal = lower == upper
            if equal.any():
                equalities.append(Equality(A[equal], row.weight * lower[equal], row.weight))
                count = int(equal.sum())
                where = slice(n_equal, n_equal + count)
                blocks.append(Block(row.name, row.unit, row.weight, True, where, row.gives_way, optional=row.optional))
                n_equal += count
            if not equal.all():
                keep = ~equal
                inequalities.append((row.weight * A[keep], row.weight * lower[keep], row.weight * upper[keep]))
                count = int(keep.sum())
                where = slice(n_unequal, n_unequal + count)
                blocks.append(Block(row.name, row.unit, row.weight, False, where, row.gives_way, optional=row.optional))
                n_unequal += count
        none = np.zeros((0, size))
        return cls(
            name,
            size,
            equalities,
            np.vstack([none, *(C for C, _, _ in inequalities)]),
            np.concatenate([none[:, 0], *(lower for _, lower, _ in inequalities)]),
            np.concatenate([none[:, 0], *(upper for _, _, upper in inequalities)]),
            blocks,
        )

    def violation(self, x: Array) -> Array:
        """Signed violation of every row at ``x``, equalities first, shape (m + p,); 0 where a row holds."""
        return np.concatenate([np.zeros(0), *self.violation_parts(x)])

    def violation_parts(self, x: Array) -> list[Array]:
        """The violations in parts: one for each equality, and one for all inequalities if there are any."""
        parts = [e.residual(x) for e in self.equalities]
        if len(self.lower):
            value = self.C @ x
            parts.append(np.maximum(value - self.upper, 0.0) + np.minimum(value - self.lower, 0.0))
        return parts


@dataclass(slots=True)
class LevelResult:
    """Result of one level.

    Args:
        level: The level.
        x: The solver's answer, shape (n,).
        needed_qp: Whether a QP had to be solved, or least squares were enough.
        residual: Largest violation of what the level had to preserve.
        status: How the level's answer came about.
        all_rows_met: Whether all its rows are known to be met.
        reason: In words, why it is not the answer of the first solver; "" if it is.
    """

    level: Level
    x: Array
    needed_qp: bool
    residual: float
    status: Status
    all_rows_met: bool = False
    reason: str = ""

    @property
    def name(self) -> str:
        """The level's name."""
        return self.level.name

    @property
    def violation(self) -> Array:
        """Signed violation of its rows, equalities first, weighted as in the level, shape (m + p,)."""
        return self.level.violation(self.x)

    @property
    def active(self) -> Array:
        """Which of its inequalities hold with equality or are violated, shape (p,)."""
        value = self.level.C @ self.x
        return (value >= self.level.upper - ACTIVE_TOLERANCE) | (value <= self.level.lower + ACTIVE_TOLERANCE)

    @property
    def error(self) -> float:
        """Norm of the level's weighted violation, the quantity that the level minimises."""
        if self.all_rows_met:
            return 0.0
        squares = 0.0
        for part in self.level.violation_parts(self.x):
            squares += float(part @ part)
        return sqrt(squares)


@dataclass(slots=True)
class Solution:
    """Answer of a solver.

    Args:
        x: The variables, shape (n,).
        levels: One result a level, level 0 first.
        status: The worst of the levels' statuses.
        relaxed: Names of the rows of level 0 that gave way, with the largest violation of each.
    """

    x: Array
    levels: list[LevelResult]
    status: Status
    relaxed: dict[str, float] = field(default_factory=dict)


class Solver(Protocol):
    """Anything that solves a hierarchy of levels."""

    name: str

    def solve(self, levels: Sequence[Level]) -> Solution:
        """Solve the hierarchy; ``levels[0]`` is hard."""
