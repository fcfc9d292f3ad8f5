"""How far hands that press on things shift the centre of mass: as far as their contacts carry."""

from types import SimpleNamespace

import numpy as np
import pytest

from sot.behaviours.manipulation.hand_shift import shift_of_hands
from sot.gravity import GRAVITY
from sot.motion.objects.events import SurfaceName, SurfacePair

HAND = SurfacePair(SurfaceName("robot", "right_hand"), SurfaceName("door", "front"))
FOOT = SurfacePair(SurfaceName("robot", "left_foot"), SurfaceName("world", "floor"))
PLACES = {"right_hand": np.array([0.4, 0.0, 1.0]), "left_foot": np.zeros(3)}
FACING_BACK = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])  # z is -x


def shift(load, force=60.0):
    tick = SimpleNamespace(
        mass=60.0,
        frame=lambda point: SimpleNamespace(position=PLACES[point]),
        surface_axes=lambda surface: SimpleNamespace(rotation=FACING_BACK),
    )
    contacts = {
        HAND: SimpleNamespace(name="hand", point="right_hand", on="front", load=load),
        FOOT: SimpleNamespace(name="foot", point="left_foot", on="floor", load=1.0),
    }
    return shift_of_hands(tick, [HAND, FOOT], contacts, {"hand": force, "foot": 600.0})


def test_a_hand_that_is_pushed_back_is_answered_by_leaning_forward():
    np.testing.assert_allclose(shift(1.0), [60.0 * 1.0 / (60.0 * GRAVITY), 0.0], atol=1e-12)


@pytest.mark.parametrize("load", [0.0, 0.3])
def test_a_bump_counts_as_much_as_the_contact_carries(load):
    np.testing.assert_allclose(shift(load), load * shift(1.0), atol=1e-12)
