"""Flights of a dancer are found, and nothing else is taken for one."""

from dataclasses import replace

import numpy as np
import pytest

from sot.motion.feet.flight import find_flights
from sot.motion.feet.stance import human_on_time_line
from sot.motion.human.human import Human
from tests.sot.motion.human.humans import dancer, walker


def leaping(*flown: tuple[float, float]) -> Human:
    """The dancer, in free fall between such times [s]."""
    human = dancer(4.0)
    t = human.times
    height = sum(np.where((t > a) & (t < b), 0.5 * 9.81 * (t - a) * (b - t), 0.0) for a, b in flown)
    return replace(human, points={name: place + height[:, None] * [0, 0, 1] for name, place in human.points.items()})


def test_leaps_are_flights():
    found = find_flights(human_on_time_line(leaping((1.0, 1.5), (2.5, 2.8)), 50.0))
    assert [(flight.start, flight.end) for flight in found] == [
        pytest.approx((1.0, 1.5), abs=0.06),
        pytest.approx((2.5, 2.8), abs=0.06),
    ]


@pytest.mark.parametrize("human", [dancer(3.0), walker(), leaping((1.0, 1.04))], ids=["dance", "walk", "bounce"])
def test_feet_that_stand_in_turn_are_none(human):
    assert find_flights(human_on_time_line(human, 50.0)) == ()
