"""Weighted damped inverses against optimisation by other means, formula by formula."""

import numpy as np
import pytest
from scipy.optimize import minimize

from solvers import Level, Rows
from solvers.resolved_acceleration import Penalties, ResolvedAcceleration, damped_inverse

N = 9


def positive_definite(rng):
    root = rng.standard_normal((N, N))
    return root @ root.T + 0.5 * np.eye(N)


def level(name, A, b):
    return Level.stack(name, [Rows(name, "1", A, b, b)], A.shape[1])


def tasks(rng, sizes):
    return [(rng.standard_normal((m, N)), rng.standard_normal(m)) for m in sizes]


def solved(solver, asked, hard=True):
    levels = [level(f"task {k}", A, b) for k, (A, b) in enumerate(asked)]
    return solver.solve(levels if hard else [Level.stack("hard", [], N), *levels]).x


def objective(A, b, damping, W, preferred):
    return lambda x: float(np.sum((A @ x - b) ** 2) + damping**2 * (x - preferred) @ W @ (x - preferred))


def stationary(function, x, within=None):
    """Whether no direction, or none in the span of a basis, improves a function at x."""
    basis, step = np.eye(len(x)) if within is None else within, 1e-5
    slopes = [(function(x + step * d) - function(x - step * d)) / (2.0 * step) for d in basis.T]
    return float(np.abs(slopes).max()) < 1e-6 * (1.0 + abs(function(x)))


@pytest.mark.parametrize("rows", [3, N, 14])
def test_the_inverse_is_hammam_10_and_minimises_13(rows):
    rng = np.random.default_rng(rows)
    (A, b), W = tasks(rng, [rows])[0], positive_definite(rng)
    inverse, Winv = damped_inverse(A, 0.3, W), np.linalg.inv(W)
    np.testing.assert_allclose(inverse, Winv @ A.T @ np.linalg.inv(A @ Winv @ A.T + 0.09 * np.eye(rows)), atol=1e-10)
    assert stationary(objective(A, b, 0.3, W, np.zeros(N)), inverse @ b)
    solver = ResolvedAcceleration((0.3,))
    solver.weight = W
    np.testing.assert_allclose(solved(solver, [(A, b)], hard=False), inverse @ b, atol=1e-10)


def test_without_damping_it_is_the_weighted_least_norm_solution():
    rng = np.random.default_rng(1)
    (A, b), W = tasks(rng, [4])[0], positive_definite(rng)
    solver = ResolvedAcceleration((0.0,))
    solver.weight = W
    x = solved(solver, [(A, b)])
    np.testing.assert_allclose(A @ x, b, atol=1e-10)
    np.testing.assert_allclose(np.linalg.svd(A)[2][4:] @ W @ x, 0.0, atol=1e-9)


def test_the_preferred_answer_fills_what_tasks_leave_hammam_32():
    rng = np.random.default_rng(2)
    (A, b), W, preferred = tasks(rng, [4])[0], positive_definite(rng), rng.standard_normal(N)
    solver = ResolvedAcceleration((0.2,))
    solver.weight, solver.preferred = W, preferred
    x, inverse = solved(solver, [(A, b)]), damped_inverse(A, 0.2, W)
    np.testing.assert_allclose(x, inverse @ b + (np.eye(N) - inverse @ A) @ preferred, atol=1e-10)
    assert stationary(objective(A, b, 0.2, W, preferred), x)


def test_two_levels_as_printed_are_hammam_34_to_39():
    rng = np.random.default_rng(3)
    (Jf, bf), (Ju, bu) = tasks(rng, [4, 7])
    W = positive_definite(rng)
    solver = ResolvedAcceleration((0.1,), exact_projectors=False)
    solver.weight = W
    inverse = damped_inverse(Jf, 0.1, W)
    reduced = Ju @ (np.eye(N) - inverse @ Jf)
    lower = inverse @ bf
    expected = lower + damped_inverse(reduced, 0.1, W) @ (bu - Ju @ lower)
    np.testing.assert_allclose(solved(solver, [(Jf, bf), (Ju, bu)]), expected, atol=1e-9)


def test_three_levels_as_printed_are_algorithm_1_of_dariush():
    rng = np.random.default_rng(4)
    asked = tasks(rng, [2, 3, 5])
    solver = ResolvedAcceleration((0.05,), exact_projectors=False)
    total, N_i = np.zeros(N), np.eye(N)
    for J, v in asked:
        reduced = J @ N_i
        inverse = damped_inverse(reduced, 0.05)
        total, N_i = total + inverse @ (v - J @ total), N_i @ (np.eye(N) - inverse @ reduced)
    np.testing.assert_allclose(solved(solver, asked), total, atol=1e-9)


def test_levels_below_leave_those_above_alone_and_are_optimal_in_what_is_left():
    rng = np.random.default_rng(5)
    asked, W = tasks(rng, [3, 2, 6]), positive_definite(rng)
    printed, exact = (ResolvedAcceleration((0.0, 0.0, 0.3), exact_projectors=exact) for exact in (False, True))
    leaky = ResolvedAcceleration((0.3,), exact_projectors=False)
    for solver in (printed, exact, leaky):
        solver.weight = W
    x = solved(exact, asked)
    for A, b in asked[:2]:
        np.testing.assert_allclose(A @ x, b, atol=1e-9)
    null_space = np.linalg.svd(np.vstack([A for A, _ in asked[:2]]))[2][5:].T
    assert stationary(objective(*asked[2], 0.3, W, np.zeros(N)), x, null_space)
    # Without damping above, the papers' projectors are exact too; with it, they leak.
    np.testing.assert_allclose(solved(printed, asked), x, atol=1e-8)
    alone = solved(leaky, asked[:1])
    assert np.abs(asked[0][0] @ (solved(leaky, asked) - alone)).max() > 1e-2


def test_exact_projectors_keep_what_a_damped_level_has_reached():
    rng = np.random.default_rng(6)
    asked = tasks(rng, [3, 5])
    solver = ResolvedAcceleration((0.3, 0.1))
    above = asked[0][0] @ solved(solver, asked[:1])
    np.testing.assert_allclose(asked[0][0] @ solved(solver, asked), above, atol=1e-9)


def test_a_level_that_repeats_one_above_is_left_without_anything():
    rng = np.random.default_rng(7)
    ((A, b),) = tasks(rng, [4])
    solver = ResolvedAcceleration((0.0, 0.1))
    np.testing.assert_allclose(solved(solver, [(A, b), (A, b + 1.0)]), solved(solver, [(A, b)]), atol=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_one_sided_penalties_are_those_that_the_answer_exceeds(seed):
    rng = np.random.default_rng(seed)
    asked, W = tasks(rng, [2, 6]), positive_definite(rng)
    C = np.vstack([np.eye(N), -np.eye(N), rng.standard_normal((3, N))])
    penalties = Penalties(C, rng.uniform(-0.1, 0.3, len(C)), rng.uniform(0.0, 1e3, len(C)))
    solver = ResolvedAcceleration((0.0, 0.3))
    solver.weight, solver.penalties = W, penalties
    x = solved(solver, asked)
    # The one convex problem that it is, solved by descent in the null space of the first level.
    (A, b), (B, d) = asked
    start, null_space = np.linalg.lstsq(A, b)[0], np.linalg.svd(A)[2][2:].T

    def cost(x):
        excess = np.maximum(penalties.C @ x - penalties.targets, 0.0)
        return np.sum((B @ x - d) ** 2) + 0.09 * (x @ W @ x + penalties.weights @ excess**2)

    def slope(x):
        excess = np.maximum(penalties.C @ x - penalties.targets, 0.0)
        return 2.0 * (B.T @ (B @ x - d) + 0.09 * (W @ x + penalties.C.T @ (penalties.weights * excess)))

    best = minimize(
        lambda z: cost(start + null_space @ z),
        np.zeros(N - 2),
        jac=lambda z: null_space.T @ slope(start + null_space @ z),
        method="BFGS",
        options={"gtol": 1e-10, "maxiter": 2000},
    )
    np.testing.assert_allclose(A @ x, b, atol=1e-7)
    assert cost(x) <= best.fun * (1.0 + 1e-6)
    # Asked again, it starts from what it knows, and answers the same.
    np.testing.assert_allclose(solved(solver, asked), x, atol=1e-9)


def test_inequalities_are_refused():
    rows = Rows("range", "rad", np.eye(N), np.zeros(N), np.ones(N))
    with pytest.raises(ValueError, match="range: resolved acceleration knows no inequalities"):
        ResolvedAcceleration().solve([Level.stack("range", [rows], N)])
