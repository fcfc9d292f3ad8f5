"""A planned swing led elsewhere: as smooth as the plan, from where the foot is to where it shall be."""

import numpy as np
import pytest

from sot.behaviours.planned_swing import LedSwing, PlannedSwing
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
