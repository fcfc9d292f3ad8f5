"""Hands that push let go of what runs ahead, and push again when its path has caught up."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

from sot.behaviours.manipulation.guide import fixed_reference
from sot.behaviours.manipulation.pushes import MAX_LEAD, Pushes
from sot.motion.objects.events import SurfaceName, SurfacePair

PAIR = SurfacePair(SurfaceName("robot", "right_hand"), SurfaceName("door", "front"))
ARM = 0.7


class Touching:
    """A hand on a door that turns about the vertical axis, at an arm along -y; its front faces -x."""

    def __init__(self):
        self.mode, self.load, self.on = "fixed", 1.0, "front"

    def motion(self, tick):
        return SimpleNamespace(position=tick.rotation @ [0.0, -ARM, 1.0])


def tick(angle):
    turn = pin.exp3(np.array([0.0, 0.0, angle]))
    axes = turn @ pin.exp3(np.array([0.0, -0.5 * np.pi, 0.0]))  # z out of the front
    body = SimpleNamespace(position=np.zeros(3), rotation=turn)
    return SimpleNamespace(
        t=0.0, rotation=turn, frame=lambda name: body, surface_axes=lambda on: SimpleNamespace(rotation=axes)
    )


def pushes(planned=0.0, leg=1.0):
    contact = Touching()
    path = fixed_reference(pin.SE3(pin.exp3(np.array([0.0, 0.0, planned])), np.zeros(3)))
    return contact, Pushes({PAIR: contact}, {"door": path}, ["door"], leg)


def never(contact):
    return False


def always(contact):
    return True


@pytest.mark.parametrize(("ahead", "lets_go"), [(-0.1, False), (0.8, False), (1.2, True)])
def test_a_door_that_is_ahead_of_its_path_is_let_go(ahead, lets_go):
    contact, made = pushes(planned=0.3)
    angle = 0.3 + ahead * MAX_LEAD / ARM
    assert made.lead(tick(angle), [PAIR], always) == ([contact] if lets_go else [])


def test_it_is_pushed_again_when_its_path_has_caught_up_and_the_hand_feels_it():
    contact, made = pushes()
    contact.mode, contact.load = "off", 0.0
    assert made.lead(tick(2.0 * MAX_LEAD / ARM), [PAIR], always) == []
    assert made.lead(tick(0.0), [PAIR], never) == []
    assert made.lead(tick(0.0), [PAIR], always) == [contact]


def test_nothing_changes_while_a_load_ramps_or_the_demonstration_has_no_contact():
    contact, made = pushes()
    assert made.lead(tick(0.1), [], always) == []
    contact.load = 0.5
    assert made.lead(tick(0.1), [PAIR], always) == []


def test_a_free_thing_is_not_pushed():
    _, made = pushes()
    assert Pushes({PAIR: Touching()}, {}, [], 1.0).lead(tick(0.1), [PAIR], always) == []
    assert made.lead(tick(0.1), [PAIR], always)
