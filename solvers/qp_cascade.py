"""One quadratic program a level, for levels at which the chain of least squares violates inequalities.

Each is posed in the null space of the levels above.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.chain import ActiveSet, Chain
from solvers.nullspace import factorize_rows
from solvers.proxqp import QP, PersistentQPs, QPResult
from solvers.rows import Array, Level, LevelResult, Solution, Status

HOLDING_MULTIPLIER = 1e-4
"""Least multiplier of a bound that is held as an equality for the levels below. Where the feasible set is thin, the
accuracy of the QPs lets inactive bounds have nearly as large ones; a bound with a smaller one stays an inequality."""
EQUALITIES_LEAVE_NO_ROOM = "its equalities leave no room, and break a bound"


@dataclass(slots=True)
class _Bounds:
    """Inequalities ``lower <= C x <= upper``."""

    C: Array
    lower: Array
    upper: Array

    def in_null_space(self, x: Array, Z: Array) -> "_Bounds":
        """The same inequalities in y, for ``x + Z y``."""
        value = self.C @ x
        return _Bounds(self.C @ Z, self.lower - value, self.upper - value)

    def including_zero(self) -> "_Bounds":
        """The same with y = 0 feasible: the point of the level above is, whatever rounding says."""
        return _Bounds(self.C, np.minimum(self.lower, 0.0), np.maximum(self.upper, 0.0))


class QPCascade:
    """Solves one QP a level, from a starting level to the last one.

    Args:
        levels: The hierarchy.
        chain: Its optimum without inequalities.
        owner: Level of each inequality, shape (p,).
        qps: Solves them.
        tolerance: Violation that counts as none.

    Attributes:
        first_active_level: First level with an active inequality that pushes; the number of levels if there is none.
        active_sets: Inequalities that are tight and push, by level.
    """

    def __init__(
        self, levels: Sequence[Level], chain: Chain, owner: Array, qps: PersistentQPs, tolerance: float
    ) -> None:
        self.levels, self.chain, self.owner = levels, chain, owner
        self.qps, self.tolerance = qps, tolerance
        self.C, self.lower, self.upper = chain.C, chain.lower, chain.upper
        self.first_active_level = len(levels)
        self.active_sets: dict[int, ActiveSet] = {}

    def run(self, start: int, satisfied: bool, optional: bool = False) -> Solution | None:
        """Solve QPs from level `start` on; None if the first one has no solution and was optional.

        `satisfied` says that the chain's point above `start` satisfies the inequalities.
        """
        levels, tolerance = self.levels, self.tolerance
        lower, upper = self.lower.copy(), self.upper.copy()
        x = self.chain.points[start - 1]
        Z = self.chain.null_spaces[start].Z
        frozen = False  # whether violated inequalities have been frozen, so that the chain's bases hold no more
        qps: dict[int, QPResult] = {}
        self.first_active_level, self.active_sets, last = len(levels), {}, len(levels) - 1
        for k in range(start, len(levels)):
            level = levels[k]
            if not frozen:
                Z = self.chain.null_spaces[k].Z
            if not Z.shape[1]:
                if k == start == 1 and self.violates_hard_level(x):
                    return build_solution(levels, x, qps, Status.FAILED, (0, EQUALITIES_LEAVE_NO_ROOM))
                break
            B = level.A @ Z
            own = self.owner == k
            if k > start and not len(level.b) and not own.any():
                continue
            bound = self.owner < k
            bounding = _Bounds(self.C[bound], lower[bound], upper[bound]).in_null_space(x, Z)
            if feasible := satisfied or k > start:
                bounding = bounding.including_zero()
            wanted = _Bounds(self.C[own], lower[own], upper[own]).in_null_space(x, Z)
            problem = self._level_qp(B, level.b - level.A @ x, bounding, wanted)
            problem.known_feasible = feasible
            first = optional and k == start
            qp = self.qps.solve((k, first), problem, use_second_solver=not first)
            if qp.status == Status.FAILED:
                if first:
                    return None
                # Without a first feasible point nothing can be kept; below it, the answer of the levels above is.
                failed = k if feasible else 0
                return build_solution(levels, x, qps, Status.FAILED, (failed, qp.reason))
            qps[k] = qp
            n = Z.shape[1]
            x = x + Z @ qp.y[:n]
            # An inequality with a multiplier, or violated, stays where it is whatever the levels below do (its
            # multiplier would have to push on the level otherwise): it bounds no more, it is part of what is held.
            multipliers = np.zeros(len(lower))
            multipliers[bound] = qp.multipliers[: len(bounding.lower)]
            value = self.C @ x
            multipliers[own] = value[own] - np.clip(value[own], lower[own], upper[own])
            # The QP's accuracy lets rows that are not tight have small multipliers: those are worth a guess at the next
            # tick, which is checked, but not freezing.
            gap = np.where(multipliers > 0.0, upper - value, value - lower)
            tight = (gap < 10.0 * tolerance) & (np.abs(multipliers) > tolerance * (10.0 if k < last else 0.01))
            self.active_sets[k] = ActiveSet(np.flatnonzero(tight), np.sign(multipliers[tight]))
            least = np.where(self.owner == k, 10.0 * tolerance, HOLDING_MULTIPLIER)
            pushes = np.abs(multipliers) > least * (1.0 + np.abs(multipliers).max(initial=0.0))
            held = np.flatnonzero(tight & pushes)
            if len(held):
                self.first_active_level = min(self.first_active_level, k)
            if k == last:
                break
            if len(held):
                lower[held], upper[held] = -np.inf, np.inf
                B = np.vstack([B, self.C[held] @ Z])
                frozen = True
            if frozen:
                scale = max(1.0, float(np.abs(B).max(initial=0.0)))
                Z = factorize_rows(B, self.chain.rank_tolerance * scale).remaining_basis(np.asfortranarray(Z))
        worst = max((qp.status for qp in qps.values()), default=Status.SOLVED)
        return build_solution(levels, x, qps, worst)

    def violates_hard_level(self, x: Array) -> bool:
        """Whether x violates an inequality of level 0 by more than the tolerance."""
        hard, tolerance = self.owner == 0, self.tolerance
        value = self.C[hard] @ x
        return bool((value > self.upper[hard] + tolerance).any() or (value < self.lower[hard] - tolerance).any())

    def _level_qp(self, B: Array, r: Array, bounding: _Bounds, wanted: _Bounds) -> QP:
        """One level's QP in (y, w): ``B y = r`` by least squares, and the least slack w of its own inequalities."""
        n, p = B.shape[1], len(wanted.lower)
        if self.chain.damping:
            B, r = np.vstack([B, self.chain.damping * np.eye(n)]), np.append(r, np.zeros(n))
        if not p:
            return QP(B, r, bounding.C, bounding.lower, bounding.upper)
        A = np.block([[B, np.zeros((len(B), p))], [np.zeros((p, n)), np.eye(p)]])
        C = np.block([[bounding.C, np.zeros((len(bounding.lower), p))], [wanted.C, -np.eye(p)]])
        lower, upper = np.append(bounding.lower, wanted.lower), np.append(bounding.upper, wanted.upper)
        return QP(A, np.append(r, np.zeros(p)), C, lower, upper)


def build_solution(
    levels: Sequence[Level],
    x: Array,
    qps: dict[int, QPResult],
    status: Status,
    failed: tuple[int, str] | None = None,
) -> Solution:
    """Solution with the results of all levels; `failed` is the first level without an answer, and the reason."""
    results = []
    for k, level in enumerate(levels):
        qp = qps.get(k)
        if failed is not None and k >= failed[0]:
            results.append(LevelResult(level, x, qp is not None, 0.0, Status.FAILED, reason=failed[1]))
        elif qp is not None:
            results.append(LevelResult(level, x, True, qp.residual, qp.status, reason=qp.reason))
        else:
            results.append(LevelResult(level, x, False, 0.0, Status.SOLVED))
    return Solution(x, results, status)
