"""Stances of a foot out of contact phases."""

import pinocchio as pin
import pytest

from sot.motion.feet.contacts import Phase
from sot.motion.feet.footfalls import Footfalls


def place(x: float) -> pin.SE3:
    pose = pin.SE3.Identity()
    pose.translation[0] = x
    return pose


@pytest.fixture
def falls() -> Footfalls:
    a, b = place(0.0), place(0.3)
    phases = [
        Phase(0.0, 1.0, {"left": a, "right": a}),
        Phase(1.0, 1.5, {"left": a}),
        Phase(1.5, 2.0, {"left": a, "right": b}),
        Phase(2.0, 2.6, {"right": b}),
        Phase(2.6, 3.0, {"left": b, "right": b}),
    ]
    return Footfalls(phases, "right")


def test_phases_of_one_stance_become_one(falls):
    assert [(stance.start, stance.end) for stance in falls.stances] == [(0.0, 1.0), (1.5, 3.0)]
    assert [stance.pose.translation[0] for stance in falls.stances] == [0.0, 0.3]


def test_a_stance_knows_when_its_heel_rises(falls):
    a = place(0.0)
    both = {"left": a, "right": a}
    phases = [
        Phase(0.0, 1.0, both),
        Phase(1.0, 1.2, both, rising=("right",)),
        Phase(1.2, 1.5, {"left": a}),
        Phase(1.5, 2.0, both),
    ]
    found = Footfalls(phases, "right")
    assert [stance.rises for stance in found.stances] == [1.0, None]
    assert [stance.rises for stance in Footfalls(phases, "left").stances] == [None]
    assert [stance.rises for stance in found.with_step(0.4, 0.8, place(0.1)).stances] == [None, 1.0, None]


@pytest.mark.parametrize(("t", "begun"), [(-0.1, 0), (0.0, 1), (1.49, 1), (1.5, 2), (9.0, 2)])
def test_stances_begun(falls, t, begun):
    assert falls.count_begun(t) == begun


@pytest.mark.parametrize(("t", "x"), [(-1.0, 0.0), (0.5, 0.0), (1.2, 0.0), (1.3, 0.3), (2.0, 0.3), (9.0, 0.3)])
def test_the_stance_nearest_in_time(falls, t, x):
    assert falls.nearest_stance(t).pose.translation[0] == x


def test_a_foot_that_never_stands():
    assert Footfalls([Phase(0.0, 1.0, {})], "right").nearest_stance(0.5) is None


def test_a_step_in_between(falls):
    cut = falls.with_step(1.8, 2.1, place(0.5))
    assert [(stance.start, stance.end) for stance in cut.stances] == [(0.0, 1.0), (1.5, 1.8), (2.1, 3.0)]
    assert [stance.pose.translation[0] for stance in cut.stances] == [0.0, 0.3, 0.5]
    assert [cut.count_begun(t) for t in (1.7, 2.0, 2.2)] == [2, 2, 3]
    assert len(falls) == 2


@pytest.mark.parametrize(
    ("t", "before", "after"), [(0.5, None, 0.0), (1.0, 0.0, 1.5), (1.4, 0.0, 1.5), (2.0, 0.0, 1.5)]
)
def test_the_stances_around_a_swing(falls, t, before, after):
    assert tuple(stance and stance.start for stance in falls.stances_around(t)) == (before, after)
