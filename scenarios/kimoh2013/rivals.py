"""Methods to compare with, as their authors describe them."""

from collections.abc import Sequence

import numpy as np

from solvers import Cascade, Level, LevelResult, Solution, Status
from solvers.nullspace import factorize_rows
from solvers.proxqp import QP, PersistentQPs

RANK_TOLERANCE = 1e-7


class LevelByLevel:
    """The general framework as it is published (Kanoun et al. 2011): a quadratic program for each level of equalities.

    Each is solved in what the levels above leave, under level 0's inequalities. Level 0 has no equalities.
    """

    name = "level by level"

    def __init__(self) -> None:
        self._qps = PersistentQPs()

    def solve(self, levels: Sequence[Level]) -> Solution:
        """Solve the hierarchy; ``levels[0]`` is hard."""
        hard, n = levels[0], levels[0].size
        x, Z, results = np.zeros(n), np.eye(n, order="F"), []
        for k, level in enumerate(levels[1:]):
            if Z.shape[1]:
                B, r, value = level.A @ Z, level.b - level.A @ x, hard.C @ x
                low, high = hard.lower - value, hard.upper - value
                if k:  # the level above found a point between the bounds: rounding is not to say otherwise
                    low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
                qp = self._qps.solve(k, QP(B, r, hard.C @ Z, low, high))
                x = x + Z @ qp.y
                Z = factorize_rows(B, RANK_TOLERANCE).remaining_basis(Z)
                results.append((qp.status, qp.residual, True))
            else:
                results.append((Status.SOLVED, 0.0, False))
        worst = max((status for status, _, _ in results), default=Status.SOLVED)
        told = [LevelResult(hard, x, False, max((r for _, r, _ in results), default=0.0), worst)]
        told += [
            LevelResult(level, x, needed, residual, status)
            for level, (status, residual, needed) in zip(levels[1:], results, strict=True)
        ]
        return Solution(x, told, worst)


class ClampedCascade:
    """The solution without bounds, each variable then clipped to its bounds: the simplest method.

    Level 0 is bounds of all variables, in their order.
    """

    name = "clamped"

    def __init__(self) -> None:
        self._cascade = Cascade()

    def solve(self, levels: Sequence[Level]) -> Solution:
        """Solve the hierarchy; ``levels[0]`` is hard."""
        hard = levels[0]
        solution = self._cascade.solve([Level.stack(hard.name, [], hard.size), *levels[1:]])
        solution.x = np.clip(solution.x, hard.lower, hard.upper)
        for level, result in zip(levels, solution.levels, strict=True):
            result.level, result.x = level, solution.x
        return solution
