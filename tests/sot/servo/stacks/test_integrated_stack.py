"""A stack on a state of its own: what it samples is one motion, and is in balance."""

import itertools

import numpy as np
import pinocchio as pin

from scenarios.stacks import planted_stack, stepping_schedule, stepping_stack
from solvers import Cascade
from sot.control.controller import Controller
from sot.gravity import GRAVITY
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.stacks.integrated_stack import IntegratedStack
from tests.sot.behaviours.stepping import stepping_motion

PERIOD = 0.001


def test_samples_follow_their_own_accelerations_and_balance():
    robot = Robot.load("hrp2")
    motion = Motion.standing(robot, 1.0)
    stack = planted_stack(robot, motion)
    start = robot.rest.copy()
    start[7 + robot.joints.index("RARM3")] -= 0.2  # off its plan, so that something moves
    own = IntegratedStack(Controller(robot, stack, Cascade(), PERIOD), start, np.zeros(robot.nv))
    samples = [own.sample(PERIOD * k) for k in range(40)]
    for one, following in itertools.pairwise(samples):
        np.testing.assert_allclose(following.v, one.v + PERIOD * one.a, atol=1e-12)
        np.testing.assert_allclose(following.q, pin.integrate(robot.model, one.q, PERIOD * following.v), atol=1e-12)
    last = samples[-1]
    assert np.abs(last.v).max() > 0.05
    np.testing.assert_allclose(
        (samples[-1].com_velocity - samples[-2].com_velocity) / PERIOD, samples[-2].com_acceleration, atol=0.02
    )
    assert np.abs(last.zmp - last.com[:2]).max() < 0.05 and np.abs(last.com_acceleration).max() < 0.1 * GRAVITY


def test_feet_land_where_no_floor_stops_them():
    """Each foot steps once: all along, feet and centre of mass are at their plan."""
    rate = 250.0
    robot = Robot.load("hrp2")
    motion = stepping_motion(robot, rate=rate)
    stack, schedule = stepping_stack(robot, motion), stepping_schedule(robot, motion)
    own = IntegratedStack(Controller(robot, stack, Cascade(), 1.0 / rate, schedule), motion.q[0], motion.v[0])
    data = robot.model.createData()
    for k in range(round(motion.duration * rate)):
        sample, planned = own.sample(k / rate), motion.sample(k / rate)
        np.testing.assert_allclose(sample.com, planned.com, atol=0.01)
        places = []
        for q in (planned.q, sample.q):
            pin.forwardKinematics(robot.model, data, q)
            places.append([pin.updateFramePlacement(robot.model, data, robot.point(f)).translation for f in robot.feet])
        np.testing.assert_allclose(places[1], places[0], atol=0.01)
