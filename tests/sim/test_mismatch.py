"""A plant that differs: by as much as it says, unseen in the robot that the controller knows, and repeatably."""

import numpy as np
import pytest

from sim.mismatch import Mismatch
from sim.world import World
from sot.errors import InputError
from sot.robots.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


def test_mass_and_damping_are_scaled_in_the_world_only(robot):
    plain, heavy = World(robot), World(robot, mismatch=Mismatch(mass=1.1, damping=2.0))
    assert heavy.model.body_subtreemass[1] == pytest.approx(1.1 * robot.mass)
    np.testing.assert_allclose(heavy.model.body_inertia, 1.1 * plain.model.body_inertia)
    np.testing.assert_allclose(heavy.model.dof_damping, 2.0 * plain.model.dof_damping)
    assert heavy.robot is robot
    assert plain.model.dof_damping[6:].all()


def test_gear_friction_holds_a_joint_against_less_than_its_share_of_the_limit(robot):
    plain, rough = World(robot), World(robot, mismatch=Mismatch(gear_friction=0.1))
    wrist = robot.joints.index("RARM6")
    added = rough.model.dof_frictionloss - plain.model.dof_frictionloss
    np.testing.assert_allclose(added, [*np.zeros(6), *(0.1 * robot.effort)])
    for share, moves in ((0.09, False), (0.2, True)):
        rough.reset(robot.rest)
        torque = np.zeros(robot.na)
        torque[wrist] = share * robot.effort[wrist]
        for _ in range(50):
            rough.step(torque)
        assert (abs(rough.state()[1][6 + wrist]) > 0.5) == moves


@pytest.mark.parametrize("rate", [1000.0, 200.0])
def test_torque_acts_after_the_delay(robot, rate):
    world = World(robot, 1.0 / rate, Mismatch(delay=0.002))
    first, second = np.full(robot.na, 1.0), np.full(robot.na, 2.0)
    late = round(0.002 / world.model.opt.timestep)
    world.step(first)
    np.testing.assert_array_equal(world.data.ctrl, first)  # from the start, whatever the delay
    acting = []
    for _ in range(3):
        world.step(second)
        acting.append(world.data.ctrl[0])
    substeps = round(1.0 / (rate * world.model.opt.timestep))
    assert acting == [1.0 if (k + 1) * substeps <= late else 2.0 for k in range(3)]


def test_noise_is_that_of_the_seed_and_leaves_the_world_alone(robot):
    def readings(seed: int) -> np.ndarray:
        world = World(robot, mismatch=Mismatch(noise=0.05, seed=seed))
        read = np.array([world.measured(*world.state())[1] for _ in range(200)])
        assert not world.state()[1].any()
        np.testing.assert_array_equal(world.measured(*world.state())[0], robot.rest)
        return read

    once = readings(3)
    np.testing.assert_array_equal(once, readings(3))
    assert np.abs(once - readings(4)).max() > 0.05
    assert not once[:, :3].any()
    assert np.std(once[:, 3:]) == pytest.approx(0.05, rel=0.03)


@pytest.mark.parametrize("bad", [{"mass": 0.0}, {"friction": 0.9}, {"delay": -0.001}, {"noise": float("nan")}])
def test_bad_numbers(bad):
    with pytest.raises(InputError, match=f"mismatch {next(iter(bad))}="):
        Mismatch(**bad)
