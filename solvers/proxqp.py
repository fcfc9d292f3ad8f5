"""Least squares under inequalities on ProxQP, warm-started from call to call, with a second solver as fallback.

ProxQP tells which inequalities are tight. Given these, the answer is one of plain least squares, mostly the shortest if
there are many: its last digits then depend on neither the place in memory nor the call before, which ProxQP's do.
"""

from dataclasses import dataclass, replace

import numpy as np
import qpsolvers
from proxsuite import proxqp

from solvers.direct.tight_rows import least_squares_on_tight_rows
from solvers.rows import Array, Status

SECOND_SOLVER_NAME = "quadprog"
ZERO_BELOW = 1e-13
"""Size, relative to the largest entry of C, below which entries count as zero: they are rounding."""

INFEASIBILITY_TOLERANCES = 1e-7, 1e-12
"""ProxQP's `eps_primal_inf`, which decides when a thin feasible set counts as empty: as a rule, and where the QP is
known to be feasible."""
BOUND_WIDENINGS = 3.0, 100.0
"""Where a set has no width, solvers stumble over rounding. The levels above are known to the accuracy of
their QPs: bounds are widened by this many times that accuracy, where ProxQP has failed and where the second solver
has."""
ADDED_CURVATURES = 1e-10, 1e-8
"""Curvature added to the objective, relative to its mean, for the second solver, which needs a positive definite one:
as a rule far less than shows in the answer, and where the solver has failed."""

TIGHT_MULTIPLIER = 1e-6
"""Multiplier, relative to 1 plus the largest one, above which an inequality is tight for certain."""


@dataclass(slots=True)
class QP:
    """``min ½ ‖A y − b‖²`` subject to ``lower <= C y <= upper``.

    Args:
        A, b: Objective, shapes (k, n) and (k,).
        C, lower, upper: Inequalities, shapes (m, n), (m,), (m,).
        known_feasible: Whether it is known to have a solution.
    """

    A: Array
    b: Array
    C: Array
    lower: Array
    upper: Array
    known_feasible: bool = False

    def violation(self, y: Array) -> float:
        """Largest violation of an inequality at y, 0 if there is none."""
        if not len(self.lower):
            return 0.0
        value = self.C @ y
        return max(0.0, float((value - self.upper).max()), float((self.lower - value).max()))


@dataclass(slots=True)
class QPResult:
    """Answer of one QP.

    Args:
        y: The variables, shape (n,); of those that do equally well the shortest, where rounding allows.
        multipliers: Of the inequalities, positive at an upper bound, negative at a lower one, shape (m,).
        status: SOLVED, SECOND_SOLVER or FAILED; ``y`` is not to be used if it failed.
        residual: Largest violation of an inequality at ``y``.
        reason: What became of it in words, unless ProxQP solved it.
    """

    y: Array
    multipliers: Array
    status: Status
    residual: float
    reason: str = ""


class PersistentQPs:
    """Solves QPs, with one ProxQP object a key and size.

    An object is created once, updated from then on and warm-started from its previous result: ticks of a controller
    differ little. A may have any rank; the proximal iteration needs no regularisation, so that none enters the answer.

    Args:
        accuracy: Absolute accuracy of the optimality conditions.
        tolerance: Largest violation of an inequality in an answer that is accepted.
        max_iterations: Iterations after which ProxQP gives up: on a problem without solution it would go on for long.
    """

    def __init__(self, accuracy: float = 1e-9, tolerance: float = 1e-6, max_iterations: int = 100) -> None:
        self.accuracy = accuracy
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self._solvers: dict[tuple[object, int, int], proxqp.dense.QP] = {}
        one = np.ones((1, 1))  # a program that compiles what would else be compiled in the middle of a run
        least_squares_on_tight_rows(one, one[0], one, -one[0], one[0], np.zeros(1), np.zeros(1), accuracy)

    def solve(self, key: object, problem: QP, use_second_solver: bool = True) -> QPResult:
        """Solve a QP.

        Args:
            key: Names the sequence of similar problems that it belongs to: those of one size share a warm start.
            problem: The QP.
            use_second_solver: Whether a problem that ProxQP leaves unsolved goes to the second solver.
        """
        C, lower, upper = problem.C, problem.lower, problem.upper
        H, g = problem.A.T @ problem.A, -(problem.A.T @ problem.b)
        n, m = len(g), len(lower)
        # Scaled up by the preconditioner, rows of mere rounding would keep ProxQP busy for seconds.
        C = np.ascontiguousarray(np.where(np.abs(C) > ZERO_BELOW * np.abs(C).max(initial=0.0), C, 0.0))
        problem = replace(problem, C=C)
        place = (key, n, m)
        qp = self._solvers.get(place)
        if qp is not None:
            qp.settings.eps_primal_inf = INFEASIBILITY_TOLERANCES[problem.known_feasible]
            qp.update(H=H, g=g, C=C, l=lower, u=upper, update_preconditioner=False)
            qp.solve()
            if (answer := self._accepted_result(qp, problem)) is not None:
                return answer
        # Anew: there was no previous result, or it was no good place to start from.
        for wider in (0.0, BOUND_WIDENINGS[0] * self.accuracy)[: 1 + problem.known_feasible]:
            qp = self._new_solver(n, m)
            qp.settings.eps_primal_inf = INFEASIBILITY_TOLERANCES[problem.known_feasible]
            qp.init(H, g, None, None, C, lower - wider, upper + wider)
            qp.solve()
            if (answer := self._accepted_result(qp, problem)) is not None:
                # Only now: ProxQP has no previous result to start from before its first solve.
                qp.settings.initial_guess = proxqp.WARM_START_WITH_PREVIOUS_RESULT
                self._solvers[place] = qp
                return answer
        self._solvers.pop(place, None)
        reason = self._failure_reason(qp)
        return self._solve_with_second_solver(problem, reason) if use_second_solver else _failed_result(problem, reason)

    def _accepted_result(self, qp: proxqp.dense.QP, problem: QP) -> QPResult | None:
        """Result of a solved QP; None if ProxQP has not solved it or the answer violates a bound."""
        if qp.results.info.status != proxqp.PROXQP_SOLVED:
            return None
        return self._checked_result(problem, qp.results.x.copy(), qp.results.z.copy(), Status.SOLVED)

    def _checked_result(
        self, problem: QP, y: Array, multipliers: Array, status: Status, reason: str = ""
    ) -> QPResult | None:
        """Result of a solver's answer, made exact where that can be; None if the answer violates a bound."""
        residual = problem.violation(y)
        if residual > self.tolerance:
            return None
        exact = self._exact_answer(problem, y, multipliers)
        if exact is not None:
            y, residual = exact, problem.violation(exact)
        return QPResult(y, multipliers, status, residual, reason)

    def _exact_answer(self, problem: QP, y: Array, multipliers: Array) -> Array | None:
        """Answer of least squares with the tight inequalities as equalities; None if it is not that of `y`.

        Where many do equally well, it is the shortest, or where that is not found the one nearest to `y`.
        """
        tight = np.abs(multipliers) > TIGHT_MULTIPLIER * (1.0 + np.abs(multipliers).max(initial=0.0))
        sides = np.where(tight, np.sign(multipliers), 0.0)
        A, b = np.ascontiguousarray(problem.A), np.asarray(problem.b)
        exact = least_squares_on_tight_rows(A, b, problem.C, problem.lower, problem.upper, sides, y, self.accuracy)
        if exact is None:
            return None
        # The gradients agree where and only where one is as good as the other.
        gap = np.abs(A.T @ (A @ (exact - y))).max(initial=0.0)
        return exact if gap <= self.tolerance * (1.0 + np.abs(A.T @ b).max(initial=0.0)) else None

    def _failure_reason(self, qp: proxqp.dense.QP) -> str:
        """Why ProxQP has no answer, in words."""
        most = self.max_iterations
        return {
            proxqp.PROXQP_SOLVED: "ProxQP's answer breaks a bound",
            proxqp.PROXQP_MAX_ITER_REACHED: f"ProxQP gave up after {most} iteration{'s' * (most > 1)}",
            proxqp.PROXQP_PRIMAL_INFEASIBLE: "ProxQP took it for infeasible",
        }.get(qp.results.info.status, "ProxQP took it for unbounded")

    def _new_solver(self, n: int, m: int) -> proxqp.dense.QP:
        qp = proxqp.dense.QP(n, 0, m, False, proxqp.dense.HessianType.Dense, proxqp.dense.DenseBackend.PrimalDualLDLT)
        qp.settings.eps_abs = self.accuracy
        qp.settings.eps_rel = 0.0
        # Without this ProxQP may stop far from the optimum: its residuals say nothing of complementarity.
        qp.settings.check_duality_gap = True
        qp.settings.eps_duality_gap_abs = self.accuracy
        qp.settings.eps_duality_gap_rel = 0.0
        qp.settings.max_iter = qp.settings.max_iter_in = self.max_iterations
        qp.settings.initial_guess = proxqp.NO_INITIAL_GUESS
        return qp

    def _solve_with_second_solver(self, problem: QP, reason: str) -> QPResult:
        C, lower, upper = problem.C, problem.lower, problem.upper
        H, g = problem.A.T @ problem.A, -(problem.A.T @ problem.b)
        n, m = len(H), len(lower)
        curvature = max(1.0, float(np.trace(H)) / n) * np.eye(n)
        wide = BOUND_WIDENINGS[1] * self.accuracy
        attempts = [(ADDED_CURVATURES[0], 0.0), (ADDED_CURVATURES[0], wide), (ADDED_CURVATURES[1], wide)]
        above, below = np.isfinite(upper), np.isfinite(lower)
        rows, bounds = np.vstack([C[above], -C[below]]), np.concatenate([upper[above], -lower[below]])
        for definite, wider in attempts if problem.known_feasible else attempts[:1]:
            try:
                solution = qpsolvers.solve_problem(
                    qpsolvers.Problem(H + definite * curvature, g, rows, bounds + wider),
                    solver=SECOND_SOLVER_NAME,
                )
            except (qpsolvers.SolverError, ValueError):
                continue
            if not solution.found or solution.x is None or solution.z is None or not np.isfinite(solution.x).all():
                continue
            multipliers = np.zeros(m)
            multipliers[above] += solution.z[: above.sum()]
            multipliers[below] -= solution.z[above.sum() :]
            words = f"{reason}, {SECOND_SOLVER_NAME} solved it"
            if (
                answer := self._checked_result(problem, solution.x, multipliers, Status.SECOND_SOLVER, words)
            ) is not None:
                return answer
        return _failed_result(problem, f"{reason}, {SECOND_SOLVER_NAME} found no answer")


def _failed_result(problem: QP, reason: str) -> QPResult:
    return QPResult(np.zeros(problem.A.shape[1]), np.zeros(len(problem.lower)), Status.FAILED, np.inf, reason)
