"""A misreading is refused, whatever it is."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.robots.reading.agreement import pinocchio_reading, refuse_difference
from sot.robots.robot import Robot


def readings(change) -> tuple:
    """Of the robot, and of one whose Pinocchio model is changed, in one pose."""
    robot = Robot.load("hrp2")
    model = robot.model.copy()
    change(model, model.getJointId("RARM3"))
    angles = robot.rest[7:] + 0.1
    return tuple(pinocchio_reading(m, robot.joints, angles) for m in (robot.model, model))


def shift_a_joint(model, joint):
    model.jointPlacements[joint] = model.jointPlacements[joint] * pin.SE3(np.eye(3), np.array([0.0, 0.001, 0.0]))


def turn_a_joint(model, joint):
    turn = pin.rpy.rpyToMatrix(0.0, 0.0, 0.002)
    model.jointPlacements[joint] = model.jointPlacements[joint] * pin.SE3(turn, np.zeros(3))


def add_mass(model, joint):
    inertia = model.inertias[joint]
    model.inertias[joint] = pin.Inertia(inertia.mass + 0.01, inertia.lever, inertia.inertia)


def shift_mass(model, joint):
    inertia = model.inertias[joint]
    model.inertias[joint] = pin.Inertia(inertia.mass, inertia.lever + np.array([0.0, 0.0, 0.01]), inertia.inertia)


def turn_inertia(model, joint):
    inertia = model.inertias[joint]
    model.inertias[joint] = pin.Inertia(inertia.mass, inertia.lever, inertia.inertia + np.diag([0.0, 1e-3, 0.0]))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (shift_a_joint, "link 'RARM3_LINK' is read 0.000"),
        (turn_a_joint, "link 'RARM3_LINK' is read 0.00"),
        (add_mass, "the mass is read wrong, by 0.01 of 58"),
        (shift_mass, "the centre of mass is read wrong"),
        (turn_inertia, "the mass matrix is read wrong"),
    ],
)
def test_a_difference_is_named(change, message):
    ours, theirs = readings(change)
    with pytest.raises(InputError) as error:
        refuse_difference(Path("hrp2.xml"), theirs, ours)
    assert message in str(error.value)


def test_what_is_not_a_number_is_a_difference():
    ours, theirs = readings(lambda model, joint: None)
    refuse_difference(Path("hrp2.xml"), ours, theirs)
    with pytest.raises(InputError, match="the mass is read wrong"):
        refuse_difference(Path("hrp2.xml"), replace_mass(ours), theirs)


def replace_mass(reading):
    return reading._replace(mass=float("nan"))
