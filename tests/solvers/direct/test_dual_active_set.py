"""The dual method finds the rows that quadprog finds, and says so where there are none."""

import numpy as np
import pytest
import quadprog

from solvers.direct.dual_active_set import active_rows

NONE_EXPECTED = np.zeros(0, np.int64)


def program(seed, size=12, rows=60, equalities=3, spread=1.0):
    """A random program with a point that meets all rows, and a Hessian of some spread."""
    chance = np.random.default_rng(seed)
    A = chance.normal(size=(size, size)) * spread ** chance.uniform(-1.0, 1.0, size)
    C, inside = chance.normal(size=(rows, size)), 0.3 * chance.normal(size=size)
    bounds = C @ inside - np.where(np.arange(rows) < equalities, 0.0, chance.uniform(0.0, 0.5, rows))
    return A @ A.T + 1e-3 * np.eye(size), 5.0 * chance.normal(size=size), C, bounds, equalities


@pytest.mark.parametrize("seed", range(40))
def test_the_tight_rows_are_quadprogs(seed):
    H, pull, C, bounds, equalities = program(seed, equalities=seed % 5, spread=1.0 + seed)
    rows, found = active_rows(H, pull, C, bounds, equalities, NONE_EXPECTED)
    *_, wanted = quadprog.solve_qp(H, pull, C.T, bounds, equalities)
    assert found
    assert sorted(rows.tolist()) == sorted((wanted[wanted > 0] - 1).tolist())


@pytest.mark.parametrize("seed", range(20))
def test_what_is_expected_changes_nothing_but_the_way(seed):
    """The right rows, some of them, and wrong ones."""
    H, pull, C, bounds, equalities = program(seed, equalities=seed % 5)
    wanted, _ = active_rows(H, pull, C, bounds, equalities, NONE_EXPECTED)
    right = wanted[wanted >= equalities]
    chance = np.random.default_rng(seed)
    wrong = chance.choice(np.arange(equalities, len(C)), 12, replace=False)
    for expected in (right, right[::2], wrong, np.union1d(right, wrong)):
        rows, found = active_rows(H, pull, C, bounds, equalities, expected)
        assert found
        assert sorted(rows.tolist()) == sorted(wanted.tolist())


def test_rows_that_contradict_each_other_have_no_active_set():
    H, pull, C, bounds, equalities = program(1)
    C[-1], bounds[-1] = -C[-2], -bounds[-2] + 1.0
    assert not active_rows(H, pull, C, bounds, equalities, NONE_EXPECTED)[1]


def test_an_objective_without_a_least_value_has_none():
    H, pull, C, bounds, equalities = program(2)
    assert not active_rows(-H, pull, C, bounds, equalities, NONE_EXPECTED)[1]
