"""A planned swing led elsewhere: as smooth as the plan, from where the foot is to where it shall be."""

import numpy as np
import pinocchio as pin
import pytest

from sot.behaviours.planned_swing import EarlyLanding, LedSwing, PlannedSwing
from sot.behaviours.stride import LANDING_DEPTH
from sot.control.pose import Pose
from sot.motion.feet.footfalls import Footfalls
from sot.robots.robot import Robot
from tests.sot.behaviours.stepping import FIRST, SWING, stepping_motion

FOOT, LAND = "right_foot", FIRST + SWING
START, FIRST_WAY, LAST_WAY = np.array([0.03, -0.02]), np.array([0.1, 0.05]), np.array([0.06, 0.0])


@pytest.fixture(scope="module")
def planned():
    motion = stepping_motion(Robot.load("hrp2"))
    return PlannedSwing(Footfalls(motion.phases, FOOT), motion.pose(FOOT))


@pytest.fixture
def led(planned):
    swing = LedSwing(planned, FIRST, LAND, START)
    swing.redirect(FIRST, FIRST_WAY)
    return swing


def test_it_begins_where_the_foot_is_and_ends_where_it_was_led_last_at_rest(planned, led):
    np.testing.assert_allclose((led(FIRST).position - planned(FIRST).position)[:2], START, atol=1e-12)
    led.redirect(FIRST + 0.3, LAST_WAY)
    for t in (LAND, LAND + 0.1):
        there, plan = led(t), planned(t)
        np.testing.assert_allclose(there.position, plan.position + np.append(LAST_WAY, 0.0), atol=1e-9)
        np.testing.assert_allclose(there.velocity, plan.velocity, atol=1e-9)


def test_velocity_and_acceleration_are_the_derivatives(led):
    led.redirect(FIRST + 0.2, LAST_WAY)
    h = 1e-5
    for t in (FIRST + 0.25005, FIRST + 0.45005):
        before, at, after = led(t - h), led(t), led(t + h)
        for k in range(2):  # between samples the plan's own acceleration is that of the sample
            off = [pose.position[k] for pose in (before, after)]
            assert (off[1] - off[0]) / (2.0 * h) == pytest.approx(at.velocity[k], abs=1e-4)
            rates = [pose.velocity[k] for pose in (before, after)]
            assert (rates[1] - rates[0]) / (2.0 * h) == pytest.approx(at.acceleration[k], abs=1e-2)


def test_nothing_jumps_when_it_is_led_elsewhere(led):
    t = FIRST + 0.25
    before = led(t)
    led.redirect(t, LAST_WAY)
    for one, other in zip(before, led(t), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)
    led.redirect(LAND + 0.01, FIRST_WAY)  # too late
    assert led.landing_off == pytest.approx(LAST_WAY)


def test_a_late_foot_is_lowered_beside_its_place_as_at_it(planned, led):
    assert led(LAND + 0.1).position[2] == planned(LAND + 0.1).position[2] < planned(LAND).position[2] - 0.005


@pytest.fixture
def early():
    axis = np.array([0.1, 0.2, 0.9])
    start = Pose(np.array([0.1, -0.1, 0.12]), pin.exp3(-axis), np.append([0.3, 0.1, 0.2], 0.5 * axis), np.ones(6))
    there = Pose(np.array([0.2, -0.1, 0.01]), np.eye(3), np.zeros(6), np.zeros(6))
    return EarlyLanding(1.0, start, 1.3, there, FIRST_WAY), start, there


def test_an_early_landing_goes_on_from_where_the_foot_is_and_ends_flat_at_rest_on_the_floor(early):
    path, start, there = early
    now = path(1.0)
    np.testing.assert_allclose(now.position, start.position, atol=1e-12)
    np.testing.assert_allclose(now.rotation, start.rotation, atol=1e-12)
    np.testing.assert_allclose(now.velocity, start.velocity, atol=1e-12)
    end = path(1.3)
    np.testing.assert_allclose(end.position, there.position + np.append(FIRST_WAY, -LANDING_DEPTH), atol=1e-9)
    np.testing.assert_allclose(end.rotation, there.rotation, atol=1e-9)
    np.testing.assert_allclose(end.velocity, 0.0, atol=1e-9)
    assert path(1.4).position[2] < end.position[2]


def test_its_velocity_and_acceleration_are_the_derivatives_and_it_may_be_led_elsewhere(early):
    path, h = early[0], 1e-5
    before = path(1.1)
    path.redirect(1.1, LAST_WAY)
    for one, other in zip(before, path(1.1), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)
    for t in (1.15, 1.25):
        last, now, following = path(t - h), path(t), path(t + h)
        np.testing.assert_allclose((following.position - last.position) / (2 * h), now.velocity[:3], atol=1e-6)
        turned = pin.log3(following.rotation @ last.rotation.T)
        np.testing.assert_allclose(turned / (2 * h), now.velocity[3:], atol=1e-6)
        np.testing.assert_allclose((following.velocity - last.velocity) / (2 * h), now.acceleration, atol=1e-4)
