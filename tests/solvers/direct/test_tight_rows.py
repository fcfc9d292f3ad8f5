"""The exact answer once the tight inequalities are known, against pseudo-inverses."""

import numpy as np

from solvers.direct.tight_rows import least_squares_on_tight_rows

EVERYWHERE = np.full(6, 1e3)


def test_the_shortest_of_all_answers_is_that_of_pseudo_inverses():
    """Tight rows that depend on one another and an objective of any rank."""
    rng = np.random.default_rng(0)
    for rank in range(1, 9):
        n, A = 8, rng.normal(size=(12, rank)) @ rng.normal(size=(rank, 8))
        b, C = rng.normal(size=12), rng.normal(size=(6, n))
        C[2] = C[0] - 2.0 * C[1]
        upper, sides = EVERYWHERE.copy(), np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
        upper[:3] = 0.3, -0.2, 0.7
        y = least_squares_on_tight_rows(A, b, C, -EVERYWHERE, upper, sides, np.zeros(n), 1e-9)
        held = np.linalg.pinv(C[:2]) @ upper[:2]
        free = np.eye(n) - np.linalg.pinv(C[:2]) @ C[:2]
        expected = held + np.linalg.pinv(A @ free, rcond=1e-9) @ (b - A @ held)
        assert y is not None
        np.testing.assert_allclose(y, expected, atol=1e-9)


def test_a_bound_that_the_shortest_answer_breaks_is_tight_too():
    A, b = np.array([[1.0, 1.0, 0.0]]), np.array([2.0])
    C, lower, upper = np.eye(3), np.full(3, -1.0), np.array([0.5, 3.0, 1.0])
    y = least_squares_on_tight_rows(A, b, C, lower, upper, np.zeros(3), np.zeros(3), 1e-9)
    assert y is not None
    np.testing.assert_allclose(y, [0.5, 1.5, 0.0], atol=1e-12)


def test_where_the_shortest_answer_leads_nowhere_the_one_nearest_to_the_known_answer_is_given():
    """Three bounds that the shortest breaks at once, in the two variables that are free."""
    A, b = np.array([[0.0, 0.0, 1.0]]), np.array([1.0])
    C = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
    lower, upper = np.array([1.0, 1.0, 2.5]), np.full(3, 9.0)
    known = np.array([2.0, 3.0, 0.9])  # to one digit
    y = least_squares_on_tight_rows(A, b, C, lower, upper, np.zeros(3), known, 1e-9)
    assert y is not None
    np.testing.assert_allclose(y, [2.0, 3.0, 1.0], atol=1e-12)


def test_tight_rows_that_contradict_each_other_have_no_answer():
    C, lower, upper = np.array([[1.0, 0.0], [1.0, 0.0]]), np.array([-1.0, 0.5]), np.array([0.0, 1.0])
    y = least_squares_on_tight_rows(np.eye(2), np.ones(2), C, lower, upper, np.array([1.0, -1.0]), np.zeros(2), 1e-9)
    assert y is None


def test_an_objective_that_tight_rows_have_used_up_moves_nothing():
    """What is left of its rows is rounding, and no direction to go."""
    rng = np.random.default_rng(1)
    C = rng.normal(size=(3, 6))
    upper = np.full(3, 0.5)
    y = least_squares_on_tight_rows(C.copy(), np.full(3, 9.0), C, -upper, upper, np.ones(3), np.zeros(6), 1e-9)
    assert y is not None
    np.testing.assert_allclose(y, np.linalg.pinv(C) @ upper, atol=1e-12)
