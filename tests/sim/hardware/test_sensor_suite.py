"""Sensors say what is there: against Pinocchio's rates and accelerations, and the floor's forces."""

import numpy as np
import pinocchio as pin
import pytest

from sim.world import World
from sot.errors import InputError
from sot.hardware import Channel, FootCompliance, JointTargets, Sensors, Servo, measured_zmp, sensor_preset
from sot.hardware.hardware import Hardware
from sot.robots.robot import Robot

GRAVITY = np.array([0.0, 0.0, 9.81])


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def moving(robot: Robot, sensors: Sensors, compliance: FootCompliance | None = None, steps: int = 250) -> World:
    """A robot that bends its knees and turns its chest."""
    world = World(robot, hardware=Hardware(Servo.of(robot), compliance, sensors))
    rest, swing = robot.rest[7:], np.zeros(robot.na)
    for foot_joints in (robot.groups["left_leg"], robot.groups["right_leg"]):
        swing[list(foot_joints[2:5])] = -0.1, 0.2, -0.1
    swing[robot.groups["chest"][0]] = 0.2
    for k in range(steps):
        angle = 10.0 * 0.001 * k
        world.step(JointTargets(rest + (1 - np.cos(angle)) * swing, 10.0 * np.sin(angle) * swing))
    return world


@pytest.mark.parametrize("point", ["waist", "chest"])
def test_inertial_unit_and_encoders_agree_with_the_motion(robot, point):
    """The specific force by differences of Pinocchio's velocities, less gravity; all of the readings' own instant."""
    worlds = [moving(robot, Sensors(imu_point=point), steps=steps) for steps in (200, 201)]
    states, readings = [world.state() for world in worlds], worlds[1].readings()
    data, frame = robot.model.createData(), robot.point(point)
    placements, velocities = [], []
    for q, v in states:
        pin.forwardKinematics(robot.model, data, q, v)
        placements.append(pin.updateFramePlacement(robot.model, data, frame).copy())
        velocities.append(pin.getFrameVelocity(robot.model, data, frame, pin.LOCAL_WORLD_ALIGNED).vector.copy())
    turn = placements[0].rotation
    assert readings.time == pytest.approx(0.2)
    np.testing.assert_allclose(readings.joint_position, states[0][0][7:], atol=1e-12)
    np.testing.assert_allclose(readings.joint_velocity, states[0][1][6:], atol=1e-12)
    x, y, z, w = readings.orientation
    np.testing.assert_allclose(pin.Quaternion(w, x, y, z).matrix(), turn, atol=1e-12)
    np.testing.assert_allclose(readings.angular_velocity, turn.T @ velocities[0][3:], atol=1e-10)
    acceleration = (velocities[1][:3] - velocities[0][:3]) / 0.001
    np.testing.assert_allclose(readings.specific_force, turn.T @ (acceleration + GRAVITY), atol=0.02)
    assert np.linalg.norm(acceleration) > 0.3


@pytest.mark.parametrize("compliance", [None, FootCompliance(2500.0, 2500.0, 239018.0)])
def test_force_sensors_feel_the_floor_less_the_sole(robot, compliance):
    world = moving(robot, Sensors(), compliance)
    q, data = world.state()[0], robot.model.createData()
    readings, floor = world.readings(), world.foot_wrenches()
    pin.framesForwardKinematics(robot.model, data, q)
    feet = {foot: data.oMf[robot.point(foot)].copy() for foot in robot.feet}
    for foot, at in feet.items():
        felt = at.rotation @ readings.foot_wrench[foot][:3]
        weight = 9.81 * world.model.body(f"{foot}_sole").mass[0]
        np.testing.assert_allclose(felt, floor[foot][:3] - [0.0, 0.0, weight], atol=3.0)
    np.testing.assert_allclose(measured_zmp(readings.foot_wrench, feet), world.zmp(), atol=0.004)


def test_before_the_first_step_only_gravity_is_known(robot):
    world = World(robot, hardware=Hardware(Servo.of(robot), None, Sensors()))
    readings = world.readings()
    assert readings.time == 0.0
    np.testing.assert_allclose(readings.specific_force, [0.0, 0.0, 9.81], atol=1e-6)
    assert not any(wrench.any() for wrench in readings.foot_wrench.values())
    np.testing.assert_array_equal(readings.joint_position, robot.rest[7:])


def test_readings_repeat_with_the_seed_and_hold_between_steps(robot):
    def last(seed: int) -> np.ndarray:
        world = moving(robot, sensor_preset("bmi088", seed), steps=20)
        readings = world.readings()
        assert world.readings() is readings
        return np.concatenate(
            [readings.joint_velocity, readings.orientation, readings.angular_velocity, readings.specific_force]
        )

    np.testing.assert_array_equal(last(1), last(1))
    assert np.abs(last(1) - last(2)).max() > 1e-3


def test_an_error_of_attitude_turns_the_unit_by_its_angle(robot):
    world = World(robot, hardware=Hardware(sensors=Sensors(orientation=Channel(bias=0.01))))
    x, y, z, w = world.readings().orientation
    np.testing.assert_allclose(np.abs(pin.log3(pin.Quaternion(w, x, y, z).matrix())), 0.01, atol=1e-9)


def test_sensing_leaves_the_robot_alone(robot):
    """Sensors read and disturb nothing: the same fall with ideal ones and with noisy ones."""
    falls = []
    for sensors in (Sensors(), sensor_preset("bmi088")):
        world = World(robot, hardware=Hardware(sensors=sensors))
        for _ in range(50):
            world.readings()
            world.step(np.zeros(robot.na))
        falls.append(world.state()[0])
    np.testing.assert_array_equal(*falls)


def test_worlds_without_sensors_and_points_that_are_not_there(robot):
    with pytest.raises(TypeError, match="no sensors"):
        World(robot).readings()
    with pytest.raises(InputError, match="has no point 'tail'"):
        World(robot, hardware=Hardware(sensors=Sensors(imu_point="tail")))
