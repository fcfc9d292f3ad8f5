"""What is given up where a body cannot follow: amplitude of swings first, of high ones little, then time."""

from dataclasses import replace

import numpy as np
import pytest

from sot.motion.body.limits import Limits
from sot.motion.feet.stance import Build
from sot.motion.fitter import MIN_SHARES, Fitter, calmer_swings, swings_at_first
from sot.robots.robot import Robot
from tests.sot.motion.human.humans import walker


@pytest.fixture(scope="module")
def course():
    robot = Robot.load("hrp2")
    return Fitter(robot, Build.of(robot), Limits.of(robot), None).stepping_course(walker(), None, follow=True)


def middle(course, step):
    return np.array([0.5 * (course.travel.steps[step].lift + course.travel.steps[step].land)])


def test_swings_are_the_dancers_at_first_unless_they_come_late_or_turn_far(course):
    assert course.swing_shares == (1.0,) * len(course.travel.steps)
    travel = course.travel
    late = replace(travel.moves[1], lift=travel.moves[1].lift - 0.3)
    turned = {
        foot: [replace(hold, heading=hold.heading + k) for k, hold in enumerate(own)]
        for foot, own in travel.stands.items()
    }
    moved = replace(course, travel=replace(travel, moves=(travel.moves[0], late, *travel.moves[2:])))
    assert swings_at_first(moved)[:3] == (1.0, 0.0, 1.0)
    assert set(swings_at_first(replace(course, travel=replace(travel, stands=turned)))) == {0.0}


def test_a_swing_that_strains_gets_calmer_and_no_other_one(course):
    shares, about = calmer_swings(course, middle(course, 2))
    assert shares[2] == 0.5 and set(shares[:2] + shares[3:]) == {1.0}
    step = course.travel.steps[2]
    times = course.human.times
    assert about[(times > step.lift) & (times < step.land)].all() and not about[times < step.lift - 0.2].any()


def test_it_gets_no_calmer_than_its_least_share(course):
    lifts = (1.0, *course.travel.lifts[1:])
    high = replace(course, travel=replace(course.travel, lifts=lifts))
    for step, least in ((0, MIN_SHARES[True]), (1, MIN_SHARES[False])):
        now = high
        for _ in range(4):
            shares, about = calmer_swings(now, middle(course, step))
            now = replace(now, swing_shares=shares)
        assert now.swing_shares[step] == least and not about.any()


def test_strain_without_a_swing_changes_none(course):
    assert not calmer_swings(course, np.array([0.0]))[1].any()
