"""Heights count from what the feet stand on."""

import numpy as np
import pinocchio as pin
import pytest

from sot.behaviours.support_height import divergence_rate, support_height
from sot.control.contact import Contact
from sot.control.tick import Tick
from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.robots.surface import Surface
from tasks import Balance

SQUARE = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])


def plate(height, slope=0.0):
    return Surface(f"plate {height}", SQUARE, pin.SE3(pin.exp3(np.array([0.0, slope, 0.0])), np.array([0, 0, height])))


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def standing(robot, height=0.0, on=(), loads=(1.0, 1.0)):
    q = robot.rest.copy()
    q[2] += height
    tick = Tick(robot)
    tick.contacts = [Contact(robot.surface(foot), *on[k : k + 1]) for k, foot in enumerate(robot.feet)]
    for contact, load in zip(tick.contacts, loads, strict=True):
        contact.load = load
    v = np.random.default_rng(0).normal(size=robot.nv) * 0.1
    return tick.update(0.0, q, v)


def test_it_is_the_mean_by_load(robot):
    on = plate(0.1), plate(0.3)
    assert support_height(standing(robot)) == 0.0
    assert support_height(standing(robot, on=on)) == pytest.approx(0.2)
    assert support_height(standing(robot, on=on, loads=(1.0, 0.0))) == pytest.approx(0.1)
    assert support_height(standing(robot, on=on, loads=(1.0, 0.5))) == pytest.approx(0.5 / 3.0)
    tick = standing(robot, on=on)
    tick.contacts[0].mode = "off"
    assert support_height(tick) == pytest.approx(0.3)


def test_a_slope_counts_where_the_foot_is(robot):
    tick = standing(robot, on=(plate(0.5, slope=-0.2),) * 2)
    x = np.mean([tick.frame(foot).position[0] for foot in robot.feet])
    assert support_height(tick) == pytest.approx(0.5 + x * np.tan(0.2), abs=1e-6)


def test_the_rate_is_that_of_a_pendulum_over_the_ground(robot):
    tick = standing(robot, height=0.4, on=(plate(0.4),) * 2)
    low = standing(robot)
    assert divergence_rate(tick) == pytest.approx(np.sqrt(GRAVITY / low.com[2]))


def test_balance_asks_for_the_same_on_a_high_floor(robot):
    """The whole world lifted by 0.4 m, plan and all: no row changes."""
    wanted = []
    for height, on in ((0.0, ()), (0.4, (plate(0.4),) * 2)):
        tick = standing(robot, height, on)
        com = tick.com + np.array([0.01, -0.02, 0.005])
        plan = com, np.array([0.1, 0.2, 0.0]), np.array([0.4, -0.3, 0.1]), com[:2] - 0.05
        wanted.append(Balance(lambda t, plan=plan: plan).rows(tick).lower)
    np.testing.assert_allclose(wanted[0], wanted[1], atol=1e-9)
