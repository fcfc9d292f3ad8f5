"""Redirection near collisions, virtual limits, and the weight of Dariush (14)."""

import numpy as np
import pinocchio as pin
import pytest

from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.resolved.joint_limits import dariush_limit_weights
from tasks.resolved.pairs import Distances
from tasks.resolved.redirection import (
    CRITICAL_DISTANCE,
    CollisionPoints,
    Redirection,
    blending,
    kept_apart,
    point_jacobian,
    upper_body_velocities,
)
from tasks.resolved.virtual_limits import virtual_limits
from tasks.resolved.weighting import LimitWeighting
from tests.sot.states import random_state


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def test_blending_is_figure_9():
    assert blending(0.5, 0.5) == pytest.approx(0.5) and blending(1.0, 1.0) == pytest.approx(0.5)
    assert blending(0.0, 0.5) > 0.999 and blending(1.0, 0.5) < 1e-3
    np.testing.assert_allclose(blending(np.array([0.3]), 0.5), np.exp(3.0) / (1.0 + np.exp(3.0)))


def test_the_jacobian_of_a_point_on_a_body(robot):
    q, v = random_state(robot, np.random.default_rng(1), 0.3)
    tick, frame = Tick(robot), robot.model.frames[robot.point("right_wrist")]
    tick.update(0.0, q, v)
    J = point_jacobian(robot.model, tick.data, frame.parentJoint, tick.frame("right_wrist").position)
    np.testing.assert_allclose(J, tick.frame("right_wrist").jacobian[:3], atol=1e-9)


def near_pair(robot, distance):
    """The right hand at a distance from the chest, by made-up points: the Jacobians are real ones."""
    tick = Tick(robot)
    upper = np.zeros(robot.nv)
    upper[[6 + joint for joint in robot.groups["right_arm"]]] = 1.0
    hand = upper * tick.frame("right_wrist").jacobian[:3]
    return CollisionPoints(distance, np.array([0.0, 1.0, 0.0]), (hand, np.zeros_like(hand)))


def test_as_printed_it_takes_the_motion_along_the_normal_in_both_directions(robot):
    v, points = np.zeros(robot.nv), near_pair(robot, 0.02)
    redirection = Redirection(robot, [], 0.5, 1e-6)
    for towards in (0.4, -0.4):
        v = np.linalg.lstsq(points.jacobians[0], np.array([0.3, towards, 0.0]), rcond=None)[0]
        moved = points.jacobians[0] @ redirection.joint_velocities([points], v)
        np.testing.assert_allclose(moved, [0.3, 0.0, 0.0], atol=1e-6)


def test_mended_it_leaves_motions_apart_alone_and_pushes_out(robot):
    rng, moving = np.random.default_rng(6), upper_body_velocities(robot)
    J, v = rng.standard_normal((3, robot.nv)), rng.uniform(-0.1, 0.1, robot.nv)
    far = Distances([("a", "b")] * 3, np.full(3, 1.0), J, np.zeros(3))
    np.testing.assert_array_equal(kept_apart(far, v, moving, 1e-6), v)
    near = Distances([("a", "b")] * 3, np.array([-0.01, 0.01, 0.5]), J, np.zeros(3))
    kept = kept_apart(near, v, moving, 1e-6)
    rates = J @ kept
    assert rates[0] >= 0.2 - 1e-3 and rates[1] >= -1e-3 and rates[2] >= -4.9 - 1e-3
    np.testing.assert_array_equal(kept[moving == 0.0], v[moving == 0.0])


def test_joints_that_do_not_move_the_points_go_on(robot):
    points, v = near_pair(robot, 0.02), np.random.default_rng(2).uniform(-1.0, 1.0, robot.nv)
    found = Redirection(robot, [], 0.5, 0.1).joint_velocities([points], v)
    others = np.setdiff1d(np.arange(robot.nv), [6 + joint for joint in robot.groups["right_arm"]])
    np.testing.assert_array_equal(found[others], v[others])


def test_far_from_everything_nothing_is_redirected(robot):
    tick, v = Tick(robot), np.random.default_rng(3).uniform(-1.0, 1.0, robot.nv)
    redirection = Redirection(robot, range(len(robot.shapes.collisionPairs)), 0.5, 0.1)
    assert not [found for found in redirection.nearest(tick) if found.distance > 2.0 * CRITICAL_DISTANCE]
    none = Redirection(robot, [], 0.5, 0.1)
    velocities, share, _ = none.blended(tick, v)
    assert share == 0.0
    np.testing.assert_array_equal(velocities, v)


def test_virtual_limits_keep_neighbours_apart(robot):
    lower, upper = virtual_limits(robot)
    assert (lower >= robot.lower).all() and (upper <= robot.upper).all()
    assert (lower < robot.rest[7:] + 1e-9).all() and (upper > robot.rest[7:] - 1e-9).all()


def test_dariush_14_is_one_away_from_limits(robot):
    middle, v = 0.5 * (robot.lower + robot.upper), np.ones(robot.na)
    np.testing.assert_array_equal(dariush_limit_weights(middle, v, robot.lower, robot.upper), 1.0)
    q = pin.neutral(robot.model)
    q[7:] = robot.upper - 0.01
    tick = Tick(robot).update(0.0, q, np.append(np.zeros(6), v))
    none = Distances([], np.zeros(0), np.zeros((0, robot.nv)), np.zeros(0))
    weights = LimitWeighting(robot, robot.lower, robot.upper)(tick, none).matrix
    assert (np.diag(weights)[:6] == 1.0).all() and (np.diag(weights)[6:] > 100.0).all()
