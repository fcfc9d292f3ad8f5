"""Gains of joint servos."""

from dataclasses import replace

import numpy as np
import pytest

from sot.errors import InputError
from sot.hardware.servo import FULL_TORQUE_ERROR, ROTOR_INERTIA_RATIO, Servo
from sot.robots.robot import Robot
from tests.sot.robots import variants


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def test_stiff_for_the_weight_below_and_for_the_motor_above_with_a_rotor_critically_damped(robot):
    servo = Servo.of(robot)
    above = [*robot.groups["arms"], *robot.groups["head"]]
    np.testing.assert_allclose(servo.stiffness[above] * FULL_TORQUE_ERROR, robot.effort[above])
    np.testing.assert_allclose(servo.damping**2, 4.0 * servo.stiffness * robot.armature)
    np.testing.assert_allclose(servo.stiffness[[*robot.groups["legs"], *robot.groups["chest"]]], 20000.0, rtol=0.01)
    np.testing.assert_array_equal(np.unique(servo.period[list(robot.groups["legs"])]), [0.005])
    np.testing.assert_array_equal(np.unique(servo.period[[*robot.groups["arms"], *robot.groups["chest"]]]), [0.01])


def test_a_robot_whose_model_has_no_rotors_is_damped_too(robot):
    bare = Servo.of(replace(robot, armature=np.zeros(robot.na)))
    np.testing.assert_allclose(bare.damping**2, 4.0 * bare.stiffness * ROTOR_INERTIA_RATIO * robot.effort)
    np.testing.assert_allclose(bare.rotor, ROTOR_INERTIA_RATIO * robot.effort)
    np.testing.assert_array_equal(Servo.of(robot).rotor, robot.armature)


def test_gains_of_the_robot_file_count(robot, tmp_path):
    text = "[servo]\nstiffness = { RLEG0 = 5000.0 }\ndamping = 12.0\n\n[groups]"
    servo = Servo.of(variants.load_variant(tmp_path, file=[("[groups]", text)]))
    expected = Servo.of(robot).stiffness.copy()
    expected[robot.joints.index("RLEG0")] = 5000.0
    np.testing.assert_allclose(servo.stiffness, expected)
    np.testing.assert_allclose(servo.damping, 12.0)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("stiffness = 0", r"'servo.stiffness' of joint 'RLEG0' is 0: it must be positive"),
        ("stiffness = { LEG = 1 }", "names 'LEG', which is no joint"),
        ("damping = 'much'", "must be a number for all joints or a table by joint"),
        ("stifness = 1", r"no robot file has 'servo.stifness' \(did you mean 'stiffness'\?\)"),
    ],
)
def test_bad_gains_of_a_file_are_refused(text, expected, tmp_path):
    with pytest.raises(InputError, match=expected):
        variants.load_variant(tmp_path, file=[("[groups]", f"[servo]\n{text}\n\n[groups]")])


def test_scaled_servos_damp_their_rotors_alike(robot):
    servo = Servo.of(robot).scaled(0.25)
    np.testing.assert_allclose(servo.damping**2, 4.0 * servo.stiffness * robot.armature)
    np.testing.assert_allclose(servo.stiffness, 0.25 * Servo.of(robot).stiffness)
