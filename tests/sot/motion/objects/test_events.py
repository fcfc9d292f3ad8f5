"""The events that change contacts, and the sets of Otani's Algorithm 1 that follow from them."""

import pytest

from sot.errors import InputError
from sot.motion.objects import event_file
from sot.motion.objects.events import (
    ContactEvent,
    ContactPlan,
    SurfaceName,
    SurfacePair,
    simultaneous,
)

TRACKED = ("left_foot", "right_foot", "left_hand", "right_hand")


def pair(first, second):
    return SurfacePair.of(SurfaceName.parse(first), SurfaceName.parse(second))


FEET = tuple(pair(f"robot/{side}_foot", "world/floor") for side in ("left", "right"))
ON_STAND = pair("box/bottom", "world/stand")
LEFT, RIGHT = pair("robot/left_hand", "box/left"), pair("box/right", "robot/right_hand")


def lift():
    return ContactPlan(
        (*FEET, ON_STAND),
        (
            ContactEvent(2.0, "make", LEFT),
            ContactEvent(2.02, "make", RIGHT),
            ContactEvent(2.5, "break", ON_STAND),
            ContactEvent(4.0, "break", FEET[1]),
        ),
    )


def test_the_sets_follow_the_events():
    plan = lift()
    start, held, one_leg = (plan.sets_at(t, TRACKED) for t in (0.0, 3.0, 5.0))
    assert start.supports == {"left_foot", "right_foot"} and start.free == {"left_hand", "right_hand"}
    assert not start.holding and ON_STAND in start.pairs
    assert held.holding == {"left_hand", "right_hand"} and not held.free and ON_STAND not in held.pairs
    assert one_leg.supports == {"left_foot"} and one_leg.free == {"right_foot"}
    assert str(one_leg) == "E1 left_foot  E2 right_foot  E3 left_hand, right_hand"


def test_any_link_may_support():
    seat = pair("robot/seat", "world/chair")
    plan = ContactPlan(FEET, (ContactEvent(1.0, "make", seat),))
    assert plan.sets_at(1.0, TRACKED).supports == {"left_foot", "right_foot", "seat"}


def test_kinds_of_pairs_are_those_of_the_paper():
    assert [one.kind for one in (FEET[0], LEFT, RIGHT, ON_STAND)] == [
        "robot-world",
        "robot-thing",
        "robot-thing",
        "thing-world",
    ]
    assert RIGHT.first == SurfaceName("robot", "right_hand")


def test_hands_that_touch_together_are_one_group():
    groups = simultaneous(lift().events, 0.1)
    assert [len(group) for group in groups] == [2, 1, 1]


@pytest.mark.parametrize(
    ("events", "message"),
    [
        ((ContactEvent(1.0, "break", LEFT),), "never made"),
        ((ContactEvent(1.0, "make", FEET[0]),), "there already"),
        ((ContactEvent(1.0, "make", LEFT), ContactEvent(0.5, "break", LEFT)), "in order of time"),
    ],
)
def test_a_list_that_contradicts_itself_is_told(events, message):
    with pytest.raises(InputError, match=message):
        ContactPlan((*FEET, ON_STAND), events)


def test_a_surface_that_is_not_there_is_told_with_those_that_are():
    known = [SurfaceName("robot", name) for name in TRACKED] + [SurfaceName("world", "floor")]
    known += [SurfaceName("world", "stand"), SurfaceName("box", "bottom"), SurfaceName("box", "left")]
    with pytest.raises(InputError, match="no surface 'box/right'; 'box' has bottom, left"):
        lift().check_surfaces(known)
    lift().check_surfaces([*known, SurfaceName("box", "right")])


def test_a_file_gives_back_what_was_written(tmp_path):
    file = tmp_path / "events.toml"
    event_file.write(file, lift())
    assert event_file.read(file) == lift()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[[event]]\ntime = 1.0\nchange = "make"\nbetween = ["robot/left_hand"]', "between must be two surfaces"),
        ('[[event]]\ntime = 1.0\nchange = "hold"\nbetween = ["robot/a", "box/b"]', "choose make or break"),
        ('[[event]]\ntime = -1\nchange = "make"\nbetween = ["robot/a", "box/b"]', "time must be seconds"),
        ('[[event]]\ntime = 1\nchange = "make"\nbetween = ["robot/a", "robot/b"]', "belong to one body"),
        ('[[event]]\ntime = 1\nchange = "make"\nbetween = ["robot/a", "box"]', "names no surface"),
        ('[[event]]\ntime = 1\nchange = "break"\nbetween = ["robot/a", "box/b"]', "never made"),
        ('[[event]]\ntime = 1\nchange = "make"', "needs time, change and between"),
        ('[[contact]]\npair = ["robot/a", "box/b"]', "needs between"),
        ("[event]\ntime = 1", "something else"),
        ("surface = 1", "something else"),
    ],
)
def test_a_bad_file_is_told_in_one_line(tmp_path, text, message):
    file = tmp_path / "events.toml"
    file.write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        event_file.read(file)
    assert str(file) in str(caught.value) and "\n" not in str(caught.value)
