"""Footsteps along a way of the body."""

import itertools

import numpy as np

from sot.gravity import GRAVITY
from sot.motion.feet.footwork import Foothold
from sot.motion.way import MAX_STEP, MAX_TURN, WAITING_TIME, footsteps_along, standing_footholds
from sot.robots.robot import Robot
from sot.robots.size import leg_length


def test_the_feet_end_where_they_stand_at_rest_seen_from_the_last_stop() -> None:
    robot = Robot.load("hrp2")
    stop = Foothold(-0.3, 0.5, np.pi / 2)
    walked = footsteps_along(robot, [Foothold(-0.3, 0.0, 0.0), Foothold(-0.3, 0.0, np.pi / 2), stop])
    for foot, rest in standing_footholds(robot).items():
        end = walked.stands[foot][-1]
        np.testing.assert_allclose([end.x, end.y], [stop.x - rest.y, stop.y + rest.x], atol=1e-12)
        assert abs(end.heading - stop.heading) < 1e-12


def test_no_step_is_longer_or_turns_farther_than_allowed_and_feet_take_turns() -> None:
    robot = Robot.load("hrp2")
    walked = footsteps_along(robot, [Foothold(0.5, 0.0, 0.0), Foothold(0.5, 0.0, -1.0)])
    longest = 2.0 * MAX_STEP * leg_length(robot) + 0.05  # a turning foot goes around its body, too
    for stands in walked.stands.values():
        for here, there in itertools.pairwise(stands):
            assert np.hypot(there.x - here.x, there.y - here.y) <= longest
            assert abs(there.heading - here.heading) <= 2.0 * MAX_TURN + 1e-9
    for step, after in zip(walked.steps[:-1], walked.steps[1:], strict=True):
        assert step.foot != after.foot
        assert step.land < after.lift
    assert walked.end > walked.steps[-1].land


def test_the_robot_waits_at_a_stop_for_as_long_as_it_is_told() -> None:
    robot = Robot.load("hrp2")
    stops = [Foothold(0.2, 0.0, 0.0), Foothold(0.4, 0.0, 0.0)]
    usual, longer = footsteps_along(robot, stops), footsteps_along(robot, stops, waits={0: WAITING_TIME + 10.0})
    unit = np.sqrt(leg_length(robot) / GRAVITY)
    assert longer.arrivals[0] == usual.arrivals[0]
    assert abs(longer.arrivals[1] - usual.arrivals[1] - 10.0 * unit) < 1e-9
    assert longer.arrivals[1] == longer.steps[-1].land
