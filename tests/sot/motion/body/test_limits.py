import numpy as np
import pytest

from sot.motion.body.limits import LEG_VELOCITY_SHARE, USABLE_LIMIT_SHARE, Limits
from sot.robots.robot import Robot


@pytest.mark.parametrize("name", ["hrp2", "hrp2_modified"])
def test_legs_keep_more_of_their_speed_for_feedback_than_other_joints(name):
    robot = Robot.load(name)
    share = Limits.of(robot).velocity[6:] / robot.velocity
    legs = np.isin(np.arange(robot.na), robot.groups["legs"])
    np.testing.assert_allclose(share[legs], LEG_VELOCITY_SHARE)
    np.testing.assert_allclose(share[~legs], USABLE_LIMIT_SHARE)
    assert LEG_VELOCITY_SHARE < USABLE_LIMIT_SHARE


def test_limits_leave_room_inside_the_robots_own_and_hold_the_rest_posture():
    robot = Robot.load("hrp2")
    limits = Limits.of(robot)
    assert np.all(limits.acceleration[6:] < robot.acceleration)
    assert np.all(limits.lower[6:] < robot.rest[7:]) and np.all(robot.rest[7:] < limits.upper[6:])
    assert np.all(np.isinf(limits.velocity[:6]))
