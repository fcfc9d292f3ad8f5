"""Find the rows that make a level infeasible, and the least changes to their bounds that would cure it.

Rows that no point satisfies together always hold a smallest such set: drop any of its rows and the rest has a solution.
It is found by a linear programme that violates the rows by as little as can be, whose multipliers are not zero on rows
that push against each other only (Farkas), and by leaving these out one by one as long as no solution appears.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from solvers.rows import Array, Block, Level, Solution, Solver, Status

VIOLATION_TOLERANCE = 1e-6
"""Largest violation, in weighted units, of rows that count as met."""


class ConflictError(Exception):
    """Level 0 has no solution; says which rows contradict each other."""


def solve_or_explain(solver: Solver, levels: Sequence[Level]) -> Solution:
    """Solve a hierarchy off-line: all of level 0 holds, or an error names the rows that contradict each other.

    Raises:
        ConflictError: If level 0 has no solution.
    """
    solution = solver.solve(levels)
    if solution.status >= Status.RELAXED and (conflict := find_conflict(levels)) is not None:
        raise ConflictError(f"level '{levels[0].name}' has no solution: {conflict}")
    return solution


@dataclass(frozen=True, slots=True)
class ConflictRow:
    """One row of a conflict.

    Args:
        owner: Who asks for it.
        label: Which of the owner's rows, as far as it names them.
        side: "lower", "upper", or "" for an equality.
        unit: Unit of the row.
        change: By how much its bound would have to move for the conflict to vanish, in its unit; 0 if others move.
    """

    owner: str
    label: str
    side: str
    unit: str
    bound_change: float

    def __str__(self) -> str:
        what = " ".join(part for part in (self.label, self.side) if part)
        if self.bound_change:
            what = f"{what} {self.bound_change:+.2g} {self.unit}".strip()
        return f"{self.owner}: {what}" if what else self.owner


@dataclass(frozen=True, slots=True)
class Conflict:
    """A smallest set of rows that contradict each other; rows whose bounds would have to change come first."""

    rows: tuple[ConflictRow, ...]

    @property
    def owners(self) -> frozenset[str]:
        """Names of the tasks and limits that own the rows."""
        return frozenset(row.owner for row in self.rows)

    def __str__(self) -> str:
        changed = [str(row) for row in self.rows if row.bound_change]
        # One line a reader can take in: of an owner with many rows, how many.
        against: dict[str, list[ConflictRow]] = {}
        for row in self.rows:
            if not row.bound_change:
                against.setdefault(row.owner, []).append(row)
        others = [str(rows[0]) if len(rows) == 1 else f"{owner} ({len(rows)} rows)" for owner, rows in against.items()]
        return " and ".join(changed) + (f" against {', '.join(others)}" if others else "")


@dataclass(frozen=True, slots=True)
class _OneSidedRows:
    """One-sided rows ``A x <= b``, equalities as two of them, and where each comes from."""

    A: Array
    b: Array
    level: Array
    owner: Array
    row: Array
    sign: Array
    blocks: list[Block]

    @classmethod
    def of(cls, levels: Sequence[Level], kept: Array | None) -> "_OneSidedRows":
        """One-sided rows of all levels; equalities between level 0 and the last level ask for what the point `kept`
        reaches."""
        matrices, bounds = [], []
        marks: list[tuple[int, int, int, float]] = []
        blocks: list[Block] = []
        for k, level in enumerate(levels):
            A, b = level.A, level.b
            if kept is not None and 0 < k < len(levels) - 1:
                b = A @ kept
            for block in level.blocks:
                rows = np.arange(block.rows.start, block.rows.stop)
                if block.equality:
                    matrix, upper, lower = A[rows], b[rows], b[rows]
                else:
                    matrix, upper, lower = level.C[rows], level.upper[rows], level.lower[rows]
                for sign, bound in ((1.0, upper), (-1.0, lower)):
                    finite = np.isfinite(bound)
                    matrices.append(sign * matrix[finite])
                    bounds.append(sign * bound[finite])
                    marks.extend((k, len(blocks), row, sign) for row in rows[finite].tolist())
                blocks.append(block)
        level_of, owner, row, signs = np.array(marks).reshape(-1, 4).T
        return cls(
            np.vstack(matrices), np.concatenate(bounds), level_of, owner.astype(int), row.astype(int), signs, blocks
        )

    def conflict_row(self, k: int, change: float) -> ConflictRow:
        """Row k in the words of its owner."""
        block = self.blocks[self.owner[k]]
        number = int(self.row[k]) - block.rows.start
        alone = block.rows.stop - block.rows.start == 1
        label = block.labels[number] if number < len(block.labels) else "" if alone else f"row {number}"
        side = "" if block.equality else "upper" if self.sign[k] > 0.0 else "lower"
        return ConflictRow(block.name, label, side, block.unit, float(self.sign[k] * change / block.weight))


def find_conflict(levels: Sequence[Level], level_index: int = 0, x: Array | None = None) -> Conflict | None:
    """Find out why a level cannot be met.

    Args:
        levels: The hierarchy, level 0 first.
        level_index: The level in question. Levels between 0 and this one keep what `x` has reached.
        x: A solution of the levels above `level_index`; not needed for level 0.

    Returns:
        A smallest set of rows that contradict each other; None if the level can be met.
    """
    sides = _OneSidedRows.of(levels[: level_index + 1], x)
    everything = np.arange(len(sides.b))
    violation, slack, multipliers = _least_violation(sides, everything)
    if violation <= VIOLATION_TOLERANCE:
        return None
    blamed = everything[np.abs(multipliers) > 1e-9]
    for k in blamed.tolist():
        rest = blamed[blamed != k]
        if _least_violation(sides, rest)[0] > VIOLATION_TOLERANCE:
            blamed = rest
    _, slack, _ = _least_violation(sides, blamed, _violation_costs(sides, blamed, level_index))
    rows = [
        sides.conflict_row(k, change if change > VIOLATION_TOLERANCE else 0.0)
        for k, change in zip(blamed, slack, strict=True)
    ]
    return Conflict(tuple(sorted(rows, key=lambda row: (not row.bound_change, row.owner, row.label))))


def _violation_costs(sides: _OneSidedRows, rows: Array, last: int) -> Array:
    """Cost of violating each row: low for the rows of a lower level, and in level 0 for those that give way first."""
    if last:
        return np.where(sides.level[rows] == last, 1.0, 1e4)
    steps = np.array([block.gives_way for block in sides.blocks])[sides.owner[rows]]
    return np.where(steps > 0, 10.0 ** (steps - 1.0), 1e4)


def _least_violation(sides: _OneSidedRows, rows: Array, price: Array | None = None) -> tuple[float, Array, Array]:
    """Smallest sum of violations of some rows, each row's, and the rows' multipliers."""
    m, n = len(rows), sides.A.shape[1]
    cost = np.concatenate([np.zeros(n), np.ones(m) if price is None else price])
    answer = linprog(
        cost,
        A_ub=np.hstack([sides.A[rows], -np.eye(m)]),
        b_ub=sides.b[rows],
        bounds=[(None, None)] * n + [(0.0, None)] * m,
        method="highs",
    )
    if answer.status != 0:
        return 0.0, np.zeros(m), np.zeros(m)
    slack = answer.x[n:]
    return float(slack.sum()), slack, answer.ineqlin.marginals
