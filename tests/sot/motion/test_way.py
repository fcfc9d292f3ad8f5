"""Footsteps along a way of the body."""

import itertools

import numpy as np

from sot.motion.feet.footwork import Foothold
from sot.motion.way import MAX_STEP, MAX_TURN, footsteps_along, standing_footholds
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
