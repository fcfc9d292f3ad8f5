import numpy as np
import pytest
import quadprog
import scipy.sparse as sp

from solvers.banded import BandedQP, sparse_qp


def random_problem(rng, n=30, band=3):
    factor = np.tril(rng.standard_normal((n, n)))
    factor[np.subtract.outer(np.arange(n), np.arange(n)) > band] = 0.0
    dense = factor @ factor.T + np.eye(n)
    H = np.array([[dense[j + d, j] if j + d < n else 0.0 for d in range(band + 1)] for j in range(n)])
    differences = sp.diags_array([np.full(n, -1.0), np.ones(n - 1)], offsets=[0, 1], shape=(n - 1, n))
    A = sp.vstack([sp.eye_array(n), differences], format="csr")
    return dense, H, rng.standard_normal(n) * 5.0, A


@pytest.mark.parametrize("seed", range(5))
def test_agrees_with_a_dense_solver(seed):
    rng = np.random.default_rng(seed)
    dense, H, g, A = random_problem(rng)
    bound = np.concatenate([np.full(30, 0.4), np.full(29, 0.15)])
    solution = BandedQP(A, -bound, bound, band=3).solve(H, g, tolerance=1e-10)
    C = A.toarray()
    expected = quadprog.solve_qp(dense, -g, np.vstack([C, -C]).T, np.concatenate([-bound, -bound]))[0]
    assert solution.solved and solution.iterations > 0
    assert solution.violation < 1e-7
    np.testing.assert_allclose(solution.x, expected, atol=1e-5)


@pytest.mark.parametrize("band", [47, 48, 64, 65])
def test_a_matrix_of_any_band_gives_the_same_answer(band):
    _, H, g, A = random_problem(np.random.default_rng(3), n=120)
    bound = np.concatenate([np.full(120, 0.4), np.full(119, 0.15)])
    wide = np.zeros((120, band + 1))
    wide[:, :4] = H
    narrow, padded = (
        BandedQP(A, -bound, bound, band=own.shape[1] - 1).solve(own, g, tolerance=1e-10) for own in (H, wide)
    )
    assert padded.solved and padded.iterations == narrow.iterations
    np.testing.assert_allclose(padded.x, narrow.x, atol=1e-9)


def test_the_price_that_is_expected_changes_the_way_not_the_answer():
    _, H, g, A = random_problem(np.random.default_rng(0))
    qp = BandedQP(A, np.full(59, -0.15), np.full(59, 0.15), band=3)
    cheap, dear = (qp.solve(H, g, first_multiplier=price, tolerance=1e-10) for price in (1.0, 1e5))
    assert cheap.solved and dear.solved and cheap.iterations != dear.iterations
    np.testing.assert_allclose(cheap.x, dear.x, atol=1e-6)


def test_without_active_limits_returns_the_minimum_at_once():
    dense, H, g, A = random_problem(np.random.default_rng(0))
    bound = np.full(59, 1e3)
    solution = BandedQP(A, -bound, bound, band=3).solve(H, g, tolerance=1e-10)
    assert solution.iterations == 0
    np.testing.assert_allclose(solution.x, -np.linalg.solve(dense, g), atol=1e-10)


def test_one_sided_limits():
    dense, H, g, A = random_problem(np.random.default_rng(1))
    lower = np.full(59, -np.inf)
    upper = np.full(59, np.inf)
    lower[:30] = 0.1
    solution = BandedQP(A, lower, upper, band=3).solve(H, g, tolerance=1e-10)
    expected = quadprog.solve_qp(dense, -g, np.eye(30), np.full(30, 0.1))[0]
    np.testing.assert_allclose(solution.x, expected, atol=1e-5)


def test_refuses_limits_without_room_or_wider_than_the_band():
    _, _, _, A = random_problem(np.random.default_rng(2))
    with pytest.raises(ValueError, match="no room"):
        BandedQP(A, np.zeros(59), np.zeros(59), band=3)
    wide = sp.csr_array(([1.0, 1.0], ([0, 0], [0, 9])), shape=(1, 30))
    with pytest.raises(ValueError, match="9 apart"):
        BandedQP(wide, -np.ones(1), np.ones(1), band=3)


@pytest.mark.parametrize("seed", range(3))
def test_variables_in_no_order_are_put_in_one(seed):
    rng = np.random.default_rng(seed)
    dense, _, _, A = random_problem(rng)
    mixed = rng.permutation(30)
    dense, A = dense[np.ix_(mixed, mixed)], A[:, mixed]
    lower = np.concatenate([rng.uniform(-0.5, 0.3, 30), np.full(29, -np.inf)])
    upper = np.concatenate([np.full(30, np.inf), np.full(29, 0.15)])
    solution = sparse_qp(sp.csr_array(dense), A, lower, upper, 1e-10)
    C = A.toarray()
    expected = quadprog.solve_qp(dense, np.zeros(30), np.vstack([C[:30], -C[30:]]).T, np.r_[lower[:30], -upper[30:]])[0]
    assert solution.solved and solution.iterations > 0
    np.testing.assert_allclose(solution.x, expected, atol=1e-5)
