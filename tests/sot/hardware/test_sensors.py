"""Sensors by name, and their numbers."""

import numpy as np
import pytest

from sot.errors import InputError
from sot.hardware.sensors import ENCODER_STEP, SENSOR_PRESETS, Channel, Sensors, sensor_preset, white_noise


@pytest.mark.parametrize("bad", [{"noise": -1.0}, {"bias": np.nan}, {"lag": np.inf}, {"step": -0.1}])
def test_bad_numbers(bad):
    with pytest.raises(InputError, match=f"sensor {next(iter(bad))}="):
        Channel(**bad)


def test_presets_have_names_and_a_seed():
    assert sensor_preset("ideal") == Sensors()
    assert all(sensor_preset(name, seed=3).seed == 3 for name in SENSOR_PRESETS)
    with pytest.raises(InputError, match="unknown sensors 'abacus'"):
        sensor_preset("abacus")


def test_a_data_sheet_in_its_own_units():
    """BMI088: 0.014 °/s/√Hz within 116 Hz, 190 µg/√Hz within 200 Hz, offsets of 1 °/s and 20 mg."""
    gyro, accelerometer = sensor_preset("bmi088").angular_velocity, sensor_preset("bmi088").specific_force
    assert np.rad2deg([gyro.noise, gyro.bias]) == pytest.approx([0.189, 1.0], abs=1e-3)
    assert np.array([accelerometer.noise, accelerometer.bias]) / 9.81 == pytest.approx([3.37e-3, 0.02], abs=1e-5)
    assert [1e3 * gyro.lag, 1e3 * accelerometer.lag] == pytest.approx([1.372, 0.796], abs=1e-3)


def test_rates_are_as_noisy_as_the_difference_of_two_rounded_angles():
    rng, channel = np.random.default_rng(0), sensor_preset("mti630").joint_velocity
    angle, rate = rng.uniform(0.0, 1.0, (2, 20_000))
    first, second = ENCODER_STEP * np.round(np.stack([angle, angle + 1e-3 * rate]) / ENCODER_STEP)
    assert np.std((second - first) / 1e-3 - rate) == pytest.approx(channel.noise, rel=0.05)


def test_white_noise_of_a_first_order_filter():
    """White noise through a first-order filter has the standard deviation that its density and bandwidth say."""
    rng, density, bandwidth, rate = np.random.default_rng(0), 0.01, 20.0, 20000.0
    share, filtered, out = 1.0 - np.exp(-2 * np.pi * bandwidth / rate), 0.0, []
    for value in density * np.sqrt(rate / 2.0) * rng.standard_normal(400_000):
        filtered += share * (value - filtered)
        out.append(filtered)
    assert np.std(out) == pytest.approx(white_noise(density, bandwidth), rel=0.03)
