"""Posture: joints that follow a reference."""

import numpy as np
import pytest

from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots.robot import Robot, shipped_robot_names
from tasks import Posture
from tests.sot.states import random_state
from tests.tasks.checks import assert_jacobian_and_drift, followed


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def moving(robot):
    shape = np.linspace(0.1, 0.3, robot.na)
    rest = robot.rest[7:]
    return lambda t: (rest + shape * np.sin(3 * t), 3 * shape * np.cos(3 * t), -9 * shape * np.sin(3 * t))


@pytest.mark.parametrize("joints", [None, "left_arm", ["LARM3", "RLEG2"]])
def test_jacobian_and_drift(robot, joints):
    rng = np.random.default_rng(0)
    for _ in range(3):
        task = Posture(robot, rng.uniform(-1, 1, robot.na), joints)
        assert_jacobian_and_drift(task, Tick(robot), *random_state(robot, rng))


def test_joints_are_selected_by_group_by_name_or_all(robot):
    target, tick = robot.rest[7:] + np.arange(robot.na), Tick(robot)
    for joints, expected in (
        (None, range(robot.na)),
        ("legs", robot.groups["legs"]),
        (["RARM2", "LLEG0"], [robot.joints.index("RARM2"), robot.joints.index("LLEG0")]),
    ):
        task = Posture(robot, target, joints)
        rows = task.rows(tick)
        np.testing.assert_allclose(task.error, list(expected))  # reference minus measured
        np.testing.assert_array_equal(rows.A @ np.arange(robot.nv), 6 + np.array(expected))


@pytest.mark.parametrize("feedforward", [True, False])
def test_rows_are_the_wanted_accelerations(robot, feedforward):
    reference, (q, v) = moving(robot), random_state(robot, np.random.default_rng(1))
    rows = Posture(robot, reference, kp=30.0, kd=4.0, feedforward=feedforward).rows(Tick(robot).update(0.7, q, v))
    position, velocity, acceleration = reference(0.7)
    wanted = acceleration * feedforward + 30.0 * (position - q[7:]) + 4.0 * (velocity - v[6:])
    np.testing.assert_allclose(rows.lower, wanted)
    np.testing.assert_array_equal(rows.upper, rows.lower)


def test_damping_is_critical_unless_given(robot):
    assert Posture(robot, robot.rest[7:], kp=49.0).kd == pytest.approx(14.0)


def test_a_moving_reference_is_reached_and_followed(robot):
    errors = followed(Posture(robot, moving(robot)), robot, *random_state(robot, np.random.default_rng(2)), 1.5, 0.005)
    assert np.linalg.norm(errors[0]) > 0.5
    assert np.linalg.norm(errors[-1]) < 5e-3


def test_unknown_joints_and_wrong_gains_are_refused(robot):
    with pytest.raises(InputError, match=r"no joint group 'tail': it has left_leg"):
        Posture(robot, robot.rest[7:], "tail")
    with pytest.raises(InputError, match="no joint 'TAIL1'"):
        Posture(robot, robot.rest[7:], ["LARM1", "TAIL1"])
    with pytest.raises(ValueError, match="gains must not be negative"):
        Posture(robot, robot.rest[7:], kp=-1.0)
    with pytest.raises(ValueError, match="weight must be positive"):
        Posture(robot, robot.rest[7:], weight=0.0)
