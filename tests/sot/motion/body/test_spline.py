import numpy as np
import pytest

from sot.motion.body.spline import LimitedFit, Spline

PERIOD = 0.02


def wave(length=200, size=3):
    t = PERIOD * np.arange(length)
    window = np.sin(np.pi * t / t[-1])[:, None] ** 2
    return window * np.sin(np.outer(t, [3.0, 6.0, 11.0][:size]))


def fit(target, velocity, acceleration, steps=1, bound=10.0):
    size = target.shape[1]
    limit = np.full(size, bound)
    limited = LimitedFit(
        len(target),
        PERIOD,
        -limit,
        limit,
        np.full(size, velocity),
        np.full(size, acceleration),
        np.full(size, 1e4),
        1e-6,
    )
    spline = Spline(np.zeros((len(target) + 2, size)), PERIOD)
    J = np.broadcast_to(np.eye(size), (len(target), size, size)) / 0.05
    for _ in range(steps):
        spline, solution = limited.step(spline, J, (spline.knots - target) / 0.05)
        assert solution.solved
    return spline


def test_passes_through_its_values():
    values = wave()
    spline = Spline.through(values, PERIOD)
    np.testing.assert_allclose(spline.knots, values, atol=1e-12)
    np.testing.assert_allclose(spline(PERIOD * np.arange(len(values))), values, atol=1e-12)


def test_derivatives_are_those_of_the_values():
    spline, t, step = Spline.through(wave(), PERIOD), np.linspace(0.5, 3.0, 57), 1e-5
    for order in range(2):
        difference = (spline(t + step, order) - spline(t - step, order)) / (2 * step)
        np.testing.assert_allclose(spline(t, order + 1), difference, atol=1e-3)
    np.testing.assert_allclose(spline(PERIOD * np.arange(200), 1), spline.velocities, atol=1e-9)
    np.testing.assert_allclose(spline(PERIOD * np.arange(200), 2), spline.accelerations, atol=1e-7)


def test_fit_without_active_limits_reproduces_the_target():
    target = wave()
    np.testing.assert_allclose(fit(target, 1e3, 1e5).knots, target, atol=2e-3)


@pytest.mark.parametrize(
    ("bound", "velocity", "acceleration"), [(0.3, 100.0, 1e4), (10.0, 1.5, 1e4), (10.0, 100.0, 20.0)]
)
def test_limits_hold_between_knots_too(bound, velocity, acceleration):
    spline = fit(wave(), velocity, acceleration, bound=bound)
    t = np.linspace(0.0, spline.duration, 5000)
    reached = [np.abs(spline(t, order)).max() for order in range(3)]
    assert reached[0] < bound + 1e-6
    assert reached[1] < velocity + 1e-5
    assert reached[2] < acceleration + 1e-3
    assert any(value > 0.99 * limit for value, limit in zip(reached, (bound, velocity, acceleration), strict=True))


def test_starts_and_ends_at_rest():
    spline = fit(wave() + np.linspace(0.0, 0.5, 200)[:, None], 1.5, 20.0)
    for t in (0.0, spline.duration):
        np.testing.assert_allclose(spline(np.array([t]), 1), 0.0, atol=1e-9)
        np.testing.assert_allclose(spline(np.array([t]), 2), 0.0, atol=1e-9)
    np.testing.assert_allclose(spline.knots[0], 0.0, atol=1e-6)


def test_what_is_asked_of_second_derivatives_is_met():
    wanted = np.sin(2.0 * np.pi * np.arange(200) / 199.0)[:, None]
    still = Spline(np.zeros((202, 1)), PERIOD)
    limit = np.ones(1)
    fit = LimitedFit(200, PERIOD, -10.0 * limit, 10.0 * limit, 10.0 * limit, 100.0 * limit, 1e4 * limit, 1e-9)
    nothing, J = np.zeros((200, 1)), np.ones((200, 1, 1))
    bent, solution = fit.step(still, 1e-6 * J, nothing, acceleration_residuals=(still.accelerations - wanted, J))
    assert solution.solved
    np.testing.assert_allclose(bent.accelerations[5:-5], wanted[5:-5], atol=0.02)
