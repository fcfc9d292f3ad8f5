"""Gains of joint servos."""

import numpy as np
import pytest

from sot.hardware.servo import FULL_TORQUE_ERROR, ROTOR_INERTIA_RATIO, Servo
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def test_full_torque_at_a_small_error_and_a_rotor_critically_damped(robot):
    servo = Servo.of(robot)
    np.testing.assert_allclose(servo.stiffness * FULL_TORQUE_ERROR, robot.effort)
    np.testing.assert_allclose(servo.damping**2, 4.0 * servo.stiffness * robot.armature)
    np.testing.assert_allclose(servo.stiffness[list(robot.groups["legs"])], 20000.0)
    np.testing.assert_array_equal(np.unique(servo.period[list(robot.groups["legs"])]), [0.005])
    np.testing.assert_array_equal(np.unique(servo.period[[*robot.groups["arms"], *robot.groups["chest"]]]), [0.01])


def test_a_robot_whose_model_has_no_rotors_is_damped_too(robot):
    from dataclasses import replace

    bare = Servo.of(replace(robot, armature=np.zeros(robot.na)))
    np.testing.assert_allclose(bare.damping**2, 4.0 * bare.stiffness * ROTOR_INERTIA_RATIO * robot.effort)


def test_scaled_servos_damp_their_rotors_alike(robot):
    servo = Servo.of(robot).scaled(0.25)
    np.testing.assert_allclose(servo.damping**2, 4.0 * servo.stiffness * robot.armature)
    np.testing.assert_allclose(servo.stiffness, 0.25 * Servo.of(robot).stiffness)
