"""Persistent quadratic programs where they are least comfortable."""

import time

import numpy as np

from solvers.proxqp import QP, PersistentQPs
from solvers.rows import Status


def test_a_bound_that_only_rounding_could_reach_is_given_up_at_once():
    """Directions that the levels above have used up leave rows of 1e-20 in what is left; they count as zero."""
    rng = np.random.default_rng(0)
    n, m = 8, 40
    C = rng.normal(size=(m, n))
    C[::2] *= 1e-20
    lower, upper = np.full(m, -1.0), np.full(m, 1.0)
    lower[4], upper[4] = 0.5, 2.0
    start = time.perf_counter()
    problem = QP(np.eye(n), rng.normal(size=n), C, lower, upper)
    answer = PersistentQPs().solve("impossible", problem, second=False)
    assert answer.status == Status.FAILED
    assert time.perf_counter() - start < 0.2


def test_a_problem_with_rows_of_rounding_is_solved():
    C = np.array([[1.0, 0.0], [1e-20, 1e-21], [0.0, 1.0]])
    qps = PersistentQPs()
    for _ in range(2):  # anew and warm
        answer = qps.solve("small", QP(np.eye(2), np.array([-2.0, -2.0]), C, np.full(3, -1.0), np.ones(3)))
        assert answer.status == Status.SOLVED
        np.testing.assert_allclose(answer.y, 1.0, atol=1e-8)
        np.testing.assert_allclose(answer.multipliers, [1.0, 0.0, 1.0], atol=1e-7)
