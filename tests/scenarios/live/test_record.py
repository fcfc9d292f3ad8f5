"""What a live run tells of the person's steps."""

from types import SimpleNamespace

import numpy as np
import pytest

from scenarios.live.record import HUMAN_RATE, LiveWay, upper_segment_lag
from sim.reporting.figures import Points
from sot.motion.human.human import Human
from sot.robots.robot import Robot
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


def test_a_robot_that_is_only_late_has_no_error_left_at_its_lag():
    robot, late, period, duration = Robot.load("hrp2"), 0.14, 0.01, 4.0

    def posed(times):
        q = np.tile(robot.rest, (len(times), 1))
        for joint, name in enumerate(robot.joints):
            if name in ("LARM1", "RARM3"):
                q[:, 7 + joint] += 0.4 * np.sin(3.0 * times + joint)
        return q

    times = np.arange(0.0, duration, 1.0 / HUMAN_RATE)
    person = Human("late", HUMAN_RATE, Points.of(robot, posed(times)).positions, {})
    record = SimpleNamespace(human=person, motion=SimpleNamespace(robot=robot), start=0.5, end=duration)
    ticks = np.arange(0.0, duration, period)
    log = SimpleNamespace(q=posed(ticks - late), time=ticks, period=period, ticks=len(ticks))
    found = upper_segment_lag(record, log)
    assert found["lag_ms"] == pytest.approx(1e3 * late)
    assert found["deg_at_lag"] < 1e-6 < 1.0 < found["deg"]
