"""Kim (14) as printed is why `JointBounds` has a form of its own: one fails from where the other holds."""

import numpy as np
import pytest

from scenarios.kimoh2013.printed_bounds import PrintedBounds, compare_forms


@pytest.mark.parametrize("period", [0.001, 0.005])
def test_as_printed_leaves_nothing_or_leaves_the_range_and_the_viable_form_does_not(period):
    figures = compare_forms(period, joints=200)
    printed, viable = figures["as printed"], figures["viable"]
    assert printed["driven"] > 0.9 and printed["random"] > 0.5
    assert printed["left"] > 0.9 and printed["beyond_rad"] > 0.001
    assert printed["needed"] > 1.5
    assert viable["driven"] == viable["random"] == viable["left"] == 0.0
    assert viable["beyond_rad"] < 1e-9 and viable["needed"] <= 1.0 + 1e-9


@pytest.mark.parametrize("period", [1e-4, 1e-3, 1e-2])
def test_who_rides_the_printed_bound_is_left_with_nothing_at_any_period(period):
    """The module's derivation."""
    a, speed = np.full(1, 30.0), np.full(1, 1.0)
    bounds = PrintedBounds(np.full(1, -9.0), np.zeros(1), np.full(1, 9.0), a)
    at = -(speed**2) / (2.0 * a)
    low, high = bounds(at, speed, period)
    assert low <= high and high == pytest.approx(0.0, abs=1e-9)  # w is the bound of the speed there
    low, high = bounds(at + speed * period, speed, period)
    assert high < low == -a
    assert (speed + high * period) ** 2 == pytest.approx(speed**2 - 2.0 * a * speed * period)


def test_as_printed_keeps_speed_and_acceleration_where_it_leaves_something():
    rng = np.random.default_rng(0)
    velocity, a = rng.uniform(1.0, 10.0, 500), rng.uniform(10.0, 100.0, 500)
    bounds = PrintedBounds(np.full(500, -1.0), np.ones(500), velocity, a)
    v = rng.uniform(-1.0, 1.0, 500) * velocity
    low, high = bounds(rng.uniform(-1.0, 1.0, 500), v, 0.001)
    some = low <= high
    assert np.mean(some) > 0.5
    assert np.all(low[some] >= -a[some]) and np.all(high[some] <= a[some])
    assert np.all(np.abs(v + 0.001 * high)[some] <= velocity[some] + 1e-9)


def test_outside_the_range_it_says_nothing():
    bounds = PrintedBounds(np.full(1, -1.0), np.ones(1), np.ones(1), np.ones(1))
    assert np.isnan(bounds(np.full(1, 1.1), np.zeros(1), 0.001)[1])
    assert np.isnan(bounds(np.full(1, -1.1), np.zeros(1), 0.001)[0])
