import numpy as np
import pytest

from sot.acceleration_bounds import SOFT_BRAKING_RANGE, AccelerationBounds
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


@pytest.mark.parametrize("share", [0.1, 0.25, 0.4])
def test_a_leg_that_its_plan_brakes_to_the_end_of_its_range_is_not_held_back_by_the_controller(share):
    """Brakes evenly, from full speed, with a share of the deceleration that the controller relies on, a sixth of which
    feedback may take besides."""
    robot = Robot.load("hrp2")
    limits, period, margin = Limits.of(robot), 0.002, 0.002  # as JointBounds has it
    bounds = AccelerationBounds(
        robot.lower + margin,
        robot.upper - margin,
        robot.velocity,
        robot.acceleration,
        robot.acceleration_hard,
        SOFT_BRAKING_RANGE,
    )
    legs = list(robot.groups["legs"])
    for gone in np.linspace(0.0, 1.0, 200):
        v = limits.velocity[6:] * (1.0 - gone)
        braking, feedback = share * robot.acceleration, robot.acceleration[legs] / 6.0
        low, high = bounds(limits.upper[6:] - 0.5 * v**2 / braking, v, period)
        assert (high[legs] >= -braking[legs] + feedback).all()
        low, high = bounds(limits.lower[6:] + 0.5 * v**2 / braking, -v, period)
        assert (low[legs] <= braking[legs] - feedback).all()
