"""Soles on rubber: the same robot with a joint more under each ankle, which stands still where it should."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sim.hardware.sole_frames import sole_frames
from sim.hardware.soles import bush_joint, sole_body
from sim.mismatch import Mismatch
from sim.world import World
from sot.hardware import FootCompliance, JointTargets, Sensors, Servo
from sot.hardware.compliance import SOLE_MASS_SHARE, bush_position
from sot.hardware.hardware import Hardware
from sot.robots.robot import Robot, shipped_robot_names
from tests.sot.robots import urdf_robot

SOFT = FootCompliance(2500.0, 2500.0, 239018.0)
WEIGHT = 9.81


def standing(robot: Robot, compliance: FootCompliance | None, seconds: float = 0.5, rate: float = 1000.0) -> World:
    """A robot that its servos hold at rest."""
    world = World(robot, 1.0 / rate, hardware=Hardware(Servo.of(robot), compliance, Sensors()))
    for _ in range(round(seconds * rate)):
        world.step(JointTargets(robot.rest[7:], np.zeros(robot.na)))
    return world


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def soft(robot) -> World:
    return standing(robot, SOFT, 1.5)


@pytest.mark.parametrize("name", shipped_robot_names())
def test_a_robot_on_soles_of_its_own_is_the_robot_that_it_was(name):
    """Mass matrix and gravity at a bent posture, the bushes at rest and their rows left out."""
    robot = Robot.load(name)
    plain, split = World(robot), World(robot, hardware=Hardware(compliance=SOFT))
    q = robot.rest.copy()
    q[7:] += 0.1 * np.random.default_rng(0).uniform(-1.0, 1.0, robot.na)
    own = [k for k in range(split.model.nv) if "bush" not in split.model.joint(split.model.dof_jntid[k]).name]
    masses = []
    for world, rows in ((plain, slice(None)), (split, own)):
        world.reset(q)
        M = np.zeros((world.model.nv, world.model.nv))
        mujoco.mj_fullM(world.model, world.data, M)
        masses.append((M[rows][:, rows], world.data.qfrc_bias[rows], world.data.subtree_com[0]))
        np.testing.assert_allclose(world.state()[0], q, atol=1e-15)
    for ours, theirs in zip(*masses, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-9 * WEIGHT * robot.mass)


def test_only_the_sole_touches_the_floor(robot):
    world = World(robot, hardware=Hardware(compliance=SOFT))
    model = world.model
    for foot in robot.feet:
        sole, ankle = model.body(sole_body(foot)), model.body(model.site(foot).bodyid[0])
        assert model.body_parentid[sole.id] == ankle.id
        assert sole.mass == pytest.approx(SOLE_MASS_SHARE * (sole.mass + ankle.mass))
        collide = [k for k in range(model.ngeom) if model.geom_contype[k]]
        assert any(model.geom_bodyid[k] == sole.id for k in collide)
        assert not any(model.geom_bodyid[k] == ankle.id for k in collide)
    plain = World(robot).model
    assert {model.geom(k).name for k in range(model.ngeom)} == {plain.geom(k).name for k in range(plain.ngeom)}


def test_a_robot_from_a_file_without_a_foot_shape_gets_soles_too(tmp_path):
    robot = Robot.load(urdf_robot.write(tmp_path))
    world = World(robot, hardware=Hardware(compliance=FootCompliance(300.0, 300.0)))
    for foot in robot.feet:
        assert world.model.body(sole_body(foot)).geomnum[0] > 0


def test_rubber_gives_way_by_load_over_stiffness(robot, soft):
    """Each bush, from the forces of the floor on its sole."""
    wrenches, deflections, model = soft.foot_wrenches(), soft.sole_deflections(), soft.model
    q, _ = soft.state()
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    for foot, (roll, pitch, height) in zip(robot.feet, deflections, strict=True):
        at = data.oMf[robot.point(foot)]
        sole_weight = WEIGHT * model.body(sole_body(foot)).mass[0]
        force, moment = wrenches[foot][:3], wrenches[foot][3:]
        about_bush = moment - np.cross(at.rotation @ bush_position(robot, foot), force)
        assert 239018.0 * height == pytest.approx(force[2] - sole_weight, rel=0.02)
        np.testing.assert_allclose([2500.0 * roll, 2500.0 * pitch], about_bush[:2], atol=0.5)


def test_the_robot_on_rubber_stands_on_its_feet_and_nothing_else_touches(robot, soft):
    assert soft.touching() == ()
    assert {pair for pair in soft.touches()} == {("left_foot", "floor"), ("right_foot", "floor")}
    load = sum(wrench[2] for wrench in soft.foot_wrenches().values())
    assert load == pytest.approx(WEIGHT * robot.mass, rel=0.02)
    positions, rotations = sole_frames(robot, soft.state()[0][None], soft.sole_deflections()[None])
    assert np.abs(positions[:, 0, 2]).max() < 5e-4
    assert np.abs(rotations[:, 0, 2, :2]).max() < 5e-4


@pytest.mark.parametrize("rate", [1000.0, 500.0])
@pytest.mark.parametrize("loss", [0.035, 0.1])
def test_soles_do_not_rattle_under_stiff_dampers(robot, rate, loss):
    """Without the dampers' share in what contacts know of a sole, loads swing by 100 N at 20 to 30 Hz."""
    world = standing(robot, FootCompliance(2500.0, 2500.0, 239018.0, loss), 0.6, rate)
    loads = []
    for _ in range(round(0.2 * rate)):
        world.step(JointTargets(robot.rest[7:], np.zeros(robot.na)))
        loads.append(world.foot_wrenches()["left_foot"][2])
        assert world.data.ncon == 8
    assert np.ptp(loads) < 10.0


def test_mismatch_leaves_the_rubber_alone(robot):
    plain, changed = (
        World(robot, mismatch=Mismatch(damping=damping), hardware=Hardware(compliance=SOFT)) for damping in (1.0, 3.0)
    )
    for foot in robot.feet:
        for axis in ("roll", "pitch", "vertical"):
            joint = bush_joint(foot, axis)
            assert changed.model.joint(joint).damping[0] == plain.model.joint(joint).damping[0] > 0.0
    knee = robot.joints[3]
    assert changed.model.joint(knee).damping[0] == 3.0 * plain.model.joint(knee).damping[0]


def test_rigid_feet_have_no_soles_of_their_own_and_no_deflection(robot):
    world = World(robot)
    assert not [k for k in range(world.model.nbody) if world.model.body(k).name == "left_foot_sole"]
    np.testing.assert_array_equal(world.sole_deflections(), np.zeros((2, 3)))
