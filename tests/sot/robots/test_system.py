"""A system of robot and things: indices, names, and dynamics against MuJoCo's."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sim import World
from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots import Robot, System, Thing

DOWN, UP = pin.SE3(pin.rpy.rpyToMatrix(0.1, -0.2, 0.3), np.array([0.4, 0.1, 1.2])), (2.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def things():
    door = Thing.load("door", placement=pin.SE3(DOWN.rotation, np.array([0.7, 0.4, 0.0])), stiffness=60.0, damping=3.0)
    return [Thing.load("box", placement=DOWN, mass=5.0, size=(0.3, 0.2, 0.1)), Thing.load("table", placement=UP), door]


def moving_state(system, rng):
    q = pin.integrate(system.model, system.rest, rng.uniform(-0.3, 0.3, system.nv))
    return q, rng.uniform(-1.0, 1.0, system.nv)


def test_the_robots_indices_stay_and_a_robot_alone_is_itself(robot, things):
    system = System(robot, things)
    assert System(robot).model is robot.model and System.of(system) is system
    assert system.nv == robot.nv + 6 + 1 and system.na == robot.na
    np.testing.assert_array_equal(system.driven, np.arange(6, robot.nv))
    np.testing.assert_array_equal(system.undriven, [*range(6), *range(robot.nv, robot.nv + 7)])
    assert [system.point(point) for point in robot.points] == list(robot.points.values())
    np.testing.assert_array_equal(system.rest[: robot.nq], robot.rest)


def test_one_model_for_both_libraries(robot, things):
    """Places, mass matrix and bias with springs and dampers are MuJoCo's, at a moving state."""
    world = World(robot, things=things)
    system, rng = world.system, np.random.default_rng(0)
    q, v = moving_state(system, rng)
    world.reset(q, v)
    np.testing.assert_allclose(np.concatenate(world.state()), np.concatenate([q, v]), atol=1e-12)
    tick = Tick(system).update(0.0, q, v)
    for name in ("box", "door", "right_hand"):
        body = {"box": "box/box", "door": "door/leaf"}.get(name)
        place = world.data.body(body).xpos if body else world.data.site(name).xpos
        np.testing.assert_allclose(tick.frame(name).position, place, atol=1e-9)
    M = np.zeros((system.nv, system.nv))
    mujoco.mj_fullM(world.model, world.data, M)
    # The accelerations that Pinocchio's equation gives without torques and contacts are MuJoCo's, as forces of both.
    world.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    world.model.dof_frictionloss[:] = 0.0
    mujoco.mj_forward(world.model, world.data)
    free = np.linalg.solve(tick.M, -tick.h + friction(tick))
    theirs = world.data.qacc.copy()
    for start in (0, robot.nv):  # linear accelerations of free joints: from the world's axes to the body's, classical
        rotation = tick.frame("waist" if not start else "box").rotation
        own = v[start : start + 6]
        theirs[start : start + 3] = rotation.T @ theirs[start : start + 3] - np.cross(own[3:], own[:3])
    np.testing.assert_allclose(free, theirs, atol=1e-6 * np.abs(theirs).max())
    for name in ("box", "door"):
        own = system.velocities[name]
        np.testing.assert_allclose(np.diag(tick.M)[own], np.diag(M)[own], atol=1e-9)


def friction(tick):
    out = np.zeros(tick.system.nv)
    robot = tick.robot
    out[6 : robot.nv] = robot.friction * np.tanh(tick.v[6 : robot.nv] / tick._joint_losses[2])
    return out


def test_a_second_robot_is_an_actuated_thing(robot):
    other = Thing.of_robot(robot, "partner", placement=(1.0, 0.0, 0.0))
    system = System(robot, [other])
    assert system.na == 2 * robot.na and system.nv == 2 * robot.nv
    assert system.joints[robot.na] == f"partner/{robot.joints[0]}"
    np.testing.assert_array_equal(system.effort, [*robot.effort, *robot.effort])
    tick = Tick(system)
    np.testing.assert_allclose(
        tick.frame("partner/left_foot").position - tick.frame("left_foot").position, [1.0, 0.0, 0.0], atol=1e-9
    )
    assert tick.mass == robot.mass


@pytest.mark.parametrize("name", ["waist", "robot", "box"])
def test_names_that_are_taken_are_refused(robot, name):
    with pytest.raises(InputError, match=f"'{name}' is taken"):
        System(robot, [Thing.load("box"), Thing.load("box", name=name)])


def test_what_is_not_there_is_said_with_what_is(robot, things):
    system = System(robot, things)
    for ask, message in (
        (system.point, "point 'lid'"),
        (system.surface, "surface 'lid'"),
        (system.thing, "thing 'lid'"),
    ):
        with pytest.raises(InputError, match=f"there is no {message}.*box"):
            ask("lid")
