"""Pushes act on the body, at the time and for as long as they say, and on nothing else."""

import mujoco
import numpy as np
import pytest

from sim.push import Push
from sim.world import World
from sot.errors import InputError
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def momentum(world: World) -> np.ndarray:
    """Linear momentum of the whole robot [N s]."""
    mujoco.mj_subtreeVel(world.model, world.data)
    return world.robot.mass * world.data.subtree_linvel[1]


@pytest.mark.parametrize("rate", [1000.0, 200.0])
def test_a_push_adds_its_impulse(robot, rate):
    """In flight, against a fall without it; its ends lie between control ticks."""
    fall, pushed = World(robot, 1.0 / rate), World(robot, 1.0 / rate, pushes=[Push(0.012, (60.0, -30.0, 0.0), 0.021)])
    high = robot.rest.copy()
    high[2] += 1.0
    for world in (fall, pushed):
        world.reset(high)
        for _ in range(round(0.05 * rate)):
            world.step(np.zeros(robot.na))
    np.testing.assert_allclose(momentum(pushed) - momentum(fall), (1.26, -0.63, 0.0), atol=1e-3)
    assert not pushed.data.xfrc_applied.any()


@pytest.mark.parametrize(("point", "body"), [("chest", "CHEST1"), ("waist", None), ("left_hand", "LARM5")])
def test_the_body_that_is_pushed(robot, point, body):
    world = World(robot, pushes=[Push(0.0, (10.0, 0.0, 5.0), body=point), Push(0.0, (1.0, 0.0, 0.0), body=point)])
    world.step(np.zeros(robot.na))
    forces = world.data.xfrc_applied
    pushed = int(np.flatnonzero(forces.any(axis=1))[0])
    np.testing.assert_array_equal(forces[pushed, :3], (11.0, 0.0, 5.0))
    assert np.count_nonzero(forces) == 2
    joints = [world.model.joint(k).name for k in range(world.model.njnt) if world.model.jnt_bodyid[k] == pushed]
    assert pushed == 1 if body is None else body in joints


def test_a_horizontal_push_has_its_impulse_and_its_direction():
    push = Push.horizontal(1.5, 8.0, 2.0)
    assert push.t == 1.5
    assert push.impulse == pytest.approx(8.0)
    assert push.direction == pytest.approx(2.0)
    assert push.force[2] == 0.0


@pytest.mark.parametrize("bad", [{"t": -1.0}, {"duration": 0.0}, {"force": (np.nan, 0.0, 0.0)}, {"t": np.inf}])
def test_bad_numbers(bad):
    with pytest.raises(InputError, match="push at t="):
        Push(**({"t": 1.0, "force": (1.0, 0.0, 0.0)} | bad))


def test_no_such_body(robot):
    with pytest.raises(InputError, match="tail"):
        World(robot, pushes=[Push(1.0, (1.0, 0.0, 0.0), body="tail")])
