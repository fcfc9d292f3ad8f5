"""Persistent quadratic programs where they are least comfortable."""

from pathlib import Path

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
    problem = QP(np.eye(n), rng.normal(size=n), C, lower, upper)
    answer = PersistentQPs().solve("impossible", problem, use_second_solver=False)
    assert answer.status == Status.FAILED
    assert answer.reason == "ProxQP gave up after 100 iterations"  # left alone, it goes on for seconds


def test_a_problem_with_rows_of_rounding_is_solved():
    C = np.array([[1.0, 0.0], [1e-20, 1e-21], [0.0, 1.0]])
    qps = PersistentQPs()
    for _ in range(2):  # anew and warm
        answer = qps.solve("small", QP(np.eye(2), np.full(2, 2.0), C, np.full(3, -1.0), np.ones(3)))
        assert answer.status == Status.SOLVED
        np.testing.assert_allclose(answer.y, 1.0, atol=1e-8)
        np.testing.assert_allclose(answer.multipliers, [1.0, 0.0, 1.0], atol=1e-7)


def test_a_thin_set_that_the_second_solver_finds_empty_is_tried_again():
    """A level of a foot that begins to slide: the levels above have left it next to no room, but some."""
    with np.load(Path(__file__).with_name("stubborn.npz")) as file:
        problem = QP(**file, known_feasible=True)
    assert problem.violation(np.zeros(problem.A.shape[1])) == 0.0
    answer = PersistentQPs(max_iterations=1).solve("stubborn", problem)
    assert answer.status == Status.SECOND_SOLVER
    assert answer.residual < 1e-6
    assert np.linalg.norm(problem.A @ answer.y - problem.b) < np.linalg.norm(problem.b)  # no worse than to stay


def test_an_answer_does_not_depend_on_where_in_memory_the_solver_lies():
    """ProxQP's own answers to these differ by up to 5e-10: a closed loop makes another run of that."""
    rng = np.random.default_rng(0)
    for _ in range(40):
        n, m, rank = rng.integers(8, 36), rng.integers(10, 70), rng.integers(2, 8)
        A, b, C = rng.normal(size=(rank, n)), rng.normal(size=rank), rng.normal(size=(m, n))
        problem = QP(A, b, C, -rng.uniform(0.05, 1.0, m), rng.uniform(0.05, 1.0, m))
        held, answers = [], []
        for _ in range(6):
            held.append(np.zeros(rng.integers(1, 5000)))
            answers.append(PersistentQPs().solve("any", problem).y)
        assert all((answer == answers[0]).all() for answer in answers)


def test_of_answers_that_do_equally_well_the_shortest_is_given():
    """One row of three variables, of which a bound takes one: the others share what is left of it in their ratio."""
    problem = QP(np.array([[1.0, 2.0, 2.0]]), np.array([4.0]), np.eye(3)[2:], np.full(1, -1.0), np.full(1, 0.5))
    answer = PersistentQPs().solve("any", problem)
    np.testing.assert_allclose(answer.y, [0.6, 1.2, 0.5], atol=1e-12)
