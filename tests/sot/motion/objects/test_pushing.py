"""A path that pushing can make: the pushing force that it asks for never pulls."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.motion.human.human import Human
from sot.motion.objects.demonstration import HandledObjects, ObjectPath
from sot.motion.objects.events import ContactEvent, ContactPlan, SurfaceName, SurfacePair
from sot.motion.objects.pushing import COASTING_SHARE, joint_path, paced_for_pushing, pushing_clock
from sot.robots.things.thing import Thing
from sot.smooth import minimum_jerk

RATE, OPEN = 30.0, np.radians(25.0)
TIMES = np.arange(150) / RATE
ANGLE = OPEN * minimum_jerk(TIMES / 4.5)
INERTIA = 15.0 * 0.9**2 / 3.0 + 15.0 * 0.04**2 / 12.0


def door(damping=1.0, stiffness=0.0):
    return Thing.load("door", damping=damping, stiffness=stiffness)


def moment(thing, angle, clock, damping, stiffness):
    """Moment that moves the door through the angles at the times of a clock [N m], at the midpoints of its steps."""
    speed = np.diff(angle) / np.diff(clock)
    middle = 0.5 * (clock[1:] + clock[:-1])
    pace = np.gradient(speed, middle)
    return INERTIA * pace + damping * speed + stiffness * 0.5 * (angle[1:] + angle[:-1])


def test_without_a_spring_the_door_only_coasts_down():
    thing = door()
    clock = pushing_clock(thing, ANGLE, TIMES)
    needed = moment(thing, ANGLE, clock, 1.0, 0.0)
    assert clock[-1] > TIMES[-1] + 5.0 and (np.diff(clock) > np.diff(TIMES) - 1e-12).all()
    moving = ANGLE[1:] < (1.0 - 0.1 * COASTING_SHARE) * OPEN
    assert needed[moving].min() > 0.0
    assert moment(thing, ANGLE, TIMES, 1.0, 0.0).min() < -0.1  # as shown, it would have to be pulled
    speed = np.diff(ANGLE)[moving.sum()] / np.diff(clock)[moving.sum()]
    assert speed * INERTIA / 1.0 < COASTING_SHARE * OPEN  # what is left coasts no further than that


def test_a_spring_that_brakes_leaves_the_demonstration_as_it_is():
    np.testing.assert_allclose(pushing_clock(door(stiffness=10.0), ANGLE, TIMES), TIMES)


def test_each_way_back_is_a_way_of_its_own():
    there_and_back = np.concatenate([ANGLE, ANGLE[::-1]])
    times = np.arange(len(there_and_back)) / RATE
    clock, once = pushing_clock(door(), there_and_back, times), pushing_clock(door(), ANGLE, TIMES)
    assert clock[len(ANGLE) - 1] == pytest.approx(once[-1], rel=1e-9)
    assert clock[-1] - clock[len(ANGLE)] == pytest.approx(once[-1], rel=1e-9)


def test_what_nothing_brakes_is_refused():
    with pytest.raises(InputError, match=r"door: pushing cannot stop it.*damping 0 N m s/rad"):
        pushing_clock(door(damping=0.0), ANGLE, TIMES)


def shown():
    turn = Rotation.from_euler("Z", ANGLE[:, None])
    path = ObjectPath(np.array([0.04, 0.9, 2.0]), turn.apply([0.0, -0.45, 1.0]), turn.as_matrix(), hinged=True)
    points = {"waist": np.column_stack([0.01 * TIMES, 0 * TIMES, 1.0 + 0 * TIMES])}
    human = Human("someone", RATE, points, {"pelvis": np.tile(np.eye(3), (len(TIMES), 1, 1))})
    pair = SurfacePair(SurfaceName("robot", "right_hand"), SurfaceName("door", "front"))
    events = (ContactEvent(0.0, "make", pair), ContactEvent(4.8, "break", pair))
    return human, HandledObjects(RATE, {"door": path}, {}), ContactPlan((), events)


def test_the_joint_turns_as_far_as_the_humans_object_does():
    np.testing.assert_allclose(joint_path(door(), shown()[1].objects["door"]), ANGLE, atol=1e-9)


def test_human_objects_and_events_go_by_one_clock():
    human, handled, contacts = shown()
    paced = paced_for_pushing(human, handled, contacts, [door()])
    assert paced.human.count == len(paced.handled.objects["door"].position) > human.count
    assert len(paced.remarks) == 1 and "longer than shown" in paced.remarks[0]
    released = paced.contacts.events[1].time
    k = round(released * RATE)
    assert paced.human.points["waist"][k, 0] == pytest.approx(0.01 * 4.8, abs=2e-4)
    assert joint_path(door(), paced.handled.objects["door"])[-1] == pytest.approx(OPEN, abs=1e-3)


def test_nothing_changes_without_a_need():
    human, handled, contacts = shown()
    for things in ([], [door(stiffness=50.0)]):
        paced = paced_for_pushing(human, handled, contacts, things)
        assert paced.human is human and paced.handled is handled and paced.contacts is contacts and not paced.remarks
