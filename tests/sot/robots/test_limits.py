"""Limits from the model and from the robot file, and all that neither has told at once."""

import numpy as np
import pytest

from sot.errors import InputError
from tests.sot.robots.variants import load_variant

LIMITS = "[limits]\n"


def test_the_file_overrides_the_model_in_both_libraries(tmp_path):
    """One number for all joints, or a table."""
    given = (
        LIMITS + "armature = 0.05\nlower.LARM6 = -0.5\nupper.LARM6 = 0.4\ndamping.LARM6 = 0.7\nfriction.HEAD0 = 0.9\n"
    )
    robot = load_variant(tmp_path, file=[(LIMITS, given)])
    wrist, head = robot.joints.index("LARM6"), robot.joints.index("HEAD0")
    assert (robot.lower[wrist], robot.upper[wrist]) == (-0.5, 0.4)
    assert robot.damping[wrist] == 0.7 and robot.friction[head] == 0.9
    np.testing.assert_array_equal(robot.armature, 0.05)
    compiled = robot.mujoco_spec().compile()
    np.testing.assert_array_equal(compiled.dof_armature[6:], robot.armature)
    np.testing.assert_array_equal(compiled.dof_damping[6:], robot.damping)
    np.testing.assert_array_equal(compiled.dof_frictionloss[6:], robot.friction)
    np.testing.assert_array_equal(compiled.jnt_range[1:], np.column_stack([robot.lower, robot.upper]))


def test_an_unlimited_joint_turns_half_a_turn_either_way_and_has_no_stop(tmp_path):
    head = 'name="HEAD0" axis="0 0 1" range="-0.7853981634 0.7853981634"'
    robot = load_variant(tmp_path, [(head, 'name="HEAD0" axis="0 0 1"')])
    k = robot.joints.index("HEAD0")
    np.testing.assert_allclose([robot.lower[k], robot.upper[k]], [-np.pi, np.pi])
    compiled = robot.mujoco_spec().compile()
    assert not compiled.jnt_limited[compiled.joint("HEAD0").id]
    assert robot.remarks == ("joints without a range turn by half a turn either way at most: HEAD0",)


def test_all_that_is_missing_is_told_in_one_message(tmp_path):
    knee = 'actuatorfrcrange="-250 250" />'
    motor = '<motor name="RLEG0" joint="RLEG0" ctrlrange="-250 250" />'
    with pytest.raises(InputError) as error:
        load_variant(
            tmp_path,
            [(knee, "/>"), (motor, "")],
            [("[limits.velocity] ", "[limits.effort] "), ("RLEG0 = 2.045\nRLEG1 = 3.272\n", "RLEG1 = 3.272\n")],
        )
    expected = "[limits] lacks 'velocity' of all joints; 'effort' of RLEG0: one number for all joints will do"
    assert expected in str(error.value)


def test_an_effort_that_is_no_limit_is_missing(tmp_path):
    knee = 'actuatorfrcrange="-250 250" />'
    with pytest.raises(InputError, match="lacks 'effort' of RLEG0"):
        load_variant(tmp_path, [(knee, 'actuatorfrcrange="-50000 50000" />')])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("lower = 1.0\nupper = 0.5\n", "joint 'RLEG0' has no room between 1 and 0.5 rad"),
        ("armature.LARM6 = -0.1\n", "'limits.armature' of joint 'LARM6' is -0.1: it cannot be negative"),
        ("velocity.LARM6 = nan\n", "'limits.velocity.LARM6' must be a number, not nan"),
        ("effort = true\n", "'limits.effort' must be a number for all joints or a table by joint, not True"),
        (
            "effort.LARM7 = 3.0\n",
            "'limits.effort' names 'LARM7', which is no joint of the robot (did you mean 'LARM6'?)",
        ),
        ("efort = 3.0\n", "no robot file has 'limits.efort' (did you mean 'effort'?)"),
    ],
)
def test_limits_that_no_joint_can_have_are_refused(tmp_path, given, message):
    changes = [(LIMITS, LIMITS + given)]
    if given.startswith("velocity"):
        changes = [("LARM6 = 3.927", "LARM6 = nan")]
    with pytest.raises(InputError) as error:
        load_variant(tmp_path, file=changes)
    assert message in str(error.value)


def test_left_and_right_that_differ_are_remarked_on(tmp_path):
    given = [(LIMITS, LIMITS + "effort.LLEG3 = 100.0\n")]
    assert load_variant(tmp_path, file=given).remarks == ("effort differs: 100 of LLEG3, 250 of RLEG3",)
