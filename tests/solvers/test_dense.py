"""The compiled linear algebra against numpy's."""

import numpy as np
import pytest

from solvers.dense import (
    apply_q_transposed,
    backward_substitution,
    forward_substitution,
    gram_cholesky,
    least_squares_in_solution_space,
    lq_factorization,
    solution_space,
)


@pytest.fixture
def rng():
    return np.random.default_rng(0)


def q_transposed(V, factors, rank):
    out = np.eye(V.shape[1])
    for column in out:  # of the identity, a row at a time: those of Q
        apply_q_transposed(V, factors, rank, column)
    return out.T


@pytest.mark.parametrize(("m", "n"), [(1, 1), (1, 7), (5, 5), (12, 36), (24, 30)])
def test_lq_is_a_factorisation(rng, m, n):
    J = rng.normal(size=(m, n))
    L, V, factors, rows, certain = lq_factorization(J)
    Q = q_transposed(V, factors, len(rows)).T
    assert certain and rows.tolist() == list(range(m))
    np.testing.assert_allclose(Q @ Q.T, np.eye(n), atol=1e-13)
    np.testing.assert_allclose(L @ Q[:m], J, atol=1e-13)
    b = rng.normal(size=m)
    np.testing.assert_allclose(L @ forward_substitution(L, rows, b), b, atol=1e-9)
    np.testing.assert_allclose(L.T @ backward_substitution(L, rows, b), b, atol=1e-9)


def test_rows_that_depend_on_those_before_are_named(rng):
    J = rng.normal(size=(7, 9))
    J[2], J[4], J[6] = J[0] - 2.0 * J[1], 0.0, J[3] + 1e-12 * rng.normal(size=9)
    L, _, _, rows, certain = lq_factorization(J)
    assert certain and rows.tolist() == [0, 1, 3, 5]
    shares = backward_substitution(L, rows, L[2, : len(rows)].copy())
    np.testing.assert_allclose(shares @ J[rows], J[2], atol=1e-12)


@pytest.mark.parametrize("spoil", [1e-7, np.nan, np.inf])
def test_doubt_is_admitted(rng, spoil):
    J = rng.normal(size=(4, 9))
    J[3] = J[0] + spoil * rng.normal(size=9)
    assert not lq_factorization(J)[4]


@pytest.mark.parametrize("m", [0, 3, 8])
def test_solutions_are_all_there_are(rng, m):
    J, b = rng.normal(size=(m, 8)), rng.normal(size=m)
    X, independent = solution_space(J, b)
    assert independent and X.shape == (9 - m, 8)
    np.testing.assert_allclose(X[0], np.linalg.lstsq(J, b)[0] if m else 0.0, atol=1e-12)
    np.testing.assert_allclose(J @ X[1:].T, 0.0, atol=1e-12)
    np.testing.assert_allclose(X[1:] @ X[1:].T, np.eye(8 - m), atol=1e-12)


@pytest.mark.parametrize("shortest", [1.0, 1e-2, 1e-4])
def test_nearest_is_the_least_squares_solution(rng, shortest):
    J, b = rng.normal(size=(3, 8)), rng.normal(size=3)
    X, _ = solution_space(J, b)
    W, wanted = rng.normal(size=(10, 8)) @ np.diag([1.0] * 7 + [shortest]), rng.normal(size=10)
    x, determined = least_squares_in_solution_space(X, np.ascontiguousarray(X @ W.T), wanted)
    expected = X[0] + np.linalg.lstsq(W @ X[1:].T, wanted - W @ X[0])[0] @ X[1:]
    assert determined
    np.testing.assert_allclose(x, expected, atol=1e-9 / shortest)


def test_nearest_says_when_something_is_left_free(rng):
    X, _ = solution_space(rng.normal(size=(3, 8)), rng.normal(size=3))
    for W in (rng.normal(size=(4, 8)), np.vstack([rng.normal(size=(4, 8))] * 2), np.zeros((6, 8))):
        assert not least_squares_in_solution_space(X, np.ascontiguousarray(X @ W.T), np.zeros(len(W)))[1]


def test_cholesky_is_a_factor(rng):
    B = rng.normal(size=(5, 9))
    L, shortest = gram_cholesky(B)
    np.testing.assert_allclose(L @ L.T, B @ B.T, atol=1e-12)
    assert 0.0 < shortest <= 1.0
    assert gram_cholesky(np.vstack([B, B[:1]]))[1] < 1e-7 and gram_cholesky(np.full((2, 3), np.nan))[1] == 0.0
