"""The strict hierarchy of Ramos (12)-(14): each level minimises its violation in the null space of those above.

Level 0 holds, the others are least squares of decreasing priority:

    min ‖w_k‖   subject to   A_k x - b_k = w_k,   lower_k <= C_k x - w_k <= upper_k,
                             levels above keep the violation w* they have reached.

*The usual tick.* Where inequalities are active at the last two levels only, `DirectSolver` needs one factorisation for
all levels.

*Level 0's equalities.* A change of variables, `Reduction`, takes them out before anything else is tried.

*Null spaces.* What level k may still use is an orthonormal basis Z_k of the null space of all equalities above; they
depend on the matrices only. Without inequalities the whole cascade is then a chain of least squares.

*No QP where none is needed.* If the optimum of that chain satisfies every inequality, it is the optimum of the cascade:
no level can do better with inequalities than without. The check is exact, and more: if the chain's point after level j
satisfies them, levels up to j are done. Only what follows needs quadratic programs, each in the variables of Z_k.

*Where inequalities are active.* They mostly are at the same level from tick to tick. A QP at a lower level, with the
levels above held at the chain's optimum, is tried first: if it has a solution, the levels above have theirs. If not,
the QPs start higher.

*Optional rows* of level 0 are kept only where they cost no level above the last two anything: else all of it is solved
without them.

There is no regularisation, so that no later level has to preserve one.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from solvers.chain import ActiveSet, Chain
from solvers.direct import DirectSolver
from solvers.proxqp import PersistentQPs
from solvers.qp_cascade import QPCascade, build_solution
from solvers.reduction import Reduction, leading_count
from solvers.rows import Array, Level, Solution, Status

MAX_ACTIVE_SET_CHANGES = 4
"""Largest number of changes to the guessed active sets before quadratic programs are solved."""
SOLVED_IN_PARTS = "neither solver found a point that satisfies it; found in parts, of which none had to give way"
CONTRADICTORY_EQUALITIES = "its equalities contradict each other"


class Cascade:
    """Solver of strict hierarchies on null-space bases and persistent ProxQP problems.

    Args:
        damping: Damped least squares, Kim (10), of the levels below level 0: bounds their answer near singularities at
            the price of a small error. 0 is exact.
        rank_tolerance: Directions in which a level's rows, relative to their largest, are shorter than this are left to
            the levels below.
        tolerance: Violation that counts as none.
    """

    name = "cascade"

    def __init__(self, damping: float = 0.0, rank_tolerance: float = 1e-7, tolerance: float = 1e-7) -> None:
        self.damping = damping
        self.rank_tolerance = rank_tolerance
        self.tolerance = tolerance
        self._qps = PersistentQPs(tolerance=10.0 * tolerance)
        self._direct = DirectSolver(tolerance)
        self._first_qp_level = 10**6  # the level at which inequalities bit last
        self._active_sets: list[ActiveSet] | None = None  # and which ones they were
        self._level_sizes: list[tuple[int, int]] = []

    def solve(self, levels: Sequence[Level]) -> Solution:
        """Solve the hierarchy; ``levels[0]`` is hard.

        If level 0 has no solution, its rows give way in the order they name, each step a level of its own right below
        level 0; the solution's status is then RELAXED and `relaxed` names what gave way.
        """
        solution = self._solve_with_optional(levels)
        if self._has_paid(solution) and levels[0].leave_out_optional():
            return self._solve_with_optional(levels)
        return solution

    def _has_paid(self, solution: Solution) -> bool:
        """Whether level 0, or a level above the last two, is not met."""
        above = solution.levels[1:-2]
        return solution.levels[0].status >= Status.RELAXED or any(
            not result.all_rows_met and result.error > 10.0 * self.tolerance for result in above
        )

    def _solve_with_optional(self, levels: Sequence[Level]) -> Solution:
        """Solve the hierarchy with the optional rows that it has."""
        if len(levels) == 1:  # somebody has to ask for a point that satisfies level 0
            levels = [levels[0], Level.stack("any", [], levels[0].size)]
            solution = self.solve(levels)
            del solution.levels[1:]
            return solution
        if not (self.damping or self._active_above_last_two()):
            x = self._direct.solve(levels)
            if x is not None:
                self._active_sets = None
                solution = build_solution(levels, x, {}, Status.SOLVED)
                solution.levels[0].residual = self._direct.max_violation
                for result in solution.levels[: self._direct.levels_met]:
                    result.all_rows_met = True
                return solution
        hard = levels[0]
        reduction = Reduction.of(hard, leading_count(levels), self.rank_tolerance) if hard.equalities else None
        if reduction is None:
            return self._solve_or_relax(levels)
        solution = self._solve_or_relax(reduction.reduced_levels(levels))
        solution.x = reduction.full_solution(solution.x)
        for level, result in zip(levels, solution.levels, strict=True):
            result.level, result.x = level, reduction.full_solution(result.x)
        if self._active_sets is not None:
            last = self._active_sets[-2:]
            self._direct.warm_start(np.concatenate([h.rows for h in last]), np.concatenate([h.side for h in last]))
        return solution

    def _active_above_last_two(self) -> bool:
        """Whether inequalities were active above the last two levels when null spaces were last needed."""
        return self._active_sets is not None and any(len(held.rows) for held in self._active_sets[:-2])

    def _solve_or_relax(self, levels: Sequence[Level]) -> Solution:
        """Solve the levels; if level 0 has no solution, relax its rows in their order."""
        solution = self._solve_levels(levels)
        order = sorted({block.gives_way for block in levels[0].blocks if block.gives_way})
        steps: list[int] = []
        answer = solution
        while answer.levels[0].status == Status.FAILED and order:
            steps.insert(0, order.pop(0))
            answer = self._solve_relaxed(levels, steps)
        return solution if answer.levels[0].status == Status.FAILED else answer

    def _solve_relaxed(self, levels: Sequence[Level], steps: list[int]) -> Solution:
        """Solve with the relaxed rows of level 0, those whose `gives_way` is in `steps`, as levels of their own.

        The rows that give way last are the highest of these levels.
        """
        hard, gave_way = _split_relaxable(levels[0], steps)
        solution = self._solve_levels([hard, *gave_way, *levels[1:]])
        if any(result.status == Status.FAILED for result in solution.levels[: 1 + len(gave_way)]):
            solution.levels[0].status = Status.FAILED
            return solution
        for level, result in zip(gave_way, solution.levels[1:], strict=False):
            worst = np.abs(result.violation)
            for block in level.blocks:
                if worst[block.rows].max(initial=0.0) > self.tolerance:
                    solution.relaxed[block.name] = float(worst[block.rows].max()) / block.weight
        first = solution.levels[0]
        first.level = levels[0]
        solution.levels = [first, *solution.levels[1 + len(gave_way) :]]
        # Where nothing gave way, level 0 had a solution after all, which neither QP solver found.
        first.status = Status.RELAXED if solution.relaxed else Status.SECOND_SOLVER
        first.reason = "" if solution.relaxed else SOLVED_IN_PARTS
        solution.status = max(result.status for result in solution.levels)
        return solution

    def _solve_levels(self, levels: Sequence[Level]) -> Solution:
        C, lower, upper, owner = _stacked_inequalities(levels)
        chain = Chain(levels, C, lower, upper, self.rank_tolerance, self.damping)
        guessed = self._solve_with_guessed_active_sets(chain, owner)
        if guessed is not None:
            return guessed
        self._active_sets = None
        chain.run()
        hard = levels[0]
        if _relative_residual(hard.A @ chain.points[0] - hard.b, hard.b) > self.tolerance:
            return build_solution(levels, chain.points[0], {}, Status.FAILED, (0, CONTRADICTORY_EQUALITIES))
        values = C @ np.column_stack(chain.points)
        outside = ((values > (upper + self.tolerance)[:, None]) | (values < (lower - self.tolerance)[:, None])).T
        # A point after level j has to satisfy the inequalities of the levels up to j only.
        solved = max((j for j in range(len(levels)) if not outside[j][owner <= j].any()), default=-1)
        qp_cascade = QPCascade(levels, chain, owner, self._qps, self.tolerance)
        start = max(solved + 1, 1)
        if start == len(levels):
            return build_solution(levels, chain.points[-1], {}, Status.SOLVED)
        usable = max((k for k in range(len(levels)) if chain.null_spaces[k].size), default=0)
        trial = min(self._first_qp_level, usable)
        if trial > start:
            answer = qp_cascade.run(trial, satisfied=False, optional=True)
            if answer is not None:
                # Levels that were not bitten are given the chance to be skipped next time.
                self._first_qp_level = trial if qp_cascade.first_active_level == trial else trial + 1
                self._remember_active_sets(levels, owner, qp_cascade)
                return answer
        answer = qp_cascade.run(start, satisfied=solved >= 0)
        assert answer is not None
        self._first_qp_level = max(start, min(qp_cascade.first_active_level, len(levels) - 1))
        self._remember_active_sets(levels, owner, qp_cascade)
        return answer

    def _solve_with_guessed_active_sets(self, chain: Chain, owner: Array) -> Solution | None:
        """Solution if the active sets of the last call, or few changes to them, are the right ones; None otherwise."""
        levels = chain.levels
        shape = [(len(level.b), len(level.lower)) for level in levels]
        if shape != self._level_sizes or self._active_sets is None:
            self._level_sizes, self._active_sets = shape, [ActiveSet() for _ in levels]
        if len(owner) and owner[-1]:
            return None  # own inequalities of lower levels are objectives too: the QP cascade handles them
        hard, held, first = (
            levels[0],
            [hold.with_finite_bounds(chain.lower, chain.upper) for hold in self._active_sets],
            0,
        )
        for _ in range(MAX_ACTIVE_SET_CHANGES):
            chain.run(held, first)
            x = chain.points[-1]
            value = chain.C @ x
            excess = np.maximum(value - chain.upper, chain.lower - value)
            changed, first = [ActiveSet() for _ in levels], len(levels)
            for k, hold in enumerate(held):
                if not len(hold.rows):
                    continue
                excess[hold.rows] = np.abs(excess[hold.rows])
                push = hold.side * chain.multipliers(k)
                keeps = push > (self.tolerance if k < len(levels) - 1 else -self.tolerance)
                changed[k] = changed[k].union(hold.subset(keeps))
                if not keeps.all():
                    first = min(first, k)
                    # What does not push here may keep a level below from doing better: it is held there.
                    idle = ~keeps & (push >= -self.tolerance)
                    if idle.any():
                        changed[k + 1] = changed[k + 1].union(hold.subset(idle))
            most = excess.max(initial=-np.inf)
            if first == len(levels) and most <= self.tolerance:  # which not a number is not
                self._active_sets = held
                if len(hard.b) and _relative_residual(hard.A @ x - hard.b, hard.b) > self.tolerance:
                    return None
                solution = build_solution(levels, x, {}, Status.SOLVED)
                solution.levels[0].residual = max(float(most), 0.0)
                return solution
            if first < len(levels):
                held = changed
                continue
            row = int(np.argmax(excess))
            if any((hold.rows == row).any() for hold in held):
                return None
            strength = [
                float(np.abs(chain.C[row] @ chain.null_spaces[k].Z).max(initial=0.0)) for k in range(len(levels))
            ]
            usable = [k for k in range(1, len(levels)) if strength[k] > 1e-6]
            if not usable:
                return None
            first = usable[-1]
            side = 1.0 if value[row] > chain.upper[row] else -1.0
            held = list(held)
            held[first] = held[first].union(ActiveSet(np.array([row]), np.array([side])))
        return None

    def _remember_active_sets(self, levels: Sequence[Level], owner: Array, qp_cascade: QPCascade) -> None:
        if not owner.any():
            self._active_sets = [qp_cascade.active_sets.get(k, ActiveSet()) for k in range(len(levels))]


def _relative_residual(residual: Array, b: Array) -> float:
    return float(np.abs(residual).max(initial=0.0)) / (1.0 + float(np.abs(b).max(initial=0.0)))


def _stacked_inequalities(levels: Sequence[Level]) -> tuple[Array, Array, Array, Array]:
    """Inequalities C, lower and upper of all levels stacked, and the level that owns each row."""
    if all(not len(level.lower) for level in levels[1:]):
        first = levels[0]
        return first.C, first.lower, first.upper, np.zeros(len(first.lower), dtype=int)
    return (
        np.vstack([level.C for level in levels]),
        np.concatenate([level.lower for level in levels]),
        np.concatenate([level.upper for level in levels]),
        np.repeat(np.arange(len(levels)), [len(level.lower) for level in levels]),
    )


def _split_relaxable(hard: Level, steps: list[int]) -> tuple[Level, list[Level]]:
    """Level 0 without the rows whose `gives_way` is in `steps`, and one level for each step, in the given order."""

    def part(name: str, wanted: set[int]) -> Level:
        blocks, rows, start = [], [], 0
        for block in hard.blocks:
            if block.equality or block.gives_way not in wanted:
                continue
            rows.append(np.arange(block.rows.start, block.rows.stop))
            count = block.rows.stop - block.rows.start
            blocks.append(replace(block, rows=slice(start, start + count), gives_way=0))
            start += count
        index = np.concatenate(rows) if rows else np.zeros(0, dtype=int)
        return Level(name, hard.size, [], hard.C[index], hard.lower[index], hard.upper[index], blocks)

    kept = part(hard.name, {b.gives_way for b in hard.blocks} - set(steps))
    equalities = [block for block in hard.blocks if block.equality]
    rest = Level(hard.name, hard.size, hard.equalities, kept.C, kept.lower, kept.upper, equalities + kept.blocks)
    return rest, [part(f"relaxed {step}", {step}) for step in steps]
