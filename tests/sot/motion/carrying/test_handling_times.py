"""When a box that is carried is handled."""

import numpy as np
import pytest

from sot.motion.carrying.handling_times import HandlingTimes

UNIT = 0.25


@pytest.fixture
def times() -> HandlingTimes:
    return HandlingTimes.of(begin=UNIT, arrived=20.0, raising=6.0, unit=UNIT)


def test_what_is_done_with_a_box_is_in_order(times: HandlingTimes) -> None:
    order = [
        *(times.begin, times.gripped, times.lifted, times.raised, times.arrived),
        *(times.placed, times.opening, times.released, times.end),
    ]
    assert (np.diff(order) > 0.0).all()
    assert times.raised - times.lifted == pytest.approx(times.placed - times.arrived)
    assert times.knots()[0] == 0.0 and times.knots()[-1] >= times.end


def test_hands_close_only_beside_the_box_and_carry_it_only_while_they_are_on_it(times: HandlingTimes) -> None:
    t = times.knots()
    reach, close = times.reach_share(t), times.close_share(t)
    up, carried = times.raised_share(t), times.carried_share(t, times.raised)
    for share in (reach, close, up, carried):
        assert share[0] == 0.0 and share[-1] == pytest.approx(0.0) and share.max() == pytest.approx(1.0)
    assert (reach[close > 0.0] == pytest.approx(1.0)) and (close[carried > 0.0] == pytest.approx(1.0))
    assert close[up > 1e-9] == pytest.approx(1.0)
