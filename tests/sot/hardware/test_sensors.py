"""Sensors by name, and their numbers."""

import numpy as np
import pytest

from sot.errors import InputError
from sot.hardware.sensors import SENSOR_PRESETS, Channel, Sensors, sensor_preset, white_noise


@pytest.mark.parametrize("bad", [{"noise": -1.0}, {"bias": np.nan}, {"lag": np.inf}, {"step": -0.1}])
def test_bad_numbers(bad):
    with pytest.raises(InputError, match=f"sensor {next(iter(bad))}="):
        Channel(**bad)


def test_presets_have_names_and_a_seed():
    assert sensor_preset("ideal") == Sensors()
    assert all(sensor_preset(name, seed=3).seed == 3 for name in SENSOR_PRESETS)
    with pytest.raises(InputError, match="unknown sensors 'abacus'"):
        sensor_preset("abacus")


def test_white_noise_of_a_first_order_filter():
    """White noise through a first-order filter has the standard deviation that its density and bandwidth say."""
    rng, density, bandwidth, rate = np.random.default_rng(0), 0.01, 20.0, 20000.0
    share, filtered, out = 1.0 - np.exp(-2 * np.pi * bandwidth / rate), 0.0, []
    for value in density * np.sqrt(rate / 2.0) * rng.standard_normal(400_000):
        filtered += share * (value - filtered)
        out.append(filtered)
    assert np.std(out) == pytest.approx(white_noise(density, bandwidth), rel=0.03)
