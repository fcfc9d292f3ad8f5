from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.gravity import GRAVITY
from sot.motion.balance.torques import Overload, overload_remark, overloads, planned_torques
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.spline import Spline
from sot.motion.feet.contacts import Phase, planted_phases
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def still(robot, count=5):
    """Times, and the rest posture held at them: q, v, a."""
    return np.arange(count) * 0.02, np.tile(robot.rest, (count, 1)), *(np.zeros((count, robot.nv)) for _ in range(2))


def test_torques_and_wrenches_move_the_robot_as_planned(robot):
    """On one foot the wrench is what the base needs; together with the torques it gives the accelerations."""
    rng = np.random.default_rng(3)
    frictionless = replace(robot, damping=np.zeros(robot.na), friction=np.zeros(robot.na))
    alone = [Phase(0.0, 1.0, {"left_foot": planted_phases(robot, 1.0)[0].feet["left_foot"]})]
    v, a = (rng.normal(size=(1, robot.nv)) for _ in range(2))
    (torques,) = planned_torques(frictionless, alone, np.zeros(1), robot.rest[None], v, a)
    model, data = robot.model, robot.model.createData()
    force = pin.rnea(model, data, robot.rest, v[0], a[0]) - np.concatenate([np.zeros(6), torques])
    J = pin.computeFrameJacobian(model, data, robot.rest, robot.point("left_foot"), pin.LOCAL_WORLD_ALIGNED)
    wrench = np.linalg.lstsq(J.T, force, rcond=None)[0]
    np.testing.assert_allclose(J.T @ wrench, force, atol=1e-8)


def test_both_feet_share_the_weight(robot):
    """Of the weight on one foot alone, each leg of two takes less: its knee holds less."""
    times, *motion = still(robot)
    knees = [robot.joints.index(name) for name in ("RLEG3", "LLEG3")]
    both = planned_torques(robot, planted_phases(robot, 1.0), times, *motion)
    alone = [Phase(0.0, 1.0, {"left_foot": planted_phases(robot, 1.0)[0].feet["left_foot"]})]
    left = planned_torques(robot, alone, times, *motion)
    assert both[0, knees[0]] == pytest.approx(both[0, knees[1]], rel=0.05)
    assert abs(left[0, knees[1]]) > 1.5 * abs(both[0, knees[1]])
    assert np.abs(both).max() < robot.mass * GRAVITY * 0.2


def test_weak_joints_are_overloaded_and_named(robot):
    knee = robot.joints.index("LLEG3")
    effort = robot.effort.copy()
    effort[knee] = 5.0
    weak = replace(robot, effort=effort)
    body = Spline.through(np.tile(from_configuration(robot.rest[None]), (20, 1)), 0.02)
    phases = planted_phases(robot, 1.0)
    assert overloads(robot, phases, body) == []
    (found,) = overloads(weak, phases, body)
    assert found.joint == "LLEG3" and found.ratio > 1.5 and found.share == 1.0
    assert "LLEG3" in overload_remark([found])
    assert "and 2 more" in overload_remark([Overload(f"J{k}", 1.2, 0.1) for k in range(8)])
