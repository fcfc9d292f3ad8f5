"""A hand that supports: where its contact is, how much it may bear, and which friction is relied upon."""

from types import SimpleNamespace

import numpy as np
import pytest

from sot.behaviours.manipulation.hand_support import MAX_SLIP, PROBING_SHARE, HandSupport
from sot.control.contact import Contact
from sot.robots.robot import Robot
from sot.robots.things import Thing

LEG = 0.6


class Tick:
    """The palm is where it is told to be; its axes are the world's."""

    def __init__(self, place):
        self.place = np.array(place, dtype=float)

    def surface_axes(self, surface):
        return SimpleNamespace(translation=self.place, rotation=np.eye(3))

    def relative_frame(self, surface, on):
        return SimpleNamespace(position=self.place)


@pytest.fixture
def hand():
    table = Thing.load("table", placement=(0.6, 0.0, 0.0))
    palm = Robot.load("hrp2").surface("right_palm")
    contact = Contact(palm, table.surface("top"), friction=0.5, least=20.0, most=200.0)
    contact.mode = "off"
    return HandSupport(contact, LEG)


def test_the_contact_is_made_where_the_touch_was_and_bears_little_at_first(hand):
    hand.settle(Tick([0.5, 0.1, 0.68]))
    assert hand.height == pytest.approx(-0.02)
    assert hand.contact.on.name == "table/top"
    np.testing.assert_allclose(hand.contact.on.axes.translation[2], 0.68)
    assert hand.contact.most == pytest.approx(PROBING_SHARE * 200.0)
    hand.trust(1.0)
    assert hand.contact.most == 200.0


def test_a_hand_that_is_not_felt_carries_nothing(hand):
    assert hand.carries(12.0) and not hand.carries(8.0)


def test_friction_that_has_failed_is_not_relied_upon_again_and_the_second_slip_ends_it(hand):
    hand.settle(Tick([0.5, 0.1, 0.7]))
    hand.contact.mode = "fixed"
    hand.observe(Tick([0.5, 0.1, 0.7]))
    hand.observe(Tick([0.5 + 0.9 * MAX_SLIP * LEG, 0.1, 0.7]))
    assert (hand.slips, hand.contact.friction) == (0, 0.5)
    hand.observe(Tick([0.5 + 1.1 * MAX_SLIP * LEG, 0.1, 0.69]))
    assert (hand.slips, hand.contact.friction) == (1, 0.25) and not hand.is_given_up
    hand.observe(Tick([0.5 + 2.3 * MAX_SLIP * LEG, 0.1, 0.69]))
    assert hand.is_given_up
