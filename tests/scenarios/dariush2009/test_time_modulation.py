"""A slower clock keeps velocity limits and the shape of a motion; another keeps its duration as well."""

import numpy as np
import pytest

from scenarios.dariush2009.time_modulation import duration_keeping_times, modulated_times, modulation_factors

PERIOD, LIMITS = 0.01, np.array([1.0, 2.0])
TIMES = np.arange(0.0, 3.0, PERIOD)
MOTION = np.column_stack([0.5 * np.sin(1.0 * TIMES), 0.5 * np.exp(-(((TIMES - 1.5) / 0.15) ** 2))])


def speeds(times):
    return np.abs(np.diff(MOTION, axis=0)) / np.diff(times)[:, None] / LIMITS


def test_what_is_too_fast_takes_longer():
    factors = modulation_factors(MOTION, PERIOD, LIMITS)
    assert factors.max() > 1.1
    times = modulated_times(factors, PERIOD)
    assert speeds(times).max() <= 1.0 + 1e-9 and times[-1] > TIMES[-1]
    slow = factors < 1.0
    np.testing.assert_allclose(np.diff(times)[slow], PERIOD)


def test_the_duration_can_be_kept():
    factors = modulation_factors(MOTION, PERIOD, LIMITS)
    times = duration_keeping_times(factors, PERIOD)
    assert times is not None and times[-1] == pytest.approx(TIMES[-1], rel=1e-9)
    assert speeds(times).max() <= 1.0 + 1e-9 and np.diff(times).min() > 0.0


def test_not_if_the_whole_motion_is_too_fast():
    assert duration_keeping_times(modulation_factors(5.0 * MOTION, PERIOD, 0.3 * LIMITS), PERIOD) is None
