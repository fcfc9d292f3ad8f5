"""Loads that are known: a carried mass against a body summed in by hand, a wrench against its power; how they come."""

import numpy as np
import pinocchio as pin
import pytest

from scenarios.stacks import planted_stack
from sim import World
from solvers import Cascade
from sot.control import Carried, Controller, KnownWrench, Stack
from sot.control.tick import Tick
from sot.errors import InputError
from sot.motion import Motion
from sot.robots import Robot
from tests.sot.states import random_state

POINT, MASS, COM = "right_hand", 8.0, np.array([0.1, -0.2, 0.05])
FORCE = np.array([0.0, -40.0, 10.0])


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def loaded(robot, load, q, v, share=1.0):
    tick = Tick(robot)
    load.share, tick.loads = share, [load]
    return tick.update(0.0, q, v)


@pytest.mark.parametrize("share", [1.0, 0.3])
def test_a_carried_mass_moves_with_its_point(robot, share):
    q, v = random_state(robot, np.random.default_rng(0))
    plain, tick = Tick(robot).update(0.0, q, v), loaded(robot, Carried(POINT, MASS, COM), q, v, share)
    frame, mass = plain.frame(POINT), share * MASS
    arm = frame.rotation @ COM
    J = frame.jacobian[:3] - pin.skew(arm) @ frame.jacobian[3:]
    turning, spin = frame.drift[3:], frame.velocity[3:]
    drift = frame.drift[:3] + np.cross(turning, arm) + np.cross(spin, np.cross(spin, arm))
    np.testing.assert_allclose(tick.M, plain.M + mass * J.T @ J, atol=1e-9)
    np.testing.assert_allclose(tick.h, plain.h + mass * J.T @ (drift + np.array([0.0, 0.0, 9.81])), atol=1e-8)
    assert tick.mass == pytest.approx(robot.mass + mass)
    com = (robot.mass * plain.com + mass * (frame.position + arm)) / tick.mass
    np.testing.assert_allclose(tick.com, com, atol=1e-12)
    np.testing.assert_allclose(tick.com_velocity, tick.com_jacobian @ v, atol=1e-12)
    momentum = tick.centroidal()[1] @ v
    np.testing.assert_allclose(momentum[:3], tick.mass * tick.com_velocity, atol=1e-9)


def test_a_load_that_has_gone_leaves_nothing_behind(robot):
    q, v = random_state(robot, np.random.default_rng(1))
    plain, tick = Tick(robot).update(0.0, q, v), loaded(robot, Carried(POINT, MASS, COM), q, v)
    tick.loads = []
    tick.update(0.0, q, v)
    np.testing.assert_array_equal(tick.M, plain.M)
    assert tick.mass == robot.mass and robot.model.inertias[1] == tick.model.inertias[1]


def test_a_known_wrench_takes_its_power_from_the_bias(robot):
    q, v = random_state(robot, np.random.default_rng(2))
    wrench = np.array([3.0, -2.0, 5.0, 0.4, 0.1, -0.3])
    plain, tick = Tick(robot).update(0.0, q, v), loaded(robot, KnownWrench(POINT, lambda t: wrench), q, v, 0.5)
    assert (plain.h - tick.h) @ v == pytest.approx(0.5 * wrench @ plain.frame(POINT).velocity)
    np.testing.assert_array_equal(tick.com_drift, plain.com_drift)


def test_loads_come_and_go_within_their_ramps():
    stack, load = Stack([], [], {}), Carried(POINT, MASS)
    stack.advance(1.0)
    stack.add_load(load, ramp=0.4)
    shares = []
    for t in np.arange(1.0, 1.45, 0.1):
        stack.advance(t)
        shares.append(load.share)
    np.testing.assert_allclose(shares, [0.0, 0.1035, 0.5, 0.8965, 1.0], atol=1e-3)
    assert stack.remove_load(load.name, ramp=0.2) is load
    stack.advance(1.5)
    assert stack.loads == [load] and 0.0 < load.share < 1.0
    stack.advance(1.7)
    assert stack.loads == []


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda stack: Carried(POINT, 0.0), "load at right_hand: mass must be positive, not 0"),
        (lambda stack: KnownWrench(POINT, [1.0, 2.0]), r"give a force \(3,\) or a wrench \(6,\)"),
        (lambda stack: stack.add_load(Carried(POINT, 1.0)), "has a load 'load at right_hand' already"),
        (lambda stack: stack.remove_load("bag"), "no load 'bag': it has load at right_hand"),
    ],
)
def test_what_makes_no_sense_is_one_line(wrong, message):
    with pytest.raises(InputError, match=message):
        wrong(Stack([], [], {}, loads=[Carried(POINT, MASS)]))


@pytest.mark.parametrize("known", [True, False])
def test_a_pull_at_a_hand_that_is_known_moves_nothing(robot, known):
    """In physics; the same pull unknown moves the hand by centimetres."""
    period = 0.002
    motion = Motion.standing(robot, 1.0, 1.0 / period)
    stack, world = planted_stack(robot, motion), World(robot, period)
    controller = Controller(robot, stack, Cascade(), period)
    pull = KnownWrench(POINT, FORCE)
    pull.begin_ramp(0.1, 0.3, 0.0, 1.0)
    if known:
        stack.add_load(pull)
    start, site = controller.tick.frame(POINT).position.copy(), world.model.site(POINT)
    for k in range(250):
        pull.advance(k * period)
        force = pull.wrench(k * period)[:3]
        arm = world.data.site_xpos[site.id] - world.data.xipos[site.bodyid[0]]
        world.data.xfrc_applied[site.bodyid[0]] = np.concatenate([force, np.cross(arm, force)])
        world.step(controller(k * period, *world.state()).torque)
    off = np.linalg.norm(controller.tick.frame(POINT).position - start)
    assert off < 0.001 if known else off > 0.01
