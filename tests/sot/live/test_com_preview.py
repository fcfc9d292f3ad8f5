"""The plan of the centre of mass: well inside the support, and at rest where it is asked for."""

import numpy as np
import pytest

from sot.gravity import GRAVITY
from sot.live.com_preview import KNOT_PERIOD, ComPreview
from sot.polygon import Polygon

SUPPORT = Polygon.hull(np.array([[0.12, 0.17], [-0.1, 0.17], [-0.1, -0.17], [0.12, -0.17]]))
SOLE = np.array([0.22, 0.13])
HEIGHT = 0.8


def test_it_goes_to_the_wanted_place_and_stays():
    preview = ComPreview(SUPPORT, SOLE, np.zeros(2), HEIGHT)
    for _ in range(150):
        preview.plan(np.array([0.02, -0.05]))
        preview.advance(KNOT_PERIOD)
    assert preview.c == pytest.approx([0.02, -0.05], abs=1e-3)
    assert np.abs(preview.dc).max() < 1e-3


def test_the_zero_moment_point_stays_well_inside_whatever_is_wanted():
    preview, chance = ComPreview(SUPPORT, SOLE, np.zeros(2), HEIGHT), np.random.default_rng(0)
    wanted = np.zeros(2)
    for k in range(400):
        if k % 15 == 0:
            wanted = chance.uniform(-1.0, 1.0, 2)
        preview.plan(wanted)
        preview.advance(KNOT_PERIOD)
        zmp = preview.c - HEIGHT / GRAVITY * preview.ddc
        assert SUPPORT.margin(zmp) > 0.05
        assert SUPPORT.margin(preview.c + np.sqrt(HEIGHT / GRAVITY) * preview.dc) > 0.05


def test_a_small_support_still_has_room():
    tiny = Polygon.hull(0.2 * np.array([[0.12, 0.17], [-0.1, 0.17], [-0.1, -0.17], [0.12, -0.17]]))
    preview = ComPreview(tiny, SOLE, np.zeros(2), HEIGHT)
    preview.plan(np.ones(2))
    preview.advance(KNOT_PERIOD)
    assert np.isfinite(preview.c).all()


def test_a_known_future_is_met_in_time():
    def errors(seen):
        """Distance from a place that is wanted from 0.6 s on, then and there, if it is known so long before."""
        preview = ComPreview(SUPPORT, SOLE, np.zeros(2), HEIGHT)
        there = np.array([0.02, 0.05])
        for k in range(30):
            left = 0.6 - k * KNOT_PERIOD
            known = [(left - 0.02, np.zeros(2)), (left, there)] if left <= seen else []
            preview.plan(np.zeros(2), known)
            preview.advance(KNOT_PERIOD)
        return np.linalg.norm(preview.c - there)

    assert errors(0.4) < 0.6 * errors(0.0)
