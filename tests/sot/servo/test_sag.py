"""The sag of a foot against a sole on springs, and that of servos against physics and inverse dynamics."""

import numpy as np
import pinocchio as pin

from sim.world import World
from sot.gravity import GRAVITY
from sot.hardware import JointTargets, Sensors, Servo
from sot.hardware.compliance import FootCompliance
from sot.hardware.hardware import Hardware
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.load_sharing import FootLoad, LoadSharing
from sot.servo.sag import ServoSag, bush_compliance, sag_offset

BUSH = np.array([0.01, -0.02, 0.07])


def test_the_springs_under_a_load_undo_the_offset():
    """The foot turned by the offset, its sole flat: the bush's moment, force and the load's are in balance."""
    compliance = FootCompliance(700.0, 500.0, 2e5)
    load = FootLoad(np.array([20.0, -15.0, 400.0]), np.array([9.0, -14.0, 1.0]))
    offset = sag_offset(load, bush_compliance(compliance), BUSH)
    sole_against_foot = -offset[:2]
    moment = load.moment + np.cross(-BUSH, load.force)
    np.testing.assert_allclose([700.0, 500.0] * sole_against_foot, moment[:2])
    np.testing.assert_allclose(-2e5 * offset[2], load.force[2])


def test_a_sole_that_cannot_move_up_does_not():
    offset = sag_offset(
        FootLoad(np.array([0.0, 0.0, 400.0]), np.zeros(3)), bush_compliance(FootCompliance(700.0, 500.0)), BUSH
    )
    assert offset[2] == 0.0


def sag_of(robot: Robot, motion: Motion, servo: Servo) -> np.ndarray:
    plan = motion.sample(0.5)
    loads = LoadSharing(motion)(0.5, plan.zmp, robot.mass * np.array([0.0, 0.0, GRAVITY]))
    return ServoSag(robot, servo)(plan, loads)


def test_a_standing_robot_s_joints_are_at_their_plan():
    robot = Robot.load("hrp2")
    servo, motion = Servo.of(robot).scaled(0.2), Motion.standing(robot, 1.0, 100.0)
    sag = sag_of(robot, motion, servo)
    off = []
    for offset in (np.zeros(robot.na), sag):
        world = World(robot, 0.002, hardware=Hardware(servo, None, Sensors()))
        for _ in range(300):
            world.step(JointTargets(robot.rest[7:] + offset, np.zeros(robot.na)))
        off.append(np.abs(world.state()[0][7:] - robot.rest[7:])[list(robot.groups["legs"])].max())
    assert off[0] > 0.005
    assert off[1] < 0.15 * off[0]


def test_torques_are_those_of_inverse_dynamics():
    """An accelerated state, one foot loaded with all that the base needs."""
    robot, random = Robot.load("hrp2"), np.random.default_rng(0)
    servo, motion = Servo.of(robot), Motion.standing(robot, 1.0, 100.0)
    plan = motion.sample(0.5)._replace(v=0.1 * random.standard_normal(robot.nv), a=random.standard_normal(robot.nv))
    loads = LoadSharing(motion)(0.5, plan.zmp, robot.mass * np.array([3.0, -2.0, GRAVITY]))
    torque = servo.stiffness * ServoSag(robot, servo)(plan, loads)
    data = robot.model.createData()
    forces = pin.StdVec_Force()
    forces.extend([pin.Force.Zero() for _ in range(robot.model.njoints)])
    for foot, load in loads.items():
        frame = robot.model.frames[robot.point(foot)]
        forces[frame.parentJoint] = frame.placement.act(pin.Force(load.force, load.moment))
    np.testing.assert_allclose(torque, pin.rnea(robot.model, data, plan.q, plan.v, plan.a, forces)[6:], atol=1e-9)
