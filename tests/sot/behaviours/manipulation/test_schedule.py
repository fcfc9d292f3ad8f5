"""Algorithm 1 with a robot that follows its references exactly: what happens when, and what happens if it cannot."""

from itertools import pairwise
from types import MappingProxyType, SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

from sot.behaviours.manipulation.schedule import ManipulationSchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from tests.sot.demonstrations import box_demonstration

PERIOD = 0.01


class FollowingRobot:
    """Answers a schedule as a tick would, of a robot whose points, centre of mass and box are where they are led."""

    def __init__(self, schedule, stack, demo, held_up):
        self.schedule, self.stack, self.demo = schedule, stack, demo
        self.t, self.mass, self.com, self.com_velocity = 0.0, 58.0, np.zeros(3), np.zeros(3)
        self.box = demo.things["box"].placement(0.0)
        self.links, self.held_up = {}, held_up

    def surface_axes(self, surface):
        return surface.placement

    def frame(self, point):
        if point == "box":
            place = self.box
        elif point in self.demo.links:
            place = self.links[point]
        else:
            pose = self.demo.motion.pose(point)(0.0)
            place = pin.SE3(pose.rotation, pose.position)
        return SimpleNamespace(
            position=place.translation,
            rotation=place.rotation,
            floor_projection=lambda points: (points @ place.rotation.T + place.translation)[:, :2],
        )

    def loads(self, untouchable=()):
        felt = {}
        for event, target in self.demo.targets.items():
            contact = self.schedule_contacts[event.pair]
            body = self.box if target.body else pin.SE3.Identity()
            frame = self.frame(target.mover)
            gap = (frame.position - (body * target.place).translation) @ (body.rotation @ target.normal)
            felt[contact.name] = 10.0 if gap < 1e-6 and event.pair.first.surface not in untouchable else 0.0
        return felt

    def step(self, t):
        self.t = t
        poses = {point: guide(t) for point, guide in self.schedule.guides.items()}
        up = {point: np.array([0.0, 0.0, self.held_up.get(point, 0.0)]) for point in poses}
        self.links = {point: pin.SE3(pose.rotation, pose.position + up[point]) for point, pose in poses.items()}
        if self.stack.carried:
            pose = self.schedule.things["box"](t)
            self.box = pin.SE3(pose.rotation, pose.position)
        self.com, self.com_velocity, _ = self.schedule.com(t)
        self.com_velocity = np.zeros(3) if np.linalg.norm(self.com_velocity) < 1e-3 else self.com_velocity
        self.schedule.observe(self)


def play(untouchable=(), lost_at=np.inf, held_up=MappingProxyType({})):
    """A run; `held_up`: by how much points stay above where they are led [m]."""
    demo = box_demonstration()
    contacts = {pair: Contact(demo.surface(pair.first), demo.surface(pair.second)) for pair in demo.contacts.pairs()}
    for pair, contact in contacts.items():
        contact.mode = "fixed" if pair in demo.contacts.initial else "off"
    schedule, stack = ManipulationSchedule(demo, contacts), Stack(contacts.values(), [], {})
    robot = FollowingRobot(schedule, stack, demo, held_up)
    robot.schedule_contacts = contacts
    seen = []
    felt = {}
    for k in range(int((demo.motion.duration + schedule.extra_time) / PERIOD)):
        t = k * PERIOD
        told = [f"{t:.2f} {what}" for what in schedule.apply(t, stack, felt)]
        robot.step(t)
        felt = robot.loads(untouchable if t < lost_at else ("left_hand", "right_hand"))
        modes = {str(pair): contact.mode for pair, contact in contacts.items()}
        seen.append((t, modes, tuple(stack.carried), dict(felt), told))
        if schedule.finished:
            break
    return schedule, contacts, seen


@pytest.fixture(scope="module")
def whole():
    return play()


def first(seen, condition):
    return next(t for t, *row in seen if condition(*row))


def test_all_events_happen_in_order(whole):
    schedule, _, _ = whole
    assert schedule.finished and not schedule.failure
    assert [str(sets) for _, sets in schedule.history] == [
        "E1 left_foot, right_foot  E2 left_hand, right_hand  E3 -",
        "E1 left_foot, right_foot  E2 -  E3 left_hand, right_hand",
        "E1 left_foot, right_foot  E2 -  E3 left_hand, right_hand",
        "E1 left_foot  E2 right_foot  E3 left_hand, right_hand",
        "E1 left_foot  E2 right_foot  E3 left_hand, right_hand",
        "E1 left_foot  E2 left_hand, right_foot, right_hand  E3 -",
        "E1 left_foot, right_foot  E2 left_hand, right_hand  E3 -",
    ]
    assert len(schedule.waits) == 6 and all(wait.end > wait.start for wait in schedule.waits)


def test_no_contact_is_made_without_touch(whole):
    _, contacts, seen = whole
    for pair, contact in contacts.items():
        for (_, before, *_), (_, after, _, felt, _) in pairwise(seen):
            if before[str(pair)] == "off" and after[str(pair)] != "off":
                assert felt[contact.name] > 0.0


def test_the_centre_of_mass_changes_its_owner_before_anything_lets_go(whole):
    _, _, seen = whole
    held, on_stand = "robot/left_hand on box/left", "box/bottom on world/stand"
    taken = first(seen, lambda modes, carried, *_: carried == ("box",))
    assert first(seen, lambda modes, *_: modes[held] == "fixed") < taken
    assert taken < first(seen, lambda modes, *_: modes[on_stand] == "off")
    given = next(t for t, _, carried, *_ in seen if t > taken and not carried)
    assert given < next(t for t, modes, *_ in seen if t > taken and modes[held] == "off")
    assert given > first(seen, lambda modes, *_: modes["box/bottom on world/table"] == "fixed")


def test_a_support_is_given_up_with_the_centre_of_mass_over_the_others(whole):
    schedule, _, seen = whole
    foot = "robot/right_foot on world/floor"
    lifted = first(seen, lambda modes, *_: modes[foot] == "off")
    led = schedule.played().com[round(lifted / PERIOD), :2]
    left = schedule.demonstration.motion.phases[0].feet["left_foot"]
    sole = np.array([left.act(corner)[:2] for corner in schedule.demonstration.system.robot.sole("left_foot")])
    assert (led > sole.min(axis=0)).all() and (led < sole.max(axis=0)).all()


def test_the_box_ends_where_it_is_meant_to(whole):
    schedule, *_ = whole
    demo = schedule.demonstration
    target = next(one for event, one in demo.targets.items() if event.pair.first.entity == "box")
    assert schedule.things["box"](1e3).position == pytest.approx(target.place.translation, abs=2e-3)


def test_the_played_motion_waits_where_the_clock_does(whole):
    schedule, _, seen = whole
    played, wait = schedule.played(), schedule.waits[0]
    assert len(played.q) == len(seen)
    still = slice(round((wait.start + 0.7) / PERIOD), round(wait.end / PERIOD))
    assert np.abs(played.v[still]).max() < 1e-3
    assert np.ptp(played.q[still], axis=0).max() < 1e-3


def test_a_hand_that_never_touches_withdraws_and_says_so():
    schedule, contacts, seen = play(untouchable=("left_hand",))
    assert schedule.finished
    assert "robot/left_hand on box/left" in schedule.failure and "no touch within" in schedule.failure
    assert all(contact.mode == "off" for pair, contact in contacts.items() if pair.kind == "robot-thing")
    event = next(event for event in schedule.demonstration.targets if event.pair.first.surface == "left_hand")
    target = schedule.demonstration.targets[event]
    box = schedule.demonstration.things["box"].placement(0.0)
    at = schedule.guides["left_hand"](seen[-1][0]).position
    assert at == pytest.approx(target.away(box, target.standoff).translation, abs=1e-6)
    assert schedule.remarks() == [schedule.failure]


def test_a_foot_that_is_held_up_by_what_else_is_asked_is_led_on_until_it_touches():
    schedule, contacts, _ = play(held_up={"right_foot": 0.06})
    assert schedule.finished and not schedule.failure
    assert all(contact.mode == "fixed" for pair, contact in contacts.items() if pair.kind == "robot-world")


def test_a_thing_that_is_lost_is_told_with_its_time(whole):
    lifted = whole[0].history[2][0] + 0.5
    schedule, contacts, _ = play(lost_at=lifted)
    told = float(schedule.failure.removeprefix("box was lost at ").split()[0])
    assert told == pytest.approx(lifted, abs=2.5 * PERIOD)
    assert schedule.carried == () and schedule.finished
    assert all(contact.mode == "off" for pair, contact in contacts.items() if pair.kind == "robot-thing")
