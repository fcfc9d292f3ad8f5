"""Quadratic programs that stay alive between calls, on ProxQP, with a second solver behind it."""

from dataclasses import dataclass

import numpy as np
import qpsolvers
from proxsuite import proxqp

from solvers.rows import Array, Status

SECOND_SOLVER = "quadprog"
ROUNDING = 1e-13
"""Entries of the inequalities that are smaller than this, relative to the largest, are zero but for rounding."""


@dataclass(slots=True)
class QPResult:
    """Answer of one QP.

    Args:
        y: The variables, shape (n,).
        multipliers: Of the inequalities, positive at an upper bound, negative at a lower one, shape (m,).
        status: SOLVED, SECOND_SOLVER or FAILED; ``y`` is not to be used if it failed.
        residual: Largest violation of an inequality at ``y``.
    """

    y: Array
    multipliers: Array
    status: Status
    residual: float


class PersistentQPs:
    """``min ½ yᵀ H y + gᵀ y`` subject to ``lower <= C y <= upper``, one ProxQP object a key and size.

    An object is created once, updated from then on and warm-started from its previous result: ticks of a controller
    differ little. H may be singular; the proximal iteration needs no regularisation, so that none enters the answer.

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

    def solve(
        self, key: object, H: Array, g: Array, C: Array, lower: Array, upper: Array, second: bool = True
    ) -> QPResult:
        """Solve the QP; ``key`` names the sequence of similar problems that it belongs to.

        Args:
            key: Problems of one key and size share a warm start.
            H, g: Objective, shapes (n, n) and (n,), H symmetric and positive semidefinite.
            C, lower, upper: Inequalities, shapes (m, n), (m,), (m,).
            second: Whether a problem that ProxQP leaves unsolved goes to the second solver.
        """
        n, m = len(g), len(lower)
        # Scaled up by the preconditioner, rows of mere rounding would keep ProxQP busy for seconds.
        C = np.where(np.abs(C) > ROUNDING * np.abs(C).max(initial=0.0), C, 0.0)
        place = (key, n, m)
        qp = self._solvers.get(place)
        if qp is not None:
            qp.update(H=H, g=g, C=C, l=lower, u=upper, update_preconditioner=False)
            qp.solve()
            if (answer := self._accepted(qp, C, lower, upper)) is not None:
                return answer
        # Anew: there was no previous result, or it was no good place to start from.
        qp = self._create(n, m)
        qp.init(H, g, None, None, C, lower, upper)
        qp.solve()
        if (answer := self._accepted(qp, C, lower, upper)) is not None:
            # Only now: ProxQP has no previous result to start from before its first solve.
            qp.settings.initial_guess = proxqp.WARM_START_WITH_PREVIOUS_RESULT
            self._solvers[place] = qp
            return answer
        self._solvers.pop(place, None)
        return self._second(H, g, C, lower, upper) if second else _failure(n, m)

    def _accepted(self, qp: proxqp.dense.QP, C: Array, lower: Array, upper: Array) -> QPResult | None:
        """The answer of a solved QP, None where it is no answer."""
        if qp.results.info.status != proxqp.PROXQP_SOLVED:
            return None
        y = qp.results.x.copy()
        residual = _violation(C @ y, lower, upper)
        return QPResult(y, qp.results.z.copy(), Status.SOLVED, residual) if residual <= self.tolerance else None

    def _create(self, n: int, m: int) -> proxqp.dense.QP:
        qp = proxqp.dense.QP(n, 0, m, False, proxqp.dense.HessianType.Dense, proxqp.dense.DenseBackend.PrimalDualLDLT)
        qp.settings.eps_abs = self.accuracy
        qp.settings.eps_rel = 0.0
        qp.settings.eps_primal_inf = 1e-7
        # Without this ProxQP may stop far from the optimum: its residuals say nothing of complementarity.
        qp.settings.check_duality_gap = True
        qp.settings.eps_duality_gap_abs = self.accuracy
        qp.settings.eps_duality_gap_rel = 0.0
        qp.settings.max_iter = qp.settings.max_iter_in = self.max_iterations
        qp.settings.initial_guess = proxqp.NO_INITIAL_GUESS
        return qp

    def _second(self, H: Array, g: Array, C: Array, lower: Array, upper: Array) -> QPResult:
        n, m = len(g), len(lower)
        # The second solver wants a positive definite objective; this is far below what its answer is accurate to.
        definite = H + 1e-10 * max(1.0, float(np.trace(H)) / n) * np.eye(n)
        above, below = np.isfinite(upper), np.isfinite(lower)
        problem = qpsolvers.Problem(
            definite, g, np.vstack([C[above], -C[below]]), np.concatenate([upper[above], -lower[below]])
        )
        try:
            solution = qpsolvers.solve_problem(problem, solver=SECOND_SOLVER)
        except (qpsolvers.SolverError, ValueError):
            return _failure(n, m)
        if not solution.found or solution.x is None or solution.z is None or not np.isfinite(solution.x).all():
            return _failure(n, m)
        multipliers = np.zeros(m)
        multipliers[above] += solution.z[: above.sum()]
        multipliers[below] -= solution.z[above.sum() :]
        residual = _violation(C @ solution.x, lower, upper)
        status = Status.SECOND_SOLVER if residual <= self.tolerance else Status.FAILED
        return QPResult(solution.x, multipliers, status, residual)


def _violation(value: Array, lower: Array, upper: Array) -> float:
    if not len(value):
        return 0.0
    return max(0.0, float((value - upper).max()), float((lower - value).max()))


def _failure(n: int, m: int) -> QPResult:
    return QPResult(np.zeros(n), np.zeros(m), Status.FAILED, np.inf)
