"""Bias, lag, noise and rounding, one by one."""

import numpy as np
import pytest

from sim.hardware.sensor_errors import ErrorModel
from sot.hardware.sensors import Channel


def model(seed: int = 0, **channel: float) -> ErrorModel:
    return ErrorModel(Channel(**channel), 3, np.random.default_rng(seed))


def test_an_ideal_sensor_says_what_is():
    value = np.array([0.1, -0.2, 0.3])
    np.testing.assert_array_equal(model()(value, 0.001), value)


def test_a_bias_has_its_size_and_its_sign_stays():
    errors = [model(seed, bias=0.5) for seed in range(8)]
    first = np.array([error(np.zeros(3), 0.0) for error in errors])
    np.testing.assert_array_equal(np.abs(first), 0.5)
    assert {-0.5, 0.5} == set(first.ravel().tolist())
    np.testing.assert_array_equal(first, [error(np.zeros(3), 0.001) for error in errors])


def test_a_lag_is_of_first_order_whatever_the_rate():
    for rate in (1000.0, 100.0):
        lagging = model(lag=0.05)
        lagging(np.zeros(3), 0.0)
        for k in range(1, round(0.1 * rate) + 1):
            reading = lagging(np.ones(3), 1.0 / rate)
            np.testing.assert_allclose(reading, 1.0 - np.exp(-k / rate / 0.05))


def test_noise_has_its_deviation_and_belongs_to_the_seed():
    def readings(seed: int) -> np.ndarray:
        noisy = model(seed, noise=0.2)
        return np.array([noisy(np.ones(3), 0.001) for _ in range(2000)])

    assert np.std(readings(1) - 1.0) == pytest.approx(0.2, rel=0.03)
    np.testing.assert_array_equal(readings(1), readings(1))
    assert np.abs(readings(1) - readings(2)).max() > 0.1


def test_readings_are_whole_steps():
    np.testing.assert_allclose(model(step=0.25)(np.array([0.1, 0.15, -0.9]), 0.001), [0.0, 0.25, -1.0])
