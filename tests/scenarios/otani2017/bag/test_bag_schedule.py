"""The bag's phases with a robot that follows its references exactly, on a table that may be elsewhere or slippery."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

from scenarios.otani2017.bag.scene import BagPlan, bag_things
from scenarios.otani2017.bag.schedule import BagSchedule
from scenarios.otani2017.bag.stack import bag_contacts
from sot.control.stack import Stack
from sot.robots.robot import Robot
from sot.robots.system import System

PERIOD = 0.01
PALM, HOOK, FOOT, LYING = "right_palm on table/top", "left_hook on bag/handle", "left_foot", "bag/bottom on table/top"


class FollowingRobot:
    """Answers a schedule as a tick would; its palm slides by so much a tick while it supports [m]."""

    def __init__(self, schedule, contacts, system, lower, slides):
        self.schedule, self.contacts, self.system = schedule, contacts, system
        self.q, self.t, self.lower, self.slides = system.rest, 0.0, lower, slides
        self.com, self.com_velocity, self.slid = np.zeros(3), np.zeros(3), 0.0
        self.places = dict(schedule.plan.start)

    def frame(self, point):
        place = self.places[point]
        return SimpleNamespace(position=place.translation, rotation=place.rotation)

    def surface_axes(self, surface):
        place = surface.placement if surface.point is None else self.places[surface.point] * surface.placement
        return SimpleNamespace(translation=place.translation, rotation=place.rotation)

    def relative_frame(self, surface, on):
        shift = [self.slid if surface.name == "right_palm" else 0.0, 0.0, 0.0]
        return SimpleNamespace(position=self.surface_axes(surface).translation + shift)

    def loads(self):
        palm = self.surface_axes(self.contacts["palm"].surface).translation[2]
        hook = self.surface_axes(self.contacts["hook"].surface).translation[2]
        table = self.system.surface("table/top").axes.translation[2]
        handle = table + self.system.surface("bag/handle").placement.translation[2]
        foot = self.places["left_foot"].translation[2]
        return {
            PALM: 30.0 * (palm < table - self.lower + 1e-9),
            HOOK: 5.0 * (hook > handle - 1e-9),
            FOOT: 200.0 * (foot < 1e-9),
        }

    def step(self, t):
        self.t = t
        for point, guide in self.schedule.guides.items():
            pose = guide(t)
            self.places[point] = pin.SE3(pose.rotation, pose.position)
        if self.contacts["palm"].mode == "fixed":
            self.slid += self.slides
        self.com, velocity, _ = self.schedule.com(t)
        self.com_velocity = velocity if np.linalg.norm(velocity) > 1e-3 else np.zeros(3)
        self.schedule.observe(self)


def play(lower=0.0, slides=0.0):
    robot = Robot.load("hrp2")
    system = System(robot, bag_things(robot, 1.5))
    contacts = bag_contacts(system)
    schedule = BagSchedule(robot, BagPlan.of(system), contacts)
    stack, seen, felt = Stack(contacts.values(), [], {}), [], {}
    follower = FollowingRobot(schedule, contacts, system, lower, slides)
    for k in range(round(schedule.extra_time / PERIOD)):
        schedule.apply(k * PERIOD, stack, felt)
        follower.step(k * PERIOD)
        felt = follower.loads()
        seen.append(
            (k * PERIOD, {c.name: c.mode for c in contacts.values()}, follower.com[:2].copy(), tuple(stack.carried))
        )
        if schedule.finished:
            break
    return schedule, contacts, seen


@pytest.fixture(scope="module")
def fetched():
    return play()


def test_the_bag_is_fetched_phase_by_phase(fetched):
    schedule, contacts, seen = fetched
    assert schedule.finished and not schedule.failure
    assert [name for _, name in schedule.history] == [
        "hand on the table",
        "one foot",
        "reach",
        "hook",
        "lift",
        "both feet",
        "hand off",
        "home",
    ]
    assert contacts["hook"].mode == "fixed" and contacts["lying"].mode == "off" and contacts["palm"].mode == "off"
    assert seen[-1][3] == ("bag",)
    lifted = [(modes, com) for _, modes, com, _ in seen if modes[FOOT] == "off"]
    assert all(modes[PALM] == "fixed" for modes, _ in lifted)
    assert max(com[0] for _, com in lifted) > schedule.plan.sole_edge + 0.015


def test_a_bag_counts_as_the_robots_own_before_it_leaves_the_table(fetched):
    _, _, seen = fetched
    counted = next(t for t, _, _, carried in seen if carried)
    assert counted < next(t for t, modes, *_ in seen if modes[LYING] == "off")


def test_a_lower_table_is_found_by_force_and_the_contact_is_there():
    schedule, contacts, _ = play(lower=0.02)
    assert schedule.finished and not schedule.failure
    told = schedule.plan.palm.translation[2] - 0.052
    assert contacts["palm"].on.axes.translation[2] == pytest.approx(told - 0.02, abs=0.002)


def test_without_a_table_nothing_is_loaded_and_both_feet_stay():
    schedule, _, seen = play(lower=0.2)
    assert schedule.finished and "right_palm on table/top: no touch" in schedule.failure
    assert all(modes[PALM] == "off" and modes[FOOT] == "fixed" for _, modes, *_ in seen)
    assert len(schedule.remarks()) == 1


def test_a_hand_that_slips_is_given_up_once_both_feet_stand():
    schedule, contacts, seen = play(slides=1e-5)
    assert schedule.finished and "slipped 2 times" in schedule.failure
    off = [t for t, modes, *_ in seen if modes[PALM] == "off" and t > 8.0]
    assert off and all(modes[FOOT] == "fixed" for t, modes, *_ in seen if t >= off[0])
    assert contacts["hook"].mode == "off" or seen[-1][3] == ("bag",)
    assert contacts["palm"].friction < 0.35 and contacts["palm"].most < 100.0  # N, of the 256 that it may bear
