"""Torque and joint bounds: what they promise over time, from any start, at any period, for any choice between them."""

import numpy as np
import pytest

from sot.acceleration_bounds import SOFT_BRAKING_RANGE, SPEED_LAG, AccelerationBounds
from sot.control.tick import Tick
from sot.robots.robot import Robot, shipped_robot_names
from tasks.bounds import JointBounds, TorqueBounds, TorqueRateBounds
from tests.sot.states import random_state

STARTS = 1000
PERIODS = (0.0002, 0.001, 0.002, 0.005, 0.01)
SOFTNESS = pytest.mark.parametrize("soft", [0.0, SOFT_BRAKING_RANGE])


def joints(rng):
    """Random joints: range, velocity, braking and hard acceleration limits."""
    width, brake = rng.uniform(0.5, 3.0, STARTS), rng.uniform(10, 100, STARTS)
    lower = rng.uniform(-2, 1, STARTS)
    return lower, lower + width, rng.uniform(1, 10, STARTS), brake, brake * rng.uniform(1.0, 5.0, STARTS)


def keepable_starts(rng, lower, upper, velocity, brake, period, soft=0.0):
    """Positions and speeds from which whole periods of braking still stop inside, many on the very edge of it."""
    lag = np.sqrt(2.0 * soft / brake)
    q = rng.uniform(lower, upper)
    near = rng.random(STARTS) < 0.5
    q[near] = (upper - (upper - lower) * 10.0 ** rng.uniform(-8, -1, STARTS))[near]

    def fastest(distance):  # v² + brake T v = 2 brake (distance − soft), and the straight line that touches it
        half, line = 0.5 * brake * period, distance / (lag + 0.5 * period)
        curve = np.sqrt(half**2 + 2.0 * brake * np.maximum(distance - soft, 0.0)) - half
        return np.minimum(np.where(line < brake * lag, line, curve), velocity)

    share = np.where(rng.random(STARTS) < 0.3, 1.0, rng.random(STARTS))
    v = share * np.where(rng.random(STARTS) < 0.5, fastest(upper - q), -fastest(q - lower))
    return q, v


def choose(rng, choice, low, high):
    if choice == "random":
        return rng.uniform(low, high)
    if choice == "upper then lower":
        return np.where(rng.random(STARTS) < 0.95, high, low)
    return high if choice == "upper" else low


def step(q, v, a, period):
    """Exact motion under a constant acceleration, and the furthest positions on the way, up and down."""
    turn = np.where((a != 0.0) & (-v / np.where(a == 0.0, 1.0, a) > 0.0), -v / np.where(a == 0.0, 1.0, a), 0.0)
    turn = np.minimum(turn, period)
    turned, end = q + v * turn + 0.5 * a * turn**2, q + v * period + 0.5 * a * period**2
    return end, v + a * period, np.maximum(turned, end), np.minimum(turned, end)


@SOFTNESS
@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("choice", ["upper", "lower", "random", "upper then lower"])
def test_whatever_is_chosen_between_the_bounds_keeps_range_and_velocity(period, choice, soft):
    rng = np.random.default_rng(int(1e5 * period))
    lower, upper, velocity, brake, hard = joints(rng)
    q, v = keepable_starts(rng, lower, upper, velocity, brake, period, soft)
    for _ in range(150):
        low, high = AccelerationBounds(lower, upper, velocity, brake, hard, soft)(q, v, period)
        assert np.all(high >= -brake - 1e-6) and np.all(low <= brake + 1e-6)  # no more than is relied upon
        assert np.all(low <= high) and np.all(low >= -hard) and np.all(high <= hard)
        q, v, highest, lowest = step(q, v, choose(rng, choice, low, high), period)
        assert np.max(highest - upper) < 1e-9 and np.max(lower - lowest) < 1e-9
        assert np.max(np.abs(v) - velocity) < 1e-9


@SOFTNESS
@pytest.mark.parametrize("period", [0.005, 0.01])
def test_the_upper_bound_reaches_the_end_of_the_range_and_stays_there(period, soft):
    rng = np.random.default_rng(1)
    lower, upper, velocity, brake, hard = joints(rng)
    q, v = keepable_starts(rng, lower, upper, velocity, brake, period, soft)
    for k in range(round(6.0 / period)):
        _, high = AccelerationBounds(lower, upper, velocity, brake, hard, soft)(q, v, period)
        if k * period > 5.9:
            assert np.max(np.abs(high)) < 1e-3  # at rest at the end, without chatter
        q, v, *_ = step(q, v, high, period)
    np.testing.assert_allclose(q, upper, atol=1e-6)


@pytest.mark.parametrize("period", PERIODS)
def test_bounds_admit_something_from_any_state(period):
    rng = np.random.default_rng(2)
    lower, upper, velocity, brake, hard = joints(rng)
    for spread in (0.0, 1e-9, 0.1, 3.0):
        q = np.where(rng.random(STARTS) < 0.5, lower, upper) + spread * rng.uniform(-1, 1, STARTS)
        for speed in (0.0, 1e-12, 1.0, 20.0):
            v = speed * rng.uniform(-1, 1, STARTS)
            low, high = AccelerationBounds(lower, upper, velocity, brake, hard)(q, v, period)
            assert np.all(np.isfinite(low)) and np.all(np.isfinite(high))
            assert np.all(low <= high) and np.all(low >= -hard) and np.all(high <= hard)


@SOFTNESS
@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_joint_that_starts_outside_comes_back_without_overshoot(period, side, soft):
    rng = np.random.default_rng(3)
    lower, upper, velocity, brake, hard = joints(rng)
    end = upper if side > 0 else lower
    q, v = end + side * rng.uniform(0.0, 0.2, STARTS), np.zeros(STARTS)
    beyond = side * (q - end)
    for _ in range(round((1.2 if soft else 0.8) / period)):
        low, high = AccelerationBounds(lower, upper, velocity, brake, hard, soft)(q, v, period)
        q, v, highest, lowest = step(q, v, high if side > 0 else low, period)  # what resists the return most
        furthest = np.maximum(side * (highest - end), side * (lowest - end))
        assert np.all(furthest <= np.maximum(beyond, 0.0) + 1e-9)
        beyond = side * (q - end)
        assert np.all(beyond > -1e-6)  # not thrown far inside either
    assert np.all(beyond < 1e-3)


def test_at_the_end_of_the_range_rounding_does_not_kick_the_joint():
    limits = [np.array([limit]) for limit in (-1.0, 1.0, 5.0, 60.0, 400.0)]
    for distance in (0.0, 1e-18, 1e-12, 1e-9):
        for speed in (0.0, 1e-12, 1e-9, 1e-7):
            _, high = AccelerationBounds(*limits)(np.array([1.0 - distance]), np.array([speed]), 0.001)
            assert np.abs(high[0]) < 0.01


@pytest.mark.parametrize("period", PERIODS)
def test_a_slow_joint_is_braked_gently_even_where_it_moves_faster_than_was_commanded(period):
    # A standing ankle: the sole gives way, so that the joint is faster than it should be. To take that back within a
    # period, by whatever that takes of the body, would make the sole give way more.
    limits, lag = (
        [np.array([limit]) for limit in (-1.0, 1.0, 5.0, 60.0, 400.0)],
        np.sqrt(2.0 * SOFT_BRAKING_RANGE / 60.0),
    )
    distance = np.array([0.001])
    slow = distance / (lag + 0.5 * period)  # may just be kept
    for excess in (0.0, 0.05, 0.2):
        _, high = AccelerationBounds(*limits, SOFT_BRAKING_RANGE)(1.0 - distance, slow + excess, period)
        assert -2.0 * (slow + excess) / lag <= high <= -excess / max(lag, period)


@pytest.mark.parametrize("name", shipped_robot_names())
def test_joint_bounds_are_rows_on_the_joint_accelerations(name):
    robot = Robot.load(name)
    q, v = random_state(robot, np.random.default_rng(0))
    tick, task = Tick(robot, period=0.002).update(0.0, q, v), JointBounds(robot, 0.01, 0.9)
    rows = task.rows(tick)
    np.testing.assert_array_equal(rows.A @ np.arange(robot.nv), np.arange(6, robot.nv))
    limits = robot.lower + 0.01, robot.upper - 0.01, 0.9 * robot.velocity, robot.acceleration, robot.acceleration_hard
    low, high = AccelerationBounds(*limits, SOFT_BRAKING_RANGE, SPEED_LAG)(q[7:], v[6:], 0.002)
    np.testing.assert_array_equal(rows.lower, low)
    np.testing.assert_array_equal(rows.upper, high)
    assert not task.equality and task.variable == "acceleration" and task.gives_way == 1


def test_joint_bounds_report_how_far_outside_a_joint_is():
    robot = Robot.load("hrp2")
    q = robot.rest.copy()
    q[7], q[8] = robot.upper[0] + 0.1, robot.lower[1] - 0.2
    task = JointBounds(robot, range_margin=0.0)
    task.rows(Tick(robot).update(0.0, q, np.zeros(robot.nv)))
    np.testing.assert_allclose(task.error[:2], [0.1, -0.2])
    np.testing.assert_array_equal(task.error[2:], 0.0)


@pytest.mark.parametrize("fraction", [1.0, 0.3])
def test_torque_bounds_are_the_robot_s_effort(fraction):
    robot = Robot.load("hrp2")
    task = TorqueBounds(robot, fraction)
    rows = task.rows(Tick(robot))
    np.testing.assert_array_equal(rows.A, np.eye(robot.na))
    np.testing.assert_allclose(rows.upper, fraction * robot.effort)
    np.testing.assert_allclose(rows.lower, -fraction * robot.effort)
    assert not task.equality and task.variable == "torque" and task.gives_way == 2


def test_torque_rates_are_bounded_about_the_torque_of_the_last_tick():
    robot = Robot.load("hrp2")
    tick, task = Tick(robot, period=0.002), TorqueRateBounds(robot, rise_time=0.04)
    task.rows(tick)
    tick.torque = np.linspace(-1.0, 1.0, robot.na) * robot.effort
    rows = task.rows(tick)
    np.testing.assert_array_equal(rows.A, np.eye(robot.na))
    np.testing.assert_allclose(rows.upper - tick.torque, 0.05 * robot.effort)
    np.testing.assert_allclose(tick.torque - rows.lower, 0.05 * robot.effort)
    assert not task.equality and task.variable == "torque" and rows.optional


def test_torque_rates_have_no_bounds_where_there_was_no_last_tick():
    robot = Robot.load("hrp2")
    tick, task = Tick(robot), TorqueRateBounds(robot)
    for torque in (None, np.zeros(robot.na), None):
        tick.torque = torque
        rows = task.rows(tick)
        assert np.isinf(rows.lower).all() == np.isinf(rows.upper).all() == (torque is None)


def test_a_speed_limit_is_met_gradually():
    """Driven as hard as it may be, a joint gets to its speed limit without a step of its acceleration."""
    period, lag, hard, velocity = 0.001, 0.01, 40.0, 3.0
    limits = (np.array([value]) for value in (-100.0, 100.0, velocity, hard, hard))
    bounds, v, before = AccelerationBounds(*limits, speed_lag=lag), 0.0, hard
    for _ in range(200):
        _, (high,) = bounds(np.zeros(1), np.array([v]), period)
        assert before - high <= 1.01 * hard * period / lag
        v, before = v + period * high, high
    assert velocity - 1e-3 < v <= velocity
    _, (high,) = bounds(np.zeros(1), np.array([velocity + 0.1]), period)
    assert high == pytest.approx(-0.1 / lag)
