"""A cart that is pushed."""

import pytest

from scenarios.otani2017.carrying import cart as study
from scenarios.replay import Replay
from sot.robots.things.thing import Thing


def test_a_cart_rolls_ahead_against_a_drag() -> None:
    cart = Thing.load("cart")
    assert cart.nv == 1 and not cart.is_free
    assert cart.mass == pytest.approx(10.0)
    assert cart.friction[0] == pytest.approx(50.0)


@pytest.mark.slow
def test_a_cart_is_pushed_a_little(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "WAY_M", 0.5)
    done = study.perform(Replay("", "hrp2", rate=500.0), lambda what, share: None)
    figures = study.cart_figures(done)["cart"]
    assert done.danced.run.fell_at_s is None and not done.schedule.failure
    assert abs(figures["pushed_m"] - 0.5) < 0.02
    assert 45.0 < figures["hands_mean_n"] < 55.0
