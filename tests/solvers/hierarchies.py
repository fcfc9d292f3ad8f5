"""Random hierarchies, and an oracle that shares nothing with the cascade: a chain of full-size QPs by PIQP."""

import numpy as np
import qpsolvers

from solvers import Level, Rows


def random_hierarchy(rng: np.random.Generator, kind: str) -> list[Level]:
    """A hierarchy of 3 to 5 levels over 8 to 20 variables, its level 0 feasible.

    Kinds: "feasible" (all levels agree), "conflicting" (they do not), "deficient" (repeated and summed rows), "active"
    (inequalities at every level, most of them tight or violated).
    """
    n = int(rng.integers(8, 21))
    inside = rng.standard_normal(n)

    def matrix(m: int) -> np.ndarray:
        # Singular values between 0.5 and 2: what is left of it in a null space is checked by `well_conditioned`.
        u, _, v = np.linalg.svd(rng.standard_normal((m, n)), full_matrices=False)
        return u @ np.diag(rng.uniform(0.5, 2.0, len(v))) @ v

    A = matrix(3)
    C = np.vstack([matrix(4), np.eye(n)])
    width = rng.uniform(0.05, 1.0, len(C))
    shift = rng.uniform(-1.0, 1.0, len(C)) * width * 0.9
    hard = [
        Rows("equal", "1", A, A @ inside, A @ inside),
        Rows("bounds", "1", C, C @ inside + shift - width, C @ inside + shift + width),
    ]
    levels = [Level.stack("hard", hard, n)]
    for k in range(int(rng.integers(2, 5))):
        A = matrix(int(rng.integers(1, 6)))
        target = A @ (inside if kind == "feasible" else inside + rng.standard_normal(n))
        if kind == "deficient":
            extra = rng.standard_normal((2, len(A))) @ A
            A = np.vstack([A, extra])
            target = np.concatenate([target, rng.standard_normal(2)])
        rows = [Rows(f"task {k}", "1", A, target, target, weight=float(rng.uniform(0.5, 2.0)))]
        if kind == "active":
            D = matrix(3)
            middle = D @ (inside + rng.standard_normal(n))
            rows.append(
                Rows(f"bound {k}", "1", D, np.array([-np.inf, *middle[1:]]), middle + np.array([0.0, 0.1, 0.5]))
            )
        levels.append(Level.stack(f"level {k}", rows, n))
    return levels


def lexicographic_optimum(levels: list[Level]) -> list[np.ndarray]:
    """Violation of every level at the lexicographic optimum, one QP in (x, w) a level by an interior-point solver."""
    n = levels[0].A.shape[1]
    rows = [np.vstack([levels[0].A, levels[0].C])]
    lower = [np.concatenate([levels[0].b, levels[0].lower])]
    upper = [np.concatenate([levels[0].b, levels[0].upper])]
    reached = []
    for level in levels[1:]:
        task = np.vstack([level.A, level.C])
        low, high = np.concatenate([level.b, level.lower]), np.concatenate([level.b, level.upper])
        m = len(task)
        above = np.vstack(rows)
        G = np.block([[above, np.zeros((len(above), m))], [task, -np.eye(m)]])
        bl, bu = np.concatenate([*lower, low]), np.concatenate([*upper, high])
        equal = bl == bu
        above, below = ~equal & np.isfinite(bu), ~equal & np.isfinite(bl)
        P = np.diag(np.concatenate([np.zeros(n), np.ones(m)]))
        problem = qpsolvers.Problem(
            P,
            np.zeros(n + m),
            np.vstack([G[above], -G[below]]),
            np.concatenate([bu[above], -bl[below]]),
            G[equal],
            bl[equal],
        )
        x = _solved(problem)
        violation = level.violation(x[:n])
        reached.append(violation)
        # Equalities and violated inequalities are held where they are, satisfied ones keep their bounds.
        value = task @ x[:n]
        held = (low == high) | (np.abs(violation) > 1e-9)
        rows.append(task)
        # The tolerance keeps rounding from making the next oracle problem infeasible.
        lower.append(np.where(held, value, low) - 1e-9)
        upper.append(np.where(held, value, high) + 1e-9)
    return reached


def _solved(problem: qpsolvers.Problem) -> np.ndarray:
    """The oracle's answer, as accurate as it can get it; where no level conflicts the tightest is out of reach."""
    for eps in (1e-11, 1e-10, 1e-9, 1e-8):
        settings = {"eps_abs": eps, "eps_rel": 0.0, "eps_duality_gap_abs": eps, "eps_duality_gap_rel": 0.0}
        solution = qpsolvers.solve_problem(problem, solver="piqp", **settings)
        if solution.found:
            return solution.x
    # An active-set method wants a definite objective; 1e-10 does not show at the accuracy that is compared.
    problem.P = problem.P + 1e-10 * np.eye(len(problem.q))
    solution = qpsolvers.solve_problem(problem, solver="quadprog")
    assert solution.found, "the oracle failed"
    return solution.x
