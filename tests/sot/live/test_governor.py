"""A governed motion keeps range, velocity, acceleration and jerk, and gets to its target."""

import numpy as np
import pytest

from sot.live.governor import JERK_TIME, Governor
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.limits import Limits
from sot.robots.robot import Robot

PERIOD = 0.01


@pytest.fixture(scope="module")
def made():
    robot = Robot.load("hrp2")
    limits = Limits.of(robot)
    return robot, limits, from_configuration(robot.rest[None])[0]


def test_limits_hold_for_targets_that_jump_anywhere(made):
    robot, limits, rest = made
    governor = Governor(robot, limits, rest, PERIOD)
    chance = np.random.default_rng(3)
    fastest, hardest, target = np.zeros(robot.na), np.zeros(robot.nv), rest
    for k in range(600):
        if k % 17 == 0:
            target = rest + chance.normal(size=robot.nv)
        before = governor.ddy
        governor.step(target, chance.normal(size=robot.nv))
        assert (governor.y[6:] >= robot.lower - 0.01).all() and (governor.y[6:] <= robot.upper + 0.01).all()
        fastest = np.maximum(fastest, np.abs(governor.dy[6:]) / robot.velocity)
        hardest = np.maximum(hardest, np.abs(governor.ddy - before) / governor._acceleration)
    assert fastest.max() <= 1.0
    assert hardest.max() <= PERIOD / JERK_TIME + 1e-9


def test_a_target_is_reached_without_overshoot(made):
    robot, limits, rest = made
    governor = Governor(robot, limits, rest, PERIOD)
    target = rest.copy()
    target[6:] = np.clip(rest[6:] + 0.3, limits.lower[6:] + 0.01, limits.upper[6:] - 0.01)
    over = np.zeros(robot.na)
    for _ in range(200):
        governor.step(target, np.zeros(robot.nv))
        over = np.maximum(over, (governor.y - target)[6:])
    assert np.abs(governor.y - target).max() < 1e-3
    assert over.max() < 0.03


def test_a_slow_target_is_followed_without_lag(made):
    robot, limits, rest = made
    governor = Governor(robot, limits, rest, PERIOD)
    joint = 6 + robot.joints.index("LARM0")
    for k in range(400):
        target, velocity = rest.copy(), np.zeros(robot.nv)
        target[joint] += 0.2 * np.sin(3.0 * PERIOD * (k + 1))
        velocity[joint] = 0.6 * np.cos(3.0 * PERIOD * (k + 1))
        governor.step(target, velocity)
        if k > 100:
            assert abs(governor.y[joint] - target[joint]) < 0.01
