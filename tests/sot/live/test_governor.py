"""A governed motion keeps range, velocity, acceleration and jerk, and gets to its target."""

import numpy as np
import pinocchio as pin
import pytest

from sot.gravity import GRAVITY
from sot.live.governor import JERK_TIME, Governor
from sot.live.led_legs import LedLegs
from sot.live.state import pinocchio_state
from sot.motion.body.coordinates import from_configuration, to_configuration
from sot.motion.body.limits import Limits
from sot.motion.feet.contacts import planted_phases
from sot.polygon import Polygon
from sot.robots.robot import Robot

PERIOD = 0.01


@pytest.fixture(scope="module")
def made():
    robot = Robot.load("hrp2")
    (phase,) = planted_phases(robot, 1.0)
    rest = from_configuration(robot.rest[None])[0]
    return robot, lambda: Governor(robot, Limits.of(robot), LedLegs(robot, phase, rest), rest, PERIOD), rest


def com_of(robot, q):
    return pin.centerOfMass(robot.model, robot.model.createData(), q)[:2].copy()


def stays(robot):
    """A plan on which the centre of mass is at rest."""
    return np.stack([com_of(robot, robot.rest), np.zeros(2), np.zeros(2)])


def test_limits_hold_for_targets_that_jump_anywhere(made):
    robot, start, rest = made
    governor = start()
    chance = np.random.default_rng(3)
    fastest, hardest, target = np.zeros(robot.na), np.zeros(robot.nv), rest
    for k in range(600):
        if k % 17 == 0:
            target = rest + chance.normal(size=robot.nv)
        before = governor.ddy
        governor.step(target, chance.normal(size=robot.nv), stays(robot))
        assert (governor.y[6:] >= robot.lower - 0.01).all() and (governor.y[6:] <= robot.upper + 0.01).all()
        fastest = np.maximum(fastest, np.abs(governor.dy[6:]) / robot.velocity)
        hardest = np.maximum(hardest, np.abs(governor.ddy - before) / governor._acceleration)
    legs = governor._legs.columns
    assert fastest.max() <= 1.0
    assert np.delete(hardest, legs).max() <= PERIOD / JERK_TIME + 1e-9


def test_a_target_is_reached_without_overshoot(made):
    robot, start, rest = made
    governor = start()
    target = rest.copy()
    legs, limits = governor._legs.columns, Limits.of(robot)
    target[6:] = np.clip(rest[6:] + 0.3, limits.lower[6:] + 0.01, limits.upper[6:] - 0.01)
    over = np.zeros(robot.nv)
    for _ in range(200):
        governor.step(target, np.zeros(robot.nv), stays(robot))
        over = np.maximum(over, governor.y - target)
    other = np.delete(np.arange(robot.nv), [0, 1, *legs])
    assert np.abs(governor.y - target)[other].max() < 1e-3
    assert over[other].max() < 0.03


def test_a_slow_target_is_followed_without_lag(made):
    robot, start, rest = made
    governor = start()
    joint = 6 + robot.joints.index("LARM0")
    for k in range(400):
        target, velocity = rest.copy(), np.zeros(robot.nv)
        target[joint] += 0.2 * np.sin(3.0 * PERIOD * (k + 1))
        velocity[joint] = 0.6 * np.cos(3.0 * PERIOD * (k + 1))
        governor.step(target, velocity, stays(robot))
        if k > 100:
            assert abs(governor.y[joint] - target[joint]) < 0.01


def test_the_centre_of_mass_goes_along_its_plan_whatever_the_trunk_does(made):
    robot, start, rest = made
    governor, target, plan, T = start(), rest.copy(), stays(robot), PERIOD
    for k in range(300):
        target[4] = rest[4] + 0.3 * np.sin(2.0 * T * k)
        target[6 + np.array(robot.groups["chest"])] = 0.2 * np.sin(3.0 * T * k)
        curve = 0.02 * np.sin(T * (k + 1)) * np.ones(2)
        governor.step(target, np.zeros(robot.nv), np.stack([plan[0], plan[1], curve]))
        place = plan[0] + T * plan[1] + T**2 * (plan[2] / 3.0 + curve / 6.0)
        plan = np.stack([place, plan[1] + 0.5 * T * (plan[2] + curve), curve])
        assert np.abs(com_of(robot, to_configuration(governor.y[None])[0]) - plan[0]).max() < 1e-3
    assert plan[0][0] - stays(robot)[0][0] > 0.02


def zmp_of(robot, governor):
    """The zero-moment point (2,) of what a governor has its robot do now, the centre of mass at rest."""
    q, v, a = pinocchio_state(governor.y, governor.dy, governor.ddy)
    data = robot.model.createData()
    pin.computeCentroidalMomentumTimeVariation(robot.model, data, q, v, a)
    turn = data.dhg.angular
    return data.com[0][:2] - np.array([turn[1], -turn[0]]) / (robot.mass * GRAVITY)


@pytest.mark.parametrize("angle", [3, 4])
def test_a_pelvis_gives_way_where_its_turn_would_take_the_zero_moment_point_out_of_its_room(made, angle):
    robot, start, rest = made
    plan, beyond = stays(robot), {}
    edges = np.vstack([np.eye(2), -np.eye(2)])
    room = Polygon(edges, edges @ plan[0] + 0.01)
    for given in (None, room):
        governor, target, out = start(), rest.copy(), []
        for k in range(100):
            target[angle] = rest[angle] + 0.1 * (k < 50)
            governor.step(target, np.zeros(robot.nv), plan, given)
            out.append(-room.margin(zmp_of(robot, governor)))
        beyond[given is not None] = max(out)
        assert np.abs(governor.y[3:6] - target[3:6]).max() < 0.01, "it gets there all the same"
    assert beyond[False] > 0.01, "else nothing was to be given way for"
    assert beyond[True] < 0.7 * beyond[False]
