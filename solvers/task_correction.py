"""Inverse kinematics with task corrections (IKTC), Kim & Oh: tasks are changed until their solution fits the bounds.

Tasks ``J_i q̈ = h_i`` in order of priority have the solution, Kim (5),

    q̈_i = q̈_{i-1} + J̄_i⁺ (h_i − J_i q̈_{i-1}),   J̄_i = J_i N_{i-1},

with N_{i-1} the projection onto what the tasks above leave. It is linear in the tasks: corrections Δh change it by
``G Δh``, Kim (20), G of Algorithm 1. Where it leaves the bounds ``lower <= C q̈ <= upper``, the least corrections of the
lowest tasks that suffice are looked for, Kim (23): of the last one alone, of the last two, and so on, Algorithm 2.
Whether they suffice is asked of the simplex method, so that there is one quadratic program a tick, or none.

*As printed* Kim (19) takes each residual with the Jacobian of the task above; it is J_i, as in (5). Remark 1 has damped
inverses restore the rank of G: a damped inverse has the rank of its matrix, whatever the damping.

*Null spaces.* N is Z Zᵀ with Z an orthonormal basis, so that ``J̄⁺ = Z (J Z)⁺``. Damping enters the inverses, never N:
a damped N is no projection, and lower tasks would disturb higher ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solvers.cascade import Cascade
from solvers.direct import least_norm_solution
from solvers.feasibility import is_feasible
from solvers.nullspace import RowFactorization, factorize_rows
from solvers.proxqp import QP, PersistentQPs
from solvers.reduction import leading_count, stacked_equalities
from solvers.rows import Array, Equality, Level, LevelResult, Solution, Status


@dataclass(slots=True)
class Task:
    """Rows ``J q̈ = h`` of one priority.

    Args:
        J: Shape (m, n).
        h: Shape (m,).
    """

    J: Array
    h: Array


@dataclass(slots=True)
class Correction:
    """Corrected accelerations.

    Args:
        x: q̈*, shape (n,).
        first_corrected: The first of the tasks that were corrected; their number if none was.
        status: Of the QP, if there was one.
        residual: Largest violation of a bound.
        reason: As of a `QPResult`.
    """

    x: Array
    first_corrected: int
    status: Status = Status.SOLVED
    residual: float = 0.0
    reason: str = ""


class PrioritizedTasks:
    """Tasks in order of priority, without bounds: Kim (4)-(7) and Algorithm 1.

    Args:
        tasks: The most important first.
        damping: Of the inverses, Kim (8).
        rank_tolerance: As for `Cascade`.

    Attributes:
        x: The solution q̈, Kim (5), shape (n,).
    """

    def __init__(self, tasks: Sequence[Task], damping: float, rank_tolerance: float) -> None:
        self.tasks, self.damping, self.rank_tolerance = tasks, damping, rank_tolerance
        self._factors: list[tuple[Array, RowFactorization]] = []
        x = None if damping else _one_factorization_solution(tasks)
        self._is_regular = x is not None
        self.x = self._recursive_solution() if x is None else x

    def correction_gains(self) -> list[Array]:
        """Gains ``G = [g_1 g_2 ...]`` of Algorithm 1, from corrections to accelerations: one block (n, m_i) a task.

        A column of g_i is what a unit correction of its row does: ``J̄_i⁺`` of it, which each task below then makes up
        for. All columns of all tasks above are taken through a task at once. Of tasks that do not come near another
        it is the inverse of all of them together.
        """
        ends = np.cumsum([len(task.h) for task in self.tasks])
        if self._is_regular and ends[-1] <= len(self.x):
            return np.split(
                factorize_rows(np.vstack([task.J for task in self.tasks]), 0.0).pseudo_inverse(), ends[:-1], axis=1
            )
        if not self._factors:
            self._recursive_solution()
        G = np.zeros((len(self.x), 0))
        for task, (Z, projection) in zip(self.tasks, self._factors, strict=True):
            inverse = Z @ projection.pseudo_inverse(self.damping)
            G = np.hstack([G - inverse @ (task.J @ G), inverse])
        return np.split(G, ends[:-1], axis=1)

    def _recursive_solution(self) -> Array:
        """Kim (5), each task in the null space of those above; keeps what `correction_gains` needs."""
        n = self.tasks[0].J.shape[1]
        x, Z = np.zeros(n), np.eye(n, order="F")
        for task in self.tasks:
            projection = factorize_rows(
                task.J @ Z, self.rank_tolerance * max(1.0, float(np.abs(task.J).max(initial=0.0)))
            )
            x = x + Z @ projection.least_squares(task.h - task.J @ x, self.damping)
            self._factors.append((Z, projection))
            Z = projection.remaining_basis(Z)
        return x


def _one_factorization_solution(tasks: Sequence[Task]) -> Array | None:
    """Kim (5) by one factorisation, where no task comes near another: its least-norm solution is that of all together.

    The last task that anything is left for may have more rows than that. None if the tasks are not of this kind.
    """
    n, used = tasks[0].J.shape[1], 0
    thin: list[Equality] = []
    wide: list[Equality] = []
    for task in tasks:
        if used < n and len(task.h):
            used += len(task.h)
            (thin if used <= n else wide).append(Equality(task.J, task.h))
    return least_norm_solution(thin, wide, n)


class TaskCorrection:
    """Kim & Oh's IKTC: tasks corrected by one QP until joint bounds hold; then, given forces, the strict cascade.

    Levels of accelerations alone, with the joint bounds as level 0, are solved as in the paper. In the levels of an
    inverse-dynamics controller, which go on with forces, it is a layer: what the levels ask of the accelerations is
    corrected for the bounds on these, and a `Cascade` realises the corrected tasks under all of level 0. Equalities of
    level 0 are a task above all others which is never corrected. Where no correction suffices, the cascade answers what
    was asked.

    The paper wants no more rows than variables, Kim (18). A last task may have more: what it cannot reach is left, as
    least squares.

    Args:
        damping: Of the inverses, Kim (8): bounds the answer near singularities at the price of a small error. 0 is
            exact.
        rank_tolerance, tolerance: As for `Cascade`.
    """

    name = "iktc"

    def __init__(self, damping: float = 0.0, rank_tolerance: float = 1e-7, tolerance: float = 1e-7) -> None:
        self.damping = damping
        self.rank_tolerance = rank_tolerance
        self.tolerance = tolerance
        self._qps = PersistentQPs(tolerance=10.0 * tolerance)
        self._cascade = Cascade(damping, rank_tolerance, tolerance)

    def solve(self, levels: Sequence[Level]) -> Solution:
        """Solve the hierarchy; ``levels[0]`` is hard.

        The results' violations are what each level asked for and was not given: its correction.
        """
        hard, leading = levels[0], leading_count(levels)
        tasks = [_leading_task(level, leading) for level in levels]
        bounds = np.flatnonzero(~hard.C[:, leading:].any(axis=1))
        C, lower, upper = hard.C[bounds, :leading], hard.lower[bounds], hard.upper[bounds]
        correction = self._corrected(tasks, C, lower, upper)
        if correction is None:
            return self._cascade.solve(levels)
        first = correction.first_corrected
        if leading == hard.size and not any(len(level.lower) for level in levels[1:]):
            results = [LevelResult(level, correction.x, False, 0.0, Status.SOLVED) for level in levels]
            solution = Solution(correction.x, results, correction.status)
        else:
            asked = [
                _with_corrected_targets(level, correction.x) if k >= first else level for k, level in enumerate(levels)
            ]
            solution = self._cascade.solve(asked)
            for level, result in zip(levels, solution.levels, strict=True):
                result.level = level
            solution.status = max(solution.status, correction.status)
        solution.levels[0].residual = max(solution.levels[0].residual, correction.residual)
        if first < len(levels):
            corrected = solution.levels[first]
            corrected.needed_qp = True
            if correction.status > corrected.status:
                corrected.status, corrected.reason = correction.status, correction.reason
        return solution

    def _corrected(self, tasks: Sequence[Task], C: Array, lower: Array, upper: Array) -> Correction | None:
        """Corrected accelerations of the tasks, the first of which cannot be corrected; None if there are none."""
        priorities = PrioritizedTasks(tasks, self.damping, self.rank_tolerance)
        x, fixed = priorities.x, tasks[0]
        if len(fixed.h):
            away = float(np.abs(fixed.J @ x - fixed.h).max())
            if away > self.tolerance * (1.0 + float(np.abs(fixed.h).max())):
                return None
        value = C @ x
        excess = max(float((value - upper).max(initial=0.0)), float((lower - value).max(initial=0.0)))
        if excess <= self.tolerance:
            return Correction(x, len(tasks), residual=excess)
        gains = priorities.correction_gains()
        for k in range(len(tasks) - 1, 0, -1):
            gain = np.hstack(gains[k:])
            reach = C @ gain
            if not is_feasible(reach, lower - value, upper - value, self.tolerance):
                continue
            size = gain.shape[1]
            qp = self._qps.solve(k, QP(np.eye(size), np.zeros(size), reach, lower - value, upper - value))
            if qp.status != Status.FAILED:
                return Correction(x + gain @ qp.y, k, qp.status, qp.residual, qp.reason)
        return None


def _leading_task(level: Level, leading: int) -> Task:
    """The rows of a level that concern the leading variables only, as a task."""
    own = [e for e in level.equalities if e.start + e.A.shape[1] <= leading]
    return Task(stacked_equalities(own, 0, leading), np.concatenate([np.zeros(0), *(e.b for e in own)]))


def _with_corrected_targets(level: Level, x: Array) -> Level:
    """The level with the targets of its rows on the leading variables replaced by what x reaches."""

    def corrected(e: Equality) -> Equality:
        end = e.start + e.A.shape[1]
        return replace(e, b=e.product(x[e.start : end])) if end <= len(x) else e

    equalities = [corrected(e) for e in level.equalities]
    return Level(level.name, level.size, equalities, level.C, level.lower, level.upper, level.blocks)
