"""The stabiliser against its plan, against a displaced robot, and under physics."""

import numpy as np
import pinocchio as pin
import pytest

from scenarios.inputs.clips import find_clip
from sim.loop import run
from sim.world import World
from sot.gravity import GRAVITY
from sot.hardware.compliance import FootCompliance
from sot.hardware.hardware import Hardware
from sot.hardware.readings import Readings
from sot.hardware.sensors import Sensors
from sot.hardware.servo import Servo
from sot.motion import plan, read, recognise
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.stabiliser import DcmGains, Stabiliser

SOFT = FootCompliance(2500.0, 2500.0, 2.4e5)


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def readings_of(robot, wrenches):
    return Readings(0.0, *np.full((2, robot.na), np.nan), *np.full((3, 3), np.nan), wrenches)


def carried(robot, share, moment=(0.0, 0.0)):
    return np.array([0.0, 0.0, share * robot.mass * GRAVITY, *moment, 0.0])


def test_without_sag_and_feedback_the_plan_is_commanded(robot):
    motion = Motion.standing(robot, 0.1, 100.0)
    targets = Stabiliser(motion, 0.01)(0.03, np.zeros(0), np.zeros(0), readings_of(robot, {}))
    np.testing.assert_allclose(targets.position, robot.rest[7:], atol=1e-12)
    np.testing.assert_allclose(targets.velocity, 0.0, atol=1e-9)


def test_a_robot_that_stands_somewhere_else_is_not_off_its_plan(robot):
    """Feet and all moved and turned: the divergent component as seen from the feet is the plan's."""
    motion = Motion.standing(robot, 0.1, 100.0)
    elsewhere = pin.SE3(pin.exp3(np.array([0.0, 0.0, 2.4])), np.array([70.0, -70.0, 0.0]))
    q = robot.rest.copy()
    q[:7] = pin.SE3ToXYZQUAT(elsewhere * pin.XYZQUATToSE3(q[:7]))
    stabiliser = Stabiliser(motion, 0.01, servo=Servo.of(robot), dcm=DcmGains())
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    com = pin.centerOfMass(robot.model, data, robot.rest)
    seen = stabiliser.divergent_component(0.03, q, np.zeros(robot.nv))
    np.testing.assert_allclose(seen, com[:2], atol=1e-9)


def test_a_robot_that_falls_forward_is_pressed_up_with_its_toes(robot):
    motion = Motion.standing(robot, 1.0, 100.0)
    stabiliser = Stabiliser(motion, 0.01, servo=Servo.of(robot), dcm=DcmGains())
    data, v = robot.model.createData(), np.zeros(robot.nv)
    v[0] = 0.1
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    com = pin.centerOfMass(robot.model, data, robot.rest)
    wrenches = {}
    for foot in robot.feet:  # as at rest: all moments about the centre of mass
        x = (com - data.oMf[robot.point(foot)].translation)[0]
        wrenches[foot] = carried(robot, 0.5, (0.0, -x * 0.5 * robot.mass * GRAVITY))
    for k in range(20):
        targets = stabiliser(0.01 * k, robot.rest, v, readings_of(robot, wrenches))
    q = np.concatenate([robot.rest[:7], targets.position])
    moved = robot.model.createData()
    pin.framesForwardKinematics(robot.model, moved, q)
    waist = moved.oMf[robot.point("waist")].rotation
    for foot in robot.feet:
        toes_down = (waist.T @ moved.oMf[robot.point(foot)].rotation)[2, 0]
        before = (data.oMf[robot.point("waist")].rotation.T @ data.oMf[robot.point(foot)].rotation)[2, 0]
        assert toes_down < before - 1e-4


@pytest.mark.slow
def test_a_dance_on_soft_feet_keeps_to_its_plan_by_sag_and_feedback(robot):
    motion = plan(recognise(read(find_clip("groove"))).slice(0.0, 3.0), robot, "planted", 500.0).motion
    hardware = Hardware(Servo.of(robot), SOFT, Sensors())

    def off_plan(stabiliser):
        done = run(stabiliser, World(robot, 0.002, hardware=hardware), motion)
        assert done.fell_at_s is None
        off = (done.log.zmp_measured - done.log.zmp_planned)[5:]
        return 1e3 * float(np.sqrt(np.mean(np.sum(off**2, axis=1))))

    nothing = off_plan(Stabiliser(motion, 0.002))
    sag = off_plan(Stabiliser(motion, 0.002, SOFT))
    both = off_plan(Stabiliser(motion, 0.002, SOFT, hardware.servo, DcmGains()))
    assert nothing > 30.0 > 22.0 > sag > both
    assert both < 8.0
