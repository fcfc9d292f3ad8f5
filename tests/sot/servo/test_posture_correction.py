"""Corrected postures against forward kinematics, and the compliance of a leg against the work of its springs."""

import numpy as np
import pinocchio as pin
import pytest

from sot.hardware.compliance import bush_position
from sot.hardware.servo import Servo
from sot.robots.robot import Robot, shipped_robot_names
from sot.servo.posture_correction import PostureCorrection, leg_compliance

FEET = ("left_foot", "right_foot")


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def feet_and_com(robot, q):
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return {foot: data.oMf[robot.point(foot)].copy() for foot in FEET}, pin.centerOfMass(robot.model, data, q)


def test_nothing_to_correct_leaves_the_plan(robot):
    v = np.linspace(-1.0, 1.0, robot.nv)
    targets = PostureCorrection(robot, 0.001)(robot.rest, v, np.zeros(2), {})
    np.testing.assert_allclose(targets.position, robot.rest[7:], atol=1e-12)
    np.testing.assert_allclose(targets.velocity, v[6:], atol=1e-9)


def test_the_centre_of_mass_shifts_over_feet_that_stay(robot):
    shift = np.array([0.008, -0.006])
    correct = PostureCorrection(robot, 0.001)
    for _ in range(10):
        targets = correct(robot.rest, np.zeros(robot.nv), shift, {})
    feet, com = feet_and_com(robot, robot.rest)
    moved, moved_com = feet_and_com(robot, np.concatenate([robot.rest[:7], targets.position]))
    # Seen from a foot, as the base of these targets is free.
    place = feet["left_foot"] * moved["left_foot"].inverse()
    assert pin.log6(feet["right_foot"].inverse() * place * moved["right_foot"]).vector == pytest.approx(0.0, abs=1e-8)
    np.testing.assert_allclose((place.act(moved_com) - com)[:2], shift, atol=1e-6)


def test_a_foot_turns_about_its_bush_and_moves_along_its_axis(robot):
    roll, pitch, height = 0.02, -0.03, -0.002
    correct = PostureCorrection(robot, 0.001)
    for _ in range(10):
        targets = correct(robot.rest, np.zeros(robot.nv), np.zeros(2), {"left_foot": np.array([roll, pitch, height])})
    feet, _ = feet_and_com(robot, robot.rest)
    moved, _ = feet_and_com(robot, np.concatenate([robot.rest[:7], targets.position]))
    seen = feet["right_foot"] * moved["right_foot"].inverse() * moved["left_foot"]
    bush = bush_position(robot, "left_foot")
    off = feet["left_foot"].actInv(seen.act(bush)) - bush
    np.testing.assert_allclose(off, [0.0, 0.0, height], atol=1e-7)
    turn = pin.exp3(np.array([roll, 0.0, 0.0])) @ pin.exp3(np.array([0.0, pitch, 0.0]))
    np.testing.assert_allclose(feet["left_foot"].rotation.T @ seen.rotation, turn, atol=1e-7)


def test_targets_move_at_the_rate_of_their_positions():
    robot, period = Robot.load("hrp2"), 0.001
    correct = PostureCorrection(robot, period)
    before = None
    for k in range(5):
        targets = correct(robot.rest, np.zeros(robot.nv), np.array([1e-4 * k, 0.0]), {})
        if before is not None:
            np.testing.assert_allclose(targets.velocity, (targets.position - before) / period, atol=1e-9)
        before = targets.position


def test_a_leg_s_compliance_is_the_work_that_its_springs_take(robot):
    """A load turns each joint by its lever over kp: the work of all springs is its square times half the compliance."""
    servo = Servo.of(robot)
    compliance = leg_compliance(robot, servo)["right_foot"]
    frame, step, data = robot.point("right_foot"), 1e-6, robot.model.createData()

    def place(q):
        pin.framesForwardKinematics(robot.model, data, q)
        return data.oMf[frame].copy()

    start, levers = place(robot.rest), np.zeros((6, robot.na))
    for joint in range(robot.na):
        q = robot.rest.copy()
        q[7 + joint] += step
        levers[:, joint] = pin.log6(start.inverse() * place(q)).vector / step
    for k, axis in enumerate((3, 4, 2)):
        assert compliance[k] == pytest.approx(float(np.sum(levers[axis] ** 2 / servo.stiffness)), rel=1e-4)
