"""Every gradient of resolved acceleration against finite differences; what the printed weights do at their ends."""

import coal
import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.resolved.collisions import CollisionFunction, collision_gradient, printed_collision_weights
from tasks.resolved.joint_limits import limit_curvature, limit_gradient, limit_potential, printed_limit_weights
from tasks.resolved.orientation import angular_velocity, euler_rate_matrix, orientation_error
from tasks.resolved.pairs import NearestPairs, Obstacle
from tests.sot.states import random_state

LOWER, UPPER = np.array([-2.0, 0.0]), np.array([1.0, 0.5])


def slope(function, x, step=1e-6):
    return (function(x + step) - function(x - step)) / (2.0 * step)


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.mark.parametrize("share", [-0.05, 0.02, 0.3, 0.5, 0.9, 1.1])
def test_limit_gradient_and_curvature(share):
    q = LOWER + share * (UPPER - LOWER)
    numeric = slope(lambda x: limit_potential(x, LOWER, UPPER), q)
    np.testing.assert_allclose(limit_gradient(q, LOWER, UPPER), numeric, rtol=1e-5, atol=1e-6)
    numeric = slope(lambda x: limit_gradient(x, LOWER, UPPER), q)
    np.testing.assert_allclose(limit_curvature(q, LOWER, UPPER), numeric, rtol=1e-5)


def test_printed_limit_weights_slow_down_inside_and_are_inverted_outside():
    towards, away = np.array([1.0, 1.0]), np.array([-1.0, -1.0])
    near, beyond = UPPER - 0.01, UPPER + 0.01
    assert (printed_limit_weights(near, towards, LOWER, UPPER) > 500.0).all()
    assert (printed_limit_weights(near, away, LOWER, UPPER) == 0.0).all()
    assert (printed_limit_weights(beyond, towards, LOWER, UPPER) == 0.0).all()
    assert (printed_limit_weights(beyond, away, LOWER, UPPER) > 500.0).all()


def test_collision_function_slope_and_curvature():
    g, d = CollisionFunction(), np.array([0.003, 0.02, 0.1, -0.01])
    np.testing.assert_allclose(g.slope(d), slope(g, d, 1e-7), rtol=1e-4)
    np.testing.assert_allclose(g.curvature(d), slope(g.slope, d, 1e-7), rtol=1e-4)
    # Below a distance of 0 it falls again: deeper in, less weight.
    assert abs(g.slope(np.array([-0.03]))[0]) < abs(g.slope(np.array([-0.01]))[0])


def test_collision_gradient_and_its_weights(robot):
    tick, pairs, g = Tick(robot), NearestPairs(robot, 4, 1.0), CollisionFunction()
    rng = np.random.default_rng(2)
    q, v = random_state(robot, rng, 0.3)
    found = pairs(tick.update(0.0, q, v))
    assert len(found.values) == 4 and (np.diff(found.values) >= 0.0).all()
    gradient = collision_gradient(g, found.values, found.jacobian)

    def measured(step):
        there = NearestPairs(robot, 1000, 2.0)(tick.update(0.0, pin.integrate(robot.model, q, step * v), v))
        known = dict(zip(there.pairs, there.values, strict=True))
        return g(np.array([known[pair] for pair in found.pairs]))

    numeric = (measured(1e-5) - measured(-1e-5)) / 2e-5
    np.testing.assert_allclose(gradient @ v, numeric, rtol=1e-3, atol=1e-3 * np.abs(gradient).max())
    weights = printed_collision_weights(g, found.values, found.jacobian, v)
    approaching = found.jacobian @ v <= 0.0
    np.testing.assert_allclose(weights, np.abs(gradient[approaching]).sum(axis=0) / 4)
    assert not printed_collision_weights(g, found.values[:0], found.jacobian[:0], v).any()


def test_distances_from_the_environment(robot):
    wall = Obstacle("wall", coal.Box(0.02, 4.0, 4.0), pin.SE3(np.eye(3), np.array([0.6, 0.0, 0.9])))
    pairs, tick = NearestPairs(robot, 200, 3.0, 0.0, [wall]), Tick(robot)
    q, v = random_state(robot, np.random.default_rng(3), 0.1)

    def of_wall(step):
        found = pairs(tick.update(0.0, pin.integrate(robot.model, q, step * v), v))
        return {
            p[0]: (d, J @ v)
            for p, d, J in zip(found.pairs, found.values, found.jacobian, strict=True)
            if p[1] == "wall"
        }

    now, after, before = of_wall(0.0), of_wall(1e-5), of_wall(-1e-5)
    assert len(now) > 4
    for name, (_, rate) in now.items():
        assert rate == pytest.approx((after[name][0] - before[name][0]) / 2e-5, abs=2e-3)


def test_orientation_error_is_the_axis_times_the_sine():
    rng = np.random.default_rng(4)
    for _ in range(20):
        start, turn = Rotation.random(random_state=rng), rng.uniform(-1.5, 1.5, 3)
        wanted = Rotation.from_rotvec(turn) * start
        angle = np.linalg.norm(turn)
        error = orientation_error(start.as_matrix(), wanted.as_matrix())
        np.testing.assert_allclose(error, turn / angle * np.sin(angle), atol=1e-12)


def test_euler_rates_and_angular_velocity():
    rng = np.random.default_rng(5)
    angles, rates, step = rng.uniform(-1.0, 1.0, 3), rng.uniform(-1.0, 1.0, 3), 1e-6

    def rotation(at):
        return Rotation.from_euler("ZYX", at[::-1]).as_matrix()

    R_rate = (rotation(angles + step * rates) - rotation(angles - step * rates)) / (2.0 * step)
    omega = angular_velocity(rotation(angles), R_rate)
    np.testing.assert_allclose(euler_rate_matrix(angles) @ rates, omega, atol=1e-8)
