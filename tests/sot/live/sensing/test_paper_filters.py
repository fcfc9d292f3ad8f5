"""How late filters are, against what the mathematics says."""

import numpy as np
import pytest

from sot.live.sensing.one_euro import OneEuro
from sot.live.sensing.paper_filters import CardinalSpline, CausalButterworth, measured_delay


@pytest.mark.parametrize("rate", [10.0, 15.0, 30.0])
def test_a_cardinal_spline_costs_two_periods(rate):
    assert measured_delay(CardinalSpline(), rate) == pytest.approx(2.0 / rate, abs=2e-3)


def test_a_cardinal_spline_goes_through_its_samples_and_is_exact_on_lines():
    spline = CardinalSpline()
    for k in range(6):
        spline(np.array([2.0 * k]))
    assert spline.between(0.0) == pytest.approx([6.0])
    assert spline.between(0.25) == pytest.approx([6.5])
    assert spline.between(1.0) == pytest.approx([8.0])


@pytest.mark.parametrize(("cutoff", "delay"), [(2.0, 0.113), (3.0, 0.075), (5.0, 0.045)])
def test_a_butterworth_of_second_order_costs_its_group_delay(cutoff, delay):
    """√2 / (2π f) for slow signals."""
    assert measured_delay(CausalButterworth(cutoff, 100.0), 100.0) == pytest.approx(delay, rel=0.1)


def test_one_euro_is_faster_in_motion_and_as_calm_at_rest():
    smooth = OneEuro()
    assert measured_delay(lambda x: smooth(x[None], 0.02)[0], 50.0) < 0.03
    chance, still = np.random.default_rng(0), OneEuro()
    out = np.array([still(0.01 * chance.standard_normal((1, 3)), 1.0 / 30.0) for _ in range(600)])
    assert out[100:].std() < 0.008
