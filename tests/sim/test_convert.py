"""Pinocchio and MuJoCo must mean the same robot: conversions, and both dynamics on random states."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sim.convert import state_from_mujoco, state_to_mujoco
from sot.robots.robot import Robot, shipped_robot_names
from tests.sot.robots import urdf_robot

STATES = 100


def random_states(robot: Robot, count: int, seed: int = 0):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        quaternion = rng.normal(size=4)
        base = np.concatenate((rng.uniform(-1, 1, 3), quaternion / np.linalg.norm(quaternion)))
        yield np.concatenate((base, rng.uniform(robot.lower, robot.upper))), rng.normal(size=robot.nv)


@pytest.fixture(scope="module", params=[*shipped_robot_names(), "urdf"])
def robot(request, tmp_path_factory) -> Robot:
    if request.param == "urdf":
        return Robot.load(urdf_robot.write(tmp_path_factory.mktemp("robot")))
    return Robot.load(request.param)


@pytest.fixture(scope="module")
def model(robot) -> mujoco.MjModel:
    return robot.mujoco_spec().compile()


def to_mujoco_velocity(robot: Robot, q: np.ndarray) -> np.ndarray:
    """T with v_mujoco = T v_pinocchio."""
    T = np.eye(robot.nv)
    T[:3, :3] = pin.Quaternion(q[3:7]).matrix()
    return T


def symmetric(M: np.ndarray) -> np.ndarray:
    return np.triu(M) + np.triu(M, 1).T


def test_round_trip(robot):
    for q, v in random_states(robot, 20):
        q_back, v_back = state_from_mujoco(*state_to_mujoco(q, v))
        np.testing.assert_array_equal(q_back, q)
        np.testing.assert_allclose(v_back, v, atol=1e-14)


def test_arguments_are_left_alone_and_results_are_new(robot):
    q, v = next(random_states(robot, 1))
    q0, v0 = q.copy(), v.copy()
    qpos, qvel = state_to_mujoco(q, v)
    qpos[:], qvel[:] = 0, 0
    np.testing.assert_array_equal(q, q0)
    np.testing.assert_array_equal(v, v0)


def test_velocities_mean_the_same_motion(robot, model):
    """Integrating either velocity by its own library for a moment ends in the same configuration."""
    dt = 1e-6
    for q, v in random_states(robot, 20):
        qpos, qvel = state_to_mujoco(q, v)
        mujoco.mj_integratePos(model, qpos, qvel, dt)
        q_next, _ = state_from_mujoco(qpos, qvel)
        moved = pin.difference(robot.model, q, q_next) / dt
        np.testing.assert_allclose(moved, v, atol=1e-5)


def test_joints_have_one_order(robot, model):
    assert tuple(model.joint(1 + k).name for k in range(robot.na)) == robot.joints


def test_dynamics_agree(robot, model):
    """Mass matrix, bias forces and centre of mass, once converted."""
    data, mj = robot.model.createData(), mujoco.MjData(model)
    M_mj = np.zeros((model.nv, model.nv))
    for q, v in random_states(robot, STATES):
        mj.qpos[:], mj.qvel[:] = state_to_mujoco(q, v)
        mujoco.mj_forward(model, mj)
        mujoco.mj_fullM(model, mj, M_mj)
        T = to_mujoco_velocity(robot, q)
        M = symmetric(pin.crba(robot.model, data, q))
        np.testing.assert_allclose(T.T @ M_mj @ T, M, atol=1e-9)

        # MuJoCo's base acceleration is that of the origin in the world, Pinocchio's the spatial one in the base.
        drift = np.zeros(robot.nv)
        drift[:3] = T[:3, :3] @ np.cross(v[3:6], v[:3])
        h = pin.nonLinearEffects(robot.model, data, q, v)
        np.testing.assert_allclose(T.T @ (mj.qfrc_bias + M_mj @ drift), h, atol=1e-9)
        np.testing.assert_allclose(mj.subtree_com[0], pin.centerOfMass(robot.model, data, q), atol=1e-12)


def test_points_agree(robot, model):
    """Position and Jacobian of every operational point."""
    data, mj = robot.model.createData(), mujoco.MjData(model)
    sites = [model.site(name).id for name in robot.points]
    J_mj = np.zeros((len(sites), 6, model.nv))
    for q, v in random_states(robot, STATES):
        mj.qpos[:], mj.qvel[:] = state_to_mujoco(q, v)
        mujoco.mj_fwdPosition(model, mj)
        pin.computeJointJacobians(robot.model, data, q)
        pin.updateFramePlacements(robot.model, data)
        positions = [data.oMf[frame].translation for frame in robot.points.values()]
        np.testing.assert_allclose(mj.site_xpos[sites], positions, atol=1e-12)
        for J, site in zip(J_mj, sites, strict=True):
            mujoco.mj_jacSite(model, mj, J[:3], J[3:], site)
        J_pin = [
            pin.getFrameJacobian(robot.model, data, frame, pin.LOCAL_WORLD_ALIGNED) for frame in robot.points.values()
        ]
        np.testing.assert_allclose(J_mj @ to_mujoco_velocity(robot, q), J_pin, atol=1e-9)
