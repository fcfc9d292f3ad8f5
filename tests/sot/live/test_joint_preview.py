"""A coordinate that knows the future starts early, within its limits."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from sot.live.com_preview import KNOT_PERIOD
from sot.live.joint_preview import MAX_KNOTS, JointPreview

SPEED, ACCELERATION = np.array([3.0, 3.0, 1.0]), np.array([50.0, 6.0, 20.0])


def played(targets, horizon):
    """Coordinates (T, n) that go after targets (T, n), of which `horizon` [s] are known."""
    preview = JointPreview(SPEED, ACCELERATION, horizon)
    x, dx, way = targets[0].copy(), np.zeros(3), []
    for k in range(len(targets)):
        rows = np.minimum(k + np.arange(1, len(preview.times) + 1), len(targets) - 1)
        ddx = preview(x, dx, targets[rows])
        assert (np.abs(ddx) <= ACCELERATION + 1e-6).all()
        way.append(x)
        x, dx = x + KNOT_PERIOD * dx + 0.5 * KNOT_PERIOD**2 * ddx, dx + KNOT_PERIOD * ddx
        assert (np.abs(dx) <= SPEED + 1e-6).all()
    return np.array(way)


def test_a_jump_is_met_in_the_middle_of_the_way():
    targets = np.repeat([[0.0], [1.0]], 40, axis=0) * np.ones(3)
    late, early = (np.abs(played(targets, horizon) - targets).sum(axis=0) for horizon in (0.02, 0.4))
    assert (early < 0.65 * late).all()
    assert played(targets, 0.4)[40, 0] == pytest.approx(0.5, abs=0.1)


def test_what_can_be_followed_is_followed():
    t = KNOT_PERIOD * np.arange(100)
    targets = 0.2 * np.sin(3.0 * t)[:, None] * np.ones(3)
    assert np.abs(played(targets, 0.3) - targets)[10:].max() < 0.02


@pytest.mark.parametrize("seed", range(4))
def test_without_a_speed_limit_it_is_the_bounded_least_squares_answer(seed):
    chance = np.random.default_rng(seed)
    preview = JointPreview(np.full(3, 1e3), ACCELERATION, 0.4)
    x, dx = chance.normal(size=3), chance.normal(size=3)
    wanted = np.cumsum(0.3 * chance.normal(size=(MAX_KNOTS, 3)), axis=0)
    found = preview(x, dx, wanted)
    for k in range(3):
        cost = np.linalg.cholesky(preview._hessian[k] - preview._position[k].T @ preview._position[k]).T
        A = np.vstack([preview._position[k], cost])
        b = np.append(wanted[:, k] - x[k] - preview.times * dx[k], np.zeros(len(cost)))
        share = lsq_linear(A, b, (-1.0, 1.0), method="bvls", tol=1e-12).x[0]
        assert found[k] == pytest.approx(ACCELERATION[k] * share, rel=1e-5, abs=1e-5)


def test_a_horizon_of_one_knot_is_enough():
    assert np.isfinite(JointPreview(SPEED, ACCELERATION, 0.001)(np.zeros(3), np.zeros(3), np.ones((1, 3)))).all()
