"""Series of pushes are even in time, equal in strength, and come from all sides."""

import numpy as np
import pytest

from scenarios.inputs.disturbances import spaced_pushes


def test_spaced_pushes_are_even_and_come_from_all_sides():
    pushes = list(spaced_pushes(1.0, 4.0, 20, 8.0))
    assert [push.t for push in pushes] == pytest.approx(np.linspace(1.0, 4.0, 20))
    assert [push.impulse for push in pushes] == pytest.approx(20 * [8.0])
    directions = np.sort([push.direction for push in pushes])
    gaps = np.diff(directions, append=directions[0] + 2.0 * np.pi)
    assert gaps.min() > 0.0
    assert gaps.max() < np.pi / 4.0
