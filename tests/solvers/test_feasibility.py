"""The simplex method's yes or no, against a linear program's."""

import numpy as np
import pytest
from scipy.optimize import linprog

from solvers.feasibility import is_feasible


def program_has_solution(A, lower, upper):
    rows, bounds = np.vstack([A, -A]), np.concatenate([upper, -lower])
    finite = np.isfinite(bounds)
    return linprog(np.zeros(A.shape[1]), rows[finite], bounds[finite], bounds=(None, None)).status == 0


def problems(rng, kind):
    n = int(rng.integers(1, 20))
    m = int(rng.integers(1, n + 1))
    if kind == "integer":  # ties everywhere: repeated rows, bounds that touch
        A = rng.integers(-1, 2, (n, m)).astype(float)
        middle, width = rng.integers(-2, 3, n).astype(float), rng.integers(0, 3, n).astype(float)
    else:
        A = rng.standard_normal((n, m))
        middle, width = 0.5 * rng.standard_normal(n), rng.uniform(0.05, 1.0, n) * 10.0 ** rng.uniform(-1, 1)
    lower, upper = middle - width, middle + width
    if kind == "one-sided":
        lower[rng.random(n) < 0.5] = -np.inf
        upper[rng.random(n) < 0.3] = np.inf
    return A, lower, upper


@pytest.mark.parametrize("kind", ["two-sided", "one-sided", "integer"])
def test_agrees_with_a_linear_program(kind):
    rng = np.random.default_rng(0)
    answers = []
    for _ in range(150):
        problem = problems(rng, kind)
        answers.append(is_feasible(*problem, tolerance=1e-9))
        assert answers[-1] == program_has_solution(*problem)
    assert 0.1 < np.mean(answers) < 0.95


def test_ends_by_bland_s_rule_too(monkeypatch):
    monkeypatch.setattr("solvers.feasibility.GREEDY_PIVOTS_PER_ROW", 0)
    rng = np.random.default_rng(1)
    for kind in ("two-sided", "integer"):
        for _ in range(100):
            problem = problems(rng, kind)
            assert is_feasible(*problem, tolerance=1e-9) == program_has_solution(*problem)


def test_corner_cases():
    nothing, one = np.zeros((0, 3)), np.ones(1)
    assert is_feasible(nothing, np.zeros(0), np.zeros(0), 1e-9)
    assert is_feasible(np.zeros((1, 2)), -one, one, 1e-9)
    assert not is_feasible(np.zeros((1, 2)), one, 2.0 * one, 1e-9)  # a row that nothing moves
    assert not is_feasible(np.ones((1, 1)), one, -one, 1e-9)  # nothing lies between
    assert is_feasible(np.ones((1, 1)), one, one - 1e-12, 1e-9)
    assert not is_feasible(np.ones((2, 1)), np.array([np.nan, 0.0]), np.array([np.nan, 1.0]), 1e-9)
