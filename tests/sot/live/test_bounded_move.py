"""A bounded step is that of a quadratic programme."""

import numpy as np
import pytest
import quadprog

from sot.live.bounded_move import bounded_move
from sot.motion.body.retarget import MAX_STEP


@pytest.mark.parametrize("size", [2, 5, 20])
def test_it_is_that_of_a_quadratic_programme(size):
    chance = np.random.default_rng(size)
    for _ in range(30):
        J = chance.normal(size=(size + 3, size))
        H, g = J.T @ J + 0.01 * np.eye(size), chance.normal(size=size)
        lower, upper = -chance.uniform(0.0, 0.3, size), chance.uniform(0.0, 0.3, size)
        x = np.zeros(size)
        bounded_move(x, H, g, lower, upper)
        C = np.hstack([np.eye(size), -np.eye(size)])
        wanted = quadprog.solve_qp(H, -g, C, np.concatenate([lower, -upper]))[0]
        assert np.abs(wanted).max() < MAX_STEP
        np.testing.assert_allclose(x, wanted, atol=1e-8)


def test_a_large_step_is_shortened():
    x = np.zeros(2)
    bounded_move(x, np.eye(2), np.array([-10.0, 0.0]), np.full(2, -np.inf), np.full(2, np.inf))
    assert x == pytest.approx([MAX_STEP, 0.0])
