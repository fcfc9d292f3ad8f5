"""A stack that is pushed along with its robot: when, by how much, and that it then steps."""

import numpy as np
import pinocchio as pin
import pytest

from scenarios.stacks import stepping_schedule, stepping_stack
from solvers import Cascade
from sot.control.controller import Controller
from sot.gravity import GRAVITY
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.stacks.catching_stack import CatchingStack

PERIOD = 0.005
REACH = 0.13
"""Of the toes before the centre of mass [m], about."""


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def standing(robot):
    motion = Motion.standing(robot, 2.0, 1.0 / PERIOD)
    stack, schedule = stepping_stack(robot, motion), stepping_schedule(robot, motion)
    own = CatchingStack(Controller(robot, stack, Cascade(), PERIOD, schedule), motion)
    return own, stack, dict.fromkeys(robot.feet, 0.5 * robot.mass * GRAVITY)


def test_a_divergent_component_over_the_support_leaves_the_own_state_alone(robot):
    own, stack, loads = standing(robot)
    at = own.divergent_component()
    for k in range(3):
        sample = own.sample_for(PERIOD * k, at + np.array([0.5 * REACH, 0.0]), loads)
    assert np.abs(sample.v).max() < 0.02
    assert all(contact.mode == "fixed" for contact in stack.contacts)


def test_one_that_has_left_it_is_taken_over_and_feet_stay(robot):
    own, _, loads = standing(robot)
    before = own.stances()
    wanted = own.divergent_component() + np.array([1.4 * REACH, 0.02])
    sample = own.sample_for(0.0, wanted, loads)
    rate = np.sqrt(GRAVITY / sample.com[2])
    np.testing.assert_allclose((sample.com + sample.com_velocity / rate)[:2], wanted, atol=1e-6)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, sample.q, sample.v)
    for foot, (place, _) in before.items():
        frame = robot.point(foot)
        pin.updateFramePlacement(robot.model, data, frame)
        assert pin.getFrameVelocity(robot.model, data, frame).vector == pytest.approx(np.zeros(6), abs=1e-9)
        np.testing.assert_allclose(data.oMf[frame].translation, place.translation, atol=1e-6)


def test_a_foot_steps_under_it_and_lands_when_it_carries(robot):
    """No load is felt by the foot that swings until late: it lands then, farther ahead, stops, and both feet stand."""
    own, stack, loads = standing(robot)
    wanted, start = own.divergent_component() + np.array([1.4 * REACH, 0.0]), own.stances()
    swings, landed_at, speeds = None, np.nan, []
    for k in range(95):
        t = PERIOD * k
        off = [contact.point for contact in stack.contacts if contact.mode == "off"]
        swings = off[0] if off else swings
        felt = {foot: 0.0 if foot in off and t < 0.4 else load for foot, load in loads.items()}
        sample = own.sample_for(t, wanted if swings is None else own.divergent_component(), felt)
        speeds.append(max(foot_speeds(robot, sample).values()))
        if swings and not off and np.isnan(landed_at):
            landed_at = t
    assert swings is not None
    assert landed_at == pytest.approx(0.4, abs=0.02)
    landed = round(landed_at / PERIOD)
    assert speeds[landed - 1] > 0.02 and max(speeds[landed + 1 :]) < 0.005
    ahead = own.stances()[swings][0].translation - start[swings][0].translation
    assert ahead[0] > 0.05
    other = next(foot for foot in robot.feet if foot != swings)
    np.testing.assert_allclose(own.stances()[other][0].translation, start[other][0].translation, atol=0.01)


def test_one_that_has_left_it_is_followed_until_the_own_state_is_near(robot):
    """Over the support again it is brought on, as long as it is far from that of the own state."""
    own, _, loads = standing(robot)
    at = own.divergent_component()
    own.sample_for(0.0, at + np.array([1.4 * REACH, 0.0]), loads)
    ways = []
    for k, share in ((1, 0.7), (2, 0.7), (3, 0.0)):
        measured = own.divergent_component() + np.array([-share * REACH, 0.0])
        before = own.divergent_component()
        own.sample_for(PERIOD * k, measured, loads)
        ways.append(own.divergent_component()[0] - before[0])
    assert max(ways[:2]) < ways[2] - 0.002


def foot_speeds(robot, sample):
    data, found = robot.model.createData(), {}
    pin.forwardKinematics(robot.model, data, sample.q, sample.v)
    for foot in robot.feet:
        found[foot] = np.linalg.norm(pin.getFrameVelocity(robot.model, data, robot.point(foot)).linear)
    return found
