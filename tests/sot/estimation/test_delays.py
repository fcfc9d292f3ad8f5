"""Readings behind filters: what the filters were fed with is found again, and carried on to now."""

import numpy as np
import pytest

from sot.estimation.delays import PromptReadings

PERIOD = 0.002
LAGS = np.array([0.0, 0.001, 0.004])


def fed(t: float) -> np.ndarray:
    return np.array([np.sin(9.0 * t), np.cos(7.0 * t), 3.0 * t**2])


def followed(steps: int) -> tuple[PromptReadings, np.ndarray]:
    """Readings of filters of first order, the first of which have settled, and the last of them."""
    prompt, filtered = PromptReadings(LAGS), fed(0.0)
    shares = np.array([1.0, *(1.0 - np.exp(-PERIOD / LAGS[1:]))])
    for k in range(steps):
        filtered = filtered + (shares * (fed(k * PERIOD) - filtered) if k else 0.0)
        prompt.update(filtered, PERIOD if k else 0.0)
    return prompt, filtered


def test_what_a_filter_was_fed_with_is_found_again():
    prompt, reading = followed(50)
    t = 49 * PERIOD
    assert prompt.value == pytest.approx(fed(t), abs=1e-12)
    assert prompt.slope == pytest.approx((fed(t) - fed(t - PERIOD)) / PERIOD, abs=1e-9)
    assert np.abs(reading - fed(t))[1:].min() > 1e-3  # the filters did something


def test_it_is_carried_on_to_now():
    prompt, _ = followed(50)
    t, age = 49 * PERIOD, 0.002
    assert prompt.at(age) == pytest.approx(fed(t + age), abs=7e-4)
    assert np.abs(prompt.value - fed(t + age)).min() > 1e-3


def test_the_first_readings_are_their_own_past():
    prompt, reading = followed(1)
    assert np.array_equal(prompt.at(0.01), reading)
