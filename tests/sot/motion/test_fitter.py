"""What swings are the dancer's, and what is given up where a body cannot follow: amplitude first, then time."""

from dataclasses import replace

import numpy as np
import pytest

from sot.motion.body.limits import Limits
from sot.motion.feet.course import standing_course
from sot.motion.feet.stance import Build
from sot.motion.fitter import MIN_LIFT_SHARE, Fitter, calmer_swings, followed_swings, kept_lifts
from sot.robots.robot import Robot
from tests.sot.motion.human.humans import walker


@pytest.fixture(scope="module")
def fitter():
    robot = Robot.load("hrp2")
    return Fitter(robot, Build.of(robot), Limits.of(robot), None)


@pytest.fixture(scope="module")
def course(fitter):
    made = fitter.stepping_course(walker(), None, keep_lifts=False)
    return fitter.with_dancers_swings(made, followed_swings(made))


def middle(course, step):
    return np.array([0.5 * (course.travel.steps[step].lift + course.travel.steps[step].land)])


def test_swings_may_be_the_dancers_unless_they_are_late_hurried_turned_or_slowed(course):
    travel = course.travel
    assert followed_swings(course) == (1.0,) * len(travel.steps)
    plain = replace(course, swing_shares=())
    late, long = travel.moves[1], travel.moves[3]
    moves = list(travel.moves)
    moves[1], moves[3] = (
        replace(late, lift=late.lift - 0.4, land=late.land - 0.4),
        replace(long, lift=long.lift - 0.25, land=long.land + 0.25),
    )
    assert followed_swings(replace(plain, travel=replace(travel, moves=tuple(moves))))[:4] == (1.0, 0.0, 1.0, 0.0)
    turned = {
        foot: [replace(hold, heading=hold.heading + 1.1 * k) for k, hold in enumerate(own)]
        for foot, own in travel.stands.items()
    }
    assert set(followed_swings(replace(plain, travel=replace(travel, stands=turned)))) == {0.0}
    clock = course.clock + 0.3 * np.clip(course.clock - travel.steps[-1].lift, 0.0, None)
    slowed = followed_swings(replace(plain, clock=clock))
    assert slowed[0] == 1.0 and slowed[-1] == 0.0


def test_a_swing_that_strains_gets_plain_and_none_far_from_it(fitter, course):
    shares, about = calmer_swings(course, middle(course, 2))
    assert shares[2] == 0.0 and shares[0] == shares[-1] == 1.0
    step, times = course.travel.steps[2], course.human.times
    assert about[(times > step.lift) & (times < step.land)].all() and not about[times < step.lift - 1.2].any()
    made, plain = (fitter.with_dancers_swings(course, own) for own in (shares, (0.0,) * len(shares)))
    path, way = made.feet[step.foot], plain.feet[step.foot]
    swing = (times > step.lift) & (times < step.land)
    np.testing.assert_array_equal(path.position[swing], way.position[swing])
    assert not path.yielding[swing].any()


def test_a_kept_lift_gets_no_calmer_than_half(course):
    high = replace(course, travel=replace(course.travel, lifts=(1.0, *course.travel.lifts[1:])), keeps_lifts=True)
    assert kept_lifts(high) == (True, *(len(course.travel.steps) - 1) * (False,))
    assert kept_lifts(replace(high, keeps_lifts=False)) == ()
    for _ in range(2):
        shares, about = calmer_swings(high, np.concatenate([middle(high, 0), middle(high, 1)]))
        high = replace(high, swing_shares=shares)
    assert shares[:2] == (MIN_LIFT_SHARE, 0.0) and not about.any()


def test_strain_without_a_swing_changes_none(course):
    assert not calmer_swings(course, np.array([0.0]))[1].any()


def test_legs_are_as_straight_as_the_dancers_only_where_feet_step(fitter, course):
    """A foot that slides is lightly loaded, and a standing leg that is nearly straight cannot keep it so."""
    assert set(fitter.targets(course).extension) == set(fitter.robot.feet)
    assert fitter.targets(standing_course(course.human, fitter.robot)).extension == {}
