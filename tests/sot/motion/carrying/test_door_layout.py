"""A door as the robot before it sees it."""

import numpy as np
import pinocchio as pin
import pytest

from scenarios.humanoidbench.door import DoorScene
from sot.robots.robot import Robot

STEP = 1e-6


@pytest.fixture(scope="module")
def scene() -> DoorScene:
    return DoorScene.of(Robot.load("hrp2"), 1)


def test_what_is_pressed_and_pushed_moves_as_the_doors_own_joints_move_it(scene: DoorScene) -> None:
    door, thing = scene.layout(), scene.thing(offset=False)
    data, angles = thing.model.createData(), np.array([0.3, 0.8])

    def place(frame: str, q: np.ndarray) -> pin.SE3:
        pin.forwardKinematics(thing.model, data, q)
        return data.oMi[thing.model.getJointId(thing.model.names[frame])]

    closed, moved = (place(1, q).copy() for q in (np.zeros(2), angles))
    np.testing.assert_allclose((moved * closed.inverse()).homogeneous, door.leaf(0.3).homogeneous, atol=1e-9)
    closed, moved = (place(2, q).copy() for q in (np.zeros(2), np.array([0.0, 0.8])))
    turned = moved * closed.inverse()
    skin, out = door.on_lever(0.0)
    np.testing.assert_allclose(turned.act(skin), door.on_lever(0.8)[0], atol=1e-9)
    np.testing.assert_allclose(turned.rotation @ out, door.on_lever(0.8)[1], atol=1e-9)


def test_forces_on_hands_do_the_work_of_the_springs(scene: DoorScene) -> None:
    door = scene.layout()
    way = (door.pushed(0.7 + STEP) - door.pushed(0.7 - STEP)) / (2.0 * STEP)
    force = door.leaf_force(np.array([0.7]), np.array([0.5]))[0]
    assert -force @ way == pytest.approx(door.stiffness * 0.7 + door.inertia * 0.5, rel=1e-6)
    way = (door.on_lever(0.9 + STEP)[0] - door.on_lever(0.9 - STEP)[0]) / (2.0 * STEP)
    # The skin goes around the axis with the middle of the bar, and rolls: only what is across the bar does work.
    force = door.lever_force(np.array([0.0]), np.array([0.9]))[0]
    assert -force @ way == pytest.approx(door.lever_stiffness * 0.9, rel=1e-6)
