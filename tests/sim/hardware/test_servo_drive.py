"""Servos: straight lines between commands, and torques within the motors' limits."""

from dataclasses import replace

import numpy as np
import pytest

from sim.hardware.servo_drive import ServoDrive
from sim.world import World
from sot.hardware import JointTargets, Servo
from sot.hardware.hardware import Hardware
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def two_joints() -> Servo:
    return Servo(np.array([100.0, 50.0]), np.array([3.0, 2.0]), np.array([0.005, 0.010]), np.array([0.02, 0.02]))


def test_a_ramp_is_followed_without_lag():
    drive, speed = ServoDrive(two_joints(), 0.001), np.array([2.0, -1.0])
    for k in range(30):
        out = drive(JointTargets(0.001 * k * speed, speed))
        np.testing.assert_allclose(drive.position, 0.001 * k * speed, atol=1e-12)
        np.testing.assert_allclose(drive.velocity, speed, atol=1e-9)
        np.testing.assert_allclose(out, [100.0, 50.0] * drive.position + [3.0, 2.0] * drive.velocity)


@pytest.mark.parametrize("steps", [2, 3, 7])
def test_ticks_of_several_physics_steps_make_no_ripple(steps):
    """A command that is taken in the middle of a tick knows how old the tick's targets are."""
    drive, speed = ServoDrive(two_joints(), 0.001), np.array([2.0, -1.0])
    for k in range(10):
        targets = JointTargets(0.001 * steps * k * speed, speed)
        for substep in range(steps):
            drive(targets)
            np.testing.assert_allclose(drive.position, 0.001 * (steps * k + substep) * speed, atol=1e-12)
            np.testing.assert_allclose(drive.velocity, speed, atol=1e-9)


def test_commands_are_taken_once_a_period_and_reached_one_period_later():
    """A step that comes between two commands waits for the next one."""
    drive, seen = ServoDrive(two_joints(), 0.001), []
    for k in range(25):
        drive(JointTargets(np.full(2, 1.0 if k >= 3 else 0.0), np.zeros(2)))
        seen.append(drive.position)
    leg, arm = np.array(seen).T
    np.testing.assert_allclose(leg, np.interp(np.arange(25), [5, 10], [0.0, 1.0]), atol=1e-12)
    np.testing.assert_allclose(arm, np.interp(np.arange(25), [10, 20], [0.0, 1.0]), atol=1e-12)


def test_a_drive_that_is_reset_knows_nothing():
    drive = ServoDrive(two_joints(), 0.001)
    for _ in range(7):
        drive(JointTargets(np.ones(2), np.ones(2)))
    drive.reset()
    drive(JointTargets(np.full(2, 5.0), np.zeros(2)))
    np.testing.assert_array_equal(drive.position, 5.0)


def test_motors_give_what_error_and_rate_ask_for_within_their_limits(robot):
    servo = Servo.of(robot)
    world = World(robot, hardware=Hardware(servo))
    off = np.where(np.arange(robot.na) % 2, 0.002, 0.1)
    target = robot.rest[7:] + off
    world.step(JointTargets(robot.rest[7:], np.zeros(robot.na)))
    np.testing.assert_allclose(world.applied_torque(), 0.0, atol=1e-9)
    world.reset(robot.rest)
    world.step(JointTargets(target, np.zeros(robot.na)))
    np.testing.assert_allclose(world.applied_torque(), np.minimum(servo.stiffness * off, robot.effort))
    for _ in range(50):
        world.step(JointTargets(target, np.zeros(robot.na)))
        assert (np.abs(world.applied_torque()) <= robot.effort * (1 + 1e-12)).all()


def test_light_links_do_not_shake():
    """Joints whose model has no rotor, at 1 kHz: their servos are stiffer than an explicit step could stand."""
    robot = Robot.load("hrp2")
    servo = Servo.of(robot)
    light = Servo(servo.stiffness, 10.0 * servo.damping, servo.period, servo.rotor)
    world = World(robot, hardware=Hardware(light))
    for _ in range(300):
        world.step(JointTargets(robot.rest[7:], np.zeros(robot.na)))
    assert np.abs(world.state()[1][6:]).max() < 0.02


def test_torques_are_for_motors_and_targets_for_servos(robot):
    targets = JointTargets(robot.rest[7:], np.zeros(robot.na))
    with pytest.raises(TypeError, match="takes JointTargets"):
        World(robot).step(targets)
    with pytest.raises(TypeError, match="takes JointTargets"):
        World(robot, hardware=Hardware(Servo.of(robot))).step(np.zeros(robot.na))


def test_joints_have_the_rotors_that_their_servos_are_made_for(robot):
    servo = replace(Servo.of(robot), rotor=np.linspace(0.1, 0.2, robot.na))
    model = World(robot, hardware=Hardware(servo)).model
    found = [model.dof_armature[model.joint(name).dofadr[0]] for name in robot.joints]
    np.testing.assert_allclose(found, servo.rotor)
