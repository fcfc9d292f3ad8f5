"""What a live run tells of the person's steps."""

import pytest

from scenarios.live.record import LiveWay
from tests.sot.live.steps.test_follower import DURATION, STEP, followed, stepping


def test_a_step_that_the_robot_makes_is_one_of_its_footfalls_with_its_place_and_time():
    _, follower, begun = followed(stepping)
    way = LiveWay.of(follower, DURATION)
    (fall,) = way.footfalls
    assert fall.foot == "left_foot" and fall.landed == begun[0][2]
    assert fall.place == (follower.footing.stands["left_foot"].x, follower.footing.stands["left_foot"].y)
    assert 0.3 * STEP[0] * follower.footing.scale < way.path < STEP[0] * follower.footing.scale  # its body goes half


def test_a_step_that_is_not_over_is_no_footfall_yet():
    _, follower, begun = followed(stepping)
    assert LiveWay.of(follower, begun[0][1]).footfalls == []


def test_who_stands_goes_nowhere():
    _, follower, _ = followed(lambda frame, now: [frame])
    way = LiveWay.of(follower, DURATION)
    assert way.footfalls == [] and way.path == pytest.approx(0.0, abs=0.15)
