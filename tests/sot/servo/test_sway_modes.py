"""The sway of a whole robot on its bushes against a pendulum, and the refusal of bushes that cannot carry it."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.hardware.compliance import FootCompliance, bush_position
from sot.hardware.servo import Servo
from sot.robots.robot import Robot
from sot.servo.pendulum import Pendulum
from sot.servo.shifted_posture import shifted_posture
from sot.servo.sway_modes import FloorContact, inertia_about_com, sway_modes


@pytest.fixture(scope="module", params=["hrp2", "g1"])
def robot(request):
    return Robot.load(request.param)


def balanced(robot: Robot, feet) -> tuple[np.ndarray, float]:
    """A posture with the weight over the bushes of feet, and the height of the centre of mass above them."""
    data = robot.model.createData()
    com = pin.centerOfMass(robot.model, data, robot.rest).copy()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    bushes = [data.oMf[robot.point(foot)].act(bush_position(robot, foot)) for foot in feet]
    q = shifted_posture(robot, robot.rest, np.mean(bushes, axis=0)[:2] - com[:2], {})
    return q, float(pin.centerOfMass(robot.model, data, q)[2] - bushes[0][2])


def test_stiff_servos_leave_the_pendulum_with_inertia(robot):
    """Along x on two feet: K of two bushes, inertia about the centre of mass, damping of two bushes."""
    q, length = balanced(robot, robot.feet)
    stiffness = 3.0 * robot.mass * GRAVITY * length
    compliance = FootCompliance(stiffness, stiffness)
    found, _ = sway_modes(robot, q, robot.feet, Servo.of(robot).scaled(1e4), compliance)
    loss = compliance.relaxation_time(robot)
    inertia = inertia_about_com(robot, q)[1]
    pendulum = Pendulum(robot.mass, length, 2.0 * stiffness, 2.0 * stiffness * loss, inertia)
    assert 2.0 * np.pi * found.frequency == pytest.approx(pendulum.natural_frequency, rel=0.01)
    assert found.damping_ratio == pytest.approx(pendulum.damping_ratio, rel=0.03)


def test_servos_in_series_slow_the_sway_down(robot):
    q, length = balanced(robot, robot.feet)
    stiffness = 3.0 * robot.mass * GRAVITY * length
    compliance = FootCompliance(stiffness, stiffness, 100.0 * stiffness)
    stiff, soft = (sway_modes(robot, q, robot.feet, Servo.of(robot).scaled(scale), compliance) for scale in (10.0, 0.5))
    assert all(slow.frequency < 0.97 * fast.frequency for slow, fast in zip(soft, stiff, strict=True))


def test_a_floor_that_gives_way_is_a_spring_in_series(robot):
    """Bush and floor of twice the stiffness each, with the same damping over it, are the bush alone."""
    q, length = balanced(robot, robot.feet)
    stiffness = 3.0 * robot.mass * GRAVITY * length
    alone, half = (FootCompliance(*(k * stiffness * np.array([1.0, 1.0, 100.0]))) for k in (1.0, 2.0))
    time = half.relaxation_time(robot)
    floor = FloorContact(2.0 * stiffness * np.array([1.0, 1.0, 100.0]), time)
    servo = Servo.of(robot)
    expected = sway_modes(robot, q, robot.feet, servo, alone)
    found = sway_modes(robot, q, robot.feet, servo, half, dict.fromkeys(robot.feet, floor))
    np.testing.assert_allclose(found, expected, rtol=1e-4)


def test_bushes_softer_than_the_weight_tips_them_are_refused(robot):
    q, length = balanced(robot, robot.feet)
    falling = robot.mass * GRAVITY * length
    with pytest.raises(InputError, match="too soft"):
        sway_modes(robot, q, robot.feet, Servo.of(robot), FootCompliance(0.45 * falling, 0.45 * falling))
    sway_modes(robot, q, robot.feet, Servo.of(robot), FootCompliance(0.6 * falling, 0.6 * falling, 1e6))


def test_inertia_is_that_about_the_centre_of_mass(robot):
    """König: kinetic energy of the robot turned as one about its centre of mass."""
    model, data = robot.model, robot.model.createData()
    com = pin.centerOfMass(model, data, robot.rest).copy()
    for axis in range(2):
        v = np.zeros(robot.nv)
        v[3 + axis] = 1.0
        v[:3] = np.cross(v[3:6], robot.rest[:3] - com)
        energy = 0.5 * inertia_about_com(robot, robot.rest)[axis]
        without_rotors = replace(robot, model=model.copy())
        without_rotors.model.armature[:] = 0.0
        assert pin.computeKineticEnergy(without_rotors.model, data, robot.rest, v) == pytest.approx(energy, rel=1e-9)
