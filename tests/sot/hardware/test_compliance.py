"""Feet on rubber: numbers that make sense, and where a sole goes."""

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.hardware.compliance import FootCompliance, bush_position, pendulum_length, sole_in_foot
from sot.robots.robot import Robot


@pytest.mark.parametrize(
    "bad", [(0.0, 1.0), (1.0, -1.0), (np.nan, 1.0), (1.0, np.inf), (1.0, 1.0, 0.0), (1.0, 1.0, 1.0, -1.0)]
)
def test_bad_numbers(bad):
    with pytest.raises(InputError, match="foot compliance"):
        FootCompliance(*bad)


def test_the_bush_is_under_the_ankle_and_its_damping_goes_by_the_length_of_the_pendulum():
    robot = Robot.load("hrp2")
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    for side in ("left", "right"):
        bush = data.oMf[robot.point(f"{side}_foot")].act(bush_position(robot, f"{side}_foot"))
        ankle = data.oMf[robot.point(f"{side}_ankle")].translation
        np.testing.assert_allclose(bush, ankle * (1.0, 1.0, 1.0 / 3.0), atol=1e-6)
    length = pendulum_length(robot)
    com = pin.centerOfMass(robot.model, data, robot.rest)[2]
    assert length == pytest.approx(com - ankle[2] / 3.0, abs=1e-6)
    assert FootCompliance(1.0, 1.0, loss=0.1).relaxation_time(robot) == pytest.approx(0.1 * np.sqrt(length / 9.81))


def test_a_sole_turns_about_its_bush():
    bush = np.array([0.1, -0.2, 0.03])
    turned = sole_in_foot(bush, np.array([0.2, -0.1, 0.0]))
    np.testing.assert_allclose(turned.act(bush), bush, atol=1e-15)
    risen = sole_in_foot(bush, np.array([0.0, 0.0, 0.01])).act(bush)
    np.testing.assert_allclose(risen - bush, [0.0, 0.0, 0.01], atol=1e-15)
    x, y = pin.exp3(np.array([0.2, 0.0, 0.0])), pin.exp3(np.array([0.0, -0.1, 0.0]))
    np.testing.assert_allclose(turned.rotation, x @ y, atol=1e-15)
