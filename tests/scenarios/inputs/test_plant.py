"""Plants as one asks for them."""

from math import inf

import pytest

from scenarios.inputs.plant import hardware_of, parse_feet_compliance
from sot.errors import InputError
from sot.hardware.compliance import FootCompliance
from sot.robots.robot import Robot


def test_compliance_is_roll_pitch_and_height():
    assert parse_feet_compliance("707,502") == FootCompliance(roll=707.0, pitch=502.0, vertical=inf)
    assert parse_feet_compliance("707, 502, 2.4e5") == FootCompliance(707.0, 502.0, 2.4e5)


@pytest.mark.parametrize("text", ["", "1", "1,2,3,4", "a,b", "1,-2", "nan,1", "1,2,inf", "1,2,0"])
def test_anything_else_is_refused(text):
    with pytest.raises(InputError, match="--feet-compliance"):
        parse_feet_compliance(text)


def test_torque_motors_have_no_servos_and_servos_have_sensors():
    robot, soft = Robot.load("hrp2"), FootCompliance(2500.0, 2500.0)
    torque, servo = hardware_of(robot, "torque", soft), hardware_of(robot, "servo", None)
    assert (torque.servo, torque.compliance, torque.sensors) == (None, soft, None)
    assert servo.servo is not None and servo.compliance is None and servo.sensors is not None
