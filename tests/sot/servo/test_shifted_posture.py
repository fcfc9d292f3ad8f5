"""Postures with the centre of mass elsewhere: what moves, what stays, what cannot be."""

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.robots.robot import Robot
from sot.servo.shifted_posture import shifted_posture


@pytest.mark.parametrize("name", ["hrp2", "g1"])
def test_the_centre_of_mass_goes_over_a_foot_while_the_other_is_lifted(name):
    robot = Robot.load(name)
    model, data = robot.model, robot.model.createData()
    com = pin.centerOfMass(model, data, robot.rest).copy()
    pin.framesForwardKinematics(model, data, robot.rest)
    before = {point: data.oMf[robot.point(point)].copy() for point in ("waist", *robot.feet)}
    shift = before["left_foot"].translation[:2] - com[:2]
    lift = np.array([0.0, 0.0, 0.05])
    q = shifted_posture(robot, robot.rest, shift, {"right_foot": lift})
    np.testing.assert_allclose(pin.centerOfMass(model, data, q)[:2], com[:2] + shift, atol=1e-4)
    pin.framesForwardKinematics(model, data, q)
    after = {point: data.oMf[robot.point(point)] for point in before}
    for point, moved in {"left_foot": np.zeros(3), "right_foot": lift}.items():
        np.testing.assert_allclose(after[point].translation, before[point].translation + moved, atol=1e-4)
        np.testing.assert_allclose(after[point].rotation, before[point].rotation, atol=1e-4)
    np.testing.assert_allclose(after["waist"].rotation, before["waist"].rotation, atol=1e-4)
    assert after["waist"].translation[2] == pytest.approx(before["waist"].translation[2], abs=1e-4)
    above = [k for k in range(robot.na) if k not in robot.groups["legs"]]
    np.testing.assert_array_equal(q[7:][above], robot.rest[7:][above])


def test_what_legs_do_not_reach_is_refused():
    robot = Robot.load("hrp2")
    with pytest.raises(InputError, match="legs do not reach"):
        shifted_posture(robot, robot.rest, np.array([0.9, 0.0]), {})
