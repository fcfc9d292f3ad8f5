"""Sines in samples, and pendulums fitted to responses, noisy ones and outliers among them."""

import numpy as np
import pytest

from sot.errors import InputError
from sot.servo.pendulum import Pendulum
from sot.servo.pendulum_fit import FrequencyResponse, fit_errors, fit_pendulum, sine_coefficients

FREQUENCIES = np.geomspace(0.2, 10.0, 19)
PENDULUMS = {
    "as on two feet": Pendulum(58.0, 0.78, 4900.0, 60.0, 8.0, 6.0, 0.003, 0.012),
    "as on one foot": Pendulum(58.0, 0.78, 1900.0, 25.0, 8.0, 7.0, 0.001, 0.008),
    "bending at 9 Hz": Pendulum(58.0, 0.78, 1900.0, 25.0, 7.0, 7.5, 0.0, 0.009, 0.5, 57.0, 0.4),
    "stiff": Pendulum(33.0, 0.6, 14000.0, 90.0, 3.0, 2.0, 0.006, 0.005),
}


def test_a_sine_is_found_under_an_offset_and_a_drift():
    time = np.arange(600) / 200.0
    values = 0.4 * np.sin(2.0 * np.pi * 1.7 * time + 0.6) + 0.3 - 0.05 * time
    found = sine_coefficients(time, values, 1.7)
    assert abs(found) == pytest.approx(0.4)
    assert np.angle(found) == pytest.approx(0.6)


def test_a_sine_is_found_beside_an_oscillation_that_dies_out_slowly_at_nearly_its_frequency():
    pendulum = Pendulum(33.0, 0.65, 636.0, 5.75, 3.5)
    frequency = 1.03 * pendulum.natural_frequency / (2.0 * np.pi)
    time = np.arange(1.0, 8.0, 0.005)
    dying = 0.7 * np.real(np.exp(1.05 * pendulum.pole * time + 0.5j))  # a pole that is not quite right, either
    noise = 0.01 * np.random.default_rng(0).standard_normal(len(time))
    values = np.imag((2.0 - 1.0j) * np.exp(2j * np.pi * frequency * time)) + dying + noise
    known = abs(sine_coefficients(time, values, frequency, pendulum.pole) - (2.0 - 1.0j))
    assert known < 0.01 * abs(2.0 - 1.0j)
    assert known < 0.2 * abs(sine_coefficients(time[-400:], values[-400:], frequency) - (2.0 - 1.0j))


@pytest.mark.parametrize("name", PENDULUMS)
def test_an_exact_response_gives_the_pendulum_back(name):
    pendulum = PENDULUMS[name]
    found = fit_pendulum(FrequencyResponse(FREQUENCIES, pendulum.response(FREQUENCIES)), pendulum.mass, pendulum.length)
    assert found.natural_frequency == pytest.approx(pendulum.natural_frequency, rel=1e-4)
    assert found.damping_ratio == pytest.approx(pendulum.damping_ratio, rel=1e-3)
    assert found.inertia == pytest.approx(pendulum.inertia, rel=1e-2)
    assert found.delay == pytest.approx(pendulum.delay, abs=1e-4)


@pytest.mark.parametrize("name", PENDULUMS)
def test_noise_and_an_outlier_do_little(name):
    pendulum, random = PENDULUMS[name], np.random.default_rng(3)
    noise = 0.04 * (random.standard_normal(19) + 1j * random.standard_normal(19))
    value = pendulum.response(FREQUENCIES) * np.exp(noise)
    value[4] *= 3.0
    found = fit_pendulum(FrequencyResponse(FREQUENCIES, value), pendulum.mass, pendulum.length)
    assert found.natural_frequency == pytest.approx(pendulum.natural_frequency, rel=0.02)
    assert found.damping_ratio == pytest.approx(pendulum.damping_ratio, rel=0.25)
    assert fit_errors(found, FrequencyResponse(FREQUENCIES, value)).gain_db > 8.0


def test_too_little_is_refused():
    with pytest.raises(InputError, match="6 frequencies or more"):
        fit_pendulum(FrequencyResponse(FREQUENCIES[:3], np.ones(3, dtype=complex)), 58.0, 0.78)
    with pytest.raises(InputError, match="each with a response"):
        fit_pendulum(FrequencyResponse(FREQUENCIES, np.full(19, np.nan + 0j)), 58.0, 0.78)
