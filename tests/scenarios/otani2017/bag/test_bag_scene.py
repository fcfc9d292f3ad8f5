"""Where the bag, the table and the hands are to be: in the robot's size, within what hand and foot can hold."""

import numpy as np
import pytest

from scenarios.otani2017.bag import scene
from scenarios.otani2017.bag.bag import BagTrial
from scenarios.otani2017.bag.scene import BagPlan, bag_things
from sot.errors import InputError
from sot.robots.robot import Robot
from sot.robots.system import System


def plan():
    robot = Robot.load("hrp2")
    system = System(robot, bag_things(robot, 1.5))
    return robot, system, BagPlan.of(system)


def test_palm_and_hook_touch_their_surfaces_and_the_lean_is_beyond_the_sole():
    robot, system, made = plan()
    palm, hook = robot.surface("right_palm"), robot.surface("left_hook")
    top = system.surface("table/top").axes.translation[2]
    np.testing.assert_allclose((made.palm * palm.placement).translation[2], top)
    np.testing.assert_allclose((made.palm * palm.placement).rotation[:, 2], [0.0, 0.0, -1.0], atol=1e-12)
    np.testing.assert_allclose((made.hook * hook.placement).translation[2], top + 0.24)
    np.testing.assert_allclose((made.hook * hook.placement).rotation[:, 2], [0.0, 0.0, 1.0], atol=1e-12)
    assert made.leaning[0] > made.sole_edge > made.over_foot[0]


def test_a_lean_that_the_hand_cannot_hold_is_refused(monkeypatch):
    monkeypatch.setattr(scene, "PALM_MOST", 0.05)
    with pytest.raises(InputError, match="cannot lean that far"):
        plan()


def test_a_robot_without_a_hook_is_refused():
    robot = Robot.load("g1")
    with pytest.raises(InputError, match="no surface"):
        BagPlan.of(System(robot, bag_things(robot, 1.5)))


def test_a_seed_moves_the_bag_and_only_the_bag():
    assert BagTrial().offset().isIdentity()
    offset = BagTrial(seed=3).offset()
    assert 0.0 < np.linalg.norm(offset.translation) < 0.02 and offset.translation[2] == 0.0
    robot = Robot.load("hrp2")
    told, actual = bag_things(robot, 1.5), bag_things(robot, 1.5, offset, 0.02)
    assert actual[0].surface("top").axes.translation[2] == pytest.approx(
        told[0].surface("top").axes.translation[2] - 0.02
    )
