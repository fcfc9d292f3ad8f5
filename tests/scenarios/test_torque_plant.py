"""Torque control is what it was before there were servos: none of their code has a say in it."""

from functools import partial

import numpy as np

from scenarios.replay import Replay, _default_stack, run_motion
from sim.hardware import assembly, sensor_suite, servo_drive, soles
from sim.world import World
from sot.hardware.servo import Servo
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.stabiliser import Stabiliser


def torques() -> np.ndarray:
    motion = Motion.standing(Robot.load("hrp2"), 0.1, 500.0)
    return run_motion(
        Replay("", rate=500.0), partial(_default_stack, "dcm"), motion, None, lambda words, share: None
    ).run.log.torque


def test_no_code_of_servos_soles_and_sensors_is_called(monkeypatch):
    expected = torques()

    def refuse(*arguments: object, **named: object) -> None:
        raise AssertionError("torque control called it")

    for owner, name in (
        *((sensor_suite.SensorSuite, "__init__"), (sensor_suite, "add_sensors")),
        *((servo_drive.ServoDrive, "__init__"), (servo_drive, "add_servos")),
        *((soles, "tree_with_soles"), (soles, "add_bushes"), (Servo, "of"), (Stabiliser, "__init__")),
    ):
        monkeypatch.setattr(owner, name, refuse)
    for name in ("add_sensors", "add_servos", "tree_with_soles", "add_bushes"):
        monkeypatch.setattr(assembly, name, refuse)
    found = torques()
    assert np.abs(found).max() > 1.0
    np.testing.assert_array_equal(found, expected)


def test_the_physics_of_a_plain_world_is_the_robot_file_s_own():
    """No bush, no sole, no bias in the motors, the model's own rotors."""
    robot = Robot.load("hrp2")
    model = World(robot).model
    assert not model.actuator_biasprm.any()
    assert model.nv == robot.nv
    np.testing.assert_array_equal(model.dof_armature[6:], robot.model.armature[6:])
