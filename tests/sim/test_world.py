"""The world: it obeys physics, measures what is there, and never helps."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sim.mismatch import Mismatch
from sim.world import World
from solvers import Cascade
from sot.control.controller import Controller
from sot.control.pose import Pose
from sot.robots.robot import Robot, shipped_robot_names
from tasks import OperationalPoint
from tests.sot.robots import urdf_robot
from tests.sot.stances import standing_stack


def stand(world: World, seconds: float) -> None:
    """Joint PD about the rest posture with the torques that carry the weight there, half on each foot."""
    robot = world.robot
    data = robot.model.createData()
    gravity = pin.computeGeneralizedGravity(robot.model, data, robot.rest)
    pin.computeJointJacobians(robot.model, data, robot.rest)
    pin.updateFramePlacements(robot.model, data)
    jacobians = [
        pin.getFrameJacobian(robot.model, data, robot.point(foot), pin.LOCAL_WORLD_ALIGNED) for foot in robot.feet
    ]
    wrenches = np.linalg.lstsq(np.vstack([J[:, :6] for J in jacobians]).T, gravity[:6], rcond=None)[0]
    carry = (gravity - np.vstack(jacobians).T @ wrenches)[6:]
    # Gentle where a link without rotor inertia (a URDF has none) would shake at 1 kHz.
    stiffness, damping = np.full(robot.na, 30.0), np.full(robot.na, 0.5)
    supporting = [*robot.groups["legs"], *robot.groups["chest"]]
    stiffness[supporting], damping[supporting] = 3000.0, 30.0
    for _ in range(round(seconds / world.timestep)):
        q, v = world.state()
        world.step(carry + stiffness * (robot.rest[7:] - q[7:]) - damping * v[6:])


@pytest.fixture(scope="module", params=shipped_robot_names())
def standing(request) -> World:
    world = World(Robot.load(request.param))
    stand(world, 0.5)
    return world


def test_starts_at_rest_on_its_soles():
    world = World(Robot.load("hrp2"))
    q, v = world.state()
    np.testing.assert_array_equal(q, world.robot.rest)
    np.testing.assert_array_equal(v, 0.0)
    assert world.time == 0.0
    assert world.self_distance() > 0.02


def test_stands_and_the_floor_carries_the_weight(standing):
    weight = 9.81 * standing.robot.mass
    q, _ = standing.state()
    assert q[2] == pytest.approx(standing.robot.rest[2], abs=0.005)
    assert standing.touching() == ()
    wrenches = standing.foot_wrenches()
    assert set(wrenches) == set(standing.robot.feet)
    assert sum(w[2] for w in wrenches.values()) == pytest.approx(weight, rel=0.01)
    assert all(w[2] > 0.4 * weight for w in wrenches.values())
    assert standing.contact_points().shape == (8, 6)


def test_zmp_is_inside_the_soles_and_under_the_centre_of_mass(standing):
    q, _ = standing.state()
    com = pin.centerOfMass(standing.robot.model, standing.robot.model.createData(), q)
    np.testing.assert_allclose(standing.zmp(), com[:2], atol=0.005)
    points = standing.contact_points()
    assert np.all(points[:, :2].min(0) < standing.zmp()) and np.all(standing.zmp() < points[:, :2].max(0))


def test_sensors_agree_with_each_contact(standing):
    """MuJoCo's own net wrenches against the sum over contacts, foot by foot."""
    robot = standing.robot
    points = standing.contact_points()
    left = points[:, 1] > 0
    for foot, mine in (("left_foot", left), ("right_foot", ~left)):
        site = standing.data.site(foot).xpos
        moment = np.cross(points[mine, :3] - site, points[mine, 3:]).sum(0)
        np.testing.assert_allclose(standing.foot_wrenches()[foot], (*points[mine, 3:].sum(0), *moment), atol=1e-9)
    load = points[:, 5].sum()
    origin = np.cross(points[:, :3], points[:, 3:]).sum(0)
    np.testing.assert_allclose(standing.zmp(), (-origin[1] / load, origin[0] / load), atol=1e-9)
    assert load == pytest.approx(9.81 * robot.mass, rel=0.01)


def test_newton_holds_and_nobody_helps(standing):
    """The floor's force and gravity alone accelerate the centre of mass; no external wrench is applied."""
    model, data = standing.model, standing.data
    assert not data.xfrc_applied.any() and not data.qfrc_applied.any()
    assert model.neq == 0
    standing.step(np.zeros(standing.robot.na))
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    force = standing.contact_points()[:, 3:].sum(0)
    # The rows of the base's translation are the robot's momentum balance.
    np.testing.assert_allclose(M[:3] @ data.qacc + data.qfrc_bias[:3], force, atol=1e-6 * 9.81 * standing.robot.mass)


@pytest.mark.parametrize("friction", [0.3, 0.7])
def test_friction_is_the_one_asked_for(friction):
    world = World(Robot.load("hrp2"), mismatch=Mismatch(friction=friction))
    stand(world, 0.02)
    assert len(world.data.contact.friction) == 8
    np.testing.assert_array_equal(world.data.contact.friction[:, :2], friction)
    assert world.model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC


def test_feet_slide_when_friction_cannot_hold_them():
    """Pushed sideways harder than the cone allows, the feet carry no more than the friction."""
    world = World(Robot.load("hrp2"), mismatch=Mismatch(friction=0.3))
    stand(world, 0.1)
    world.data.xfrc_applied[world.model.body("BODY").id, :3] = (0.0, 300.0, 0.0)
    stand(world, 0.1)
    points = world.contact_points()
    tangential = np.linalg.norm(points[:, 3:5], axis=1)
    assert np.all(tangential <= 0.3 * points[:, 5] * (1 + 1e-6) + 1e-9)
    assert world.data.body("LLEG5_LINK").cvel[4] > 0.05
    assert world.data.xfrc_applied.any()  # the push is the user's: a step leaves it


def test_feet_stay_under_a_twisting_body():
    """What a contact neglects, J̇ v, must not add up: on MuJoCo's own floor these feet creep by 0.7 mm."""
    world = World(Robot.load("hrp2"))
    stack = standing_stack(world.robot)
    for still in ("waist RPY", "chest RPY"):
        stack.remove(still)

    def twisting(t: float) -> Pose:
        rate, yaw = 2.0 * np.pi, np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.25])
        angle, speed, acceleration = (
            np.sin(rate * t) ** 2,
            rate * np.sin(2 * rate * t),
            2 * rate**2 * np.cos(2 * rate * t),
        )
        return Pose(np.zeros(3), pin.exp3(angle * yaw[3:]), speed * yaw, acceleration * yaw)

    stack.add(OperationalPoint(world.robot, "waist", twisting, axes="RPY"), "trunk")
    controller = Controller(world.robot, stack, Cascade())
    feet = [controller.tick.frame(foot).position[:2].copy() for foot in world.robot.feet]
    for k in range(1000):
        world.step(controller(0.001 * k, *world.state()).torque)
        assert controller.tick.frame("waist").rotation[0, 0] > 0.9
    crept = [
        controller.tick.frame(foot).position[:2] - place for foot, place in zip(world.robot.feet, feet, strict=True)
    ]
    assert np.linalg.norm(crept, axis=1).max() < 3e-4


def test_a_limp_robot_falls_and_says_what_touches():
    world = World(Robot.load("hrp2"))
    for _ in range(1500):
        world.step(np.zeros(world.robot.na))
    assert world.touching()
    assert not any("LEG5" in body for body in world.touching())


def test_in_the_air_nothing_is_felt():
    world = World(Robot.load("hrp2"))
    q = world.robot.rest.copy()
    q[2] += 0.5
    world.reset(q)
    for _ in range(10):
        world.step(np.zeros(world.robot.na))
    assert np.isnan(world.zmp()).all()
    assert world.contact_points().shape == (0, 6)
    assert world.touching() == ()
    np.testing.assert_array_equal(np.array(list(world.foot_wrenches().values())), 0.0)


def test_control_period_is_cut_into_short_physics_steps():
    world = World(Robot.load("hrp2"), timestep=0.005)
    world.step(np.zeros(world.robot.na))
    assert world.time == pytest.approx(0.005)
    assert world.model.opt.timestep == pytest.approx(0.001)
    stand(world, 0.5)
    assert world.touching() == ()


def test_motors_clip_at_the_effort_limits():
    world = World(Robot.load("hrp2"))
    world.step(1e4 * np.ones(world.robot.na))
    np.testing.assert_allclose(world.data.qfrc_actuator[6:], world.robot.effort)


def test_reset_sets_the_state_and_starts_over():
    world = World(Robot.load("hrp2"))
    stand(world, 0.05)
    q, v = world.robot.rest.copy(), np.linspace(-0.1, 0.1, world.robot.nv)
    q[2] += 1.0
    world.reset(q, v)
    assert world.time == 0.0
    np.testing.assert_allclose(world.state()[0], q, atol=1e-14)
    np.testing.assert_allclose(world.state()[1], v, atol=1e-14)


def may_meet(a: str, b: str) -> bool:
    """Whether two collision shapes of the HRP-2-like robot are meant to meet, by the names of their limbs."""
    limbs = {name[:4] for name in (a, b)}
    if len(limbs) == 1:
        return False
    if limbs & {"RARM", "LARM"}:
        return True
    return bool(limbs & {"RLEG", "LLEG"}) and "BODY" not in limbs


def test_self_distance_is_the_least_between_limbs_that_may_meet():
    world = World(Robot.load("hrp2"))
    model = world.model
    shapes = [g for g in range(model.ngeom) if model.geom_group[g] == 3]
    pairs = [(a, b) for a in shapes for b in shapes if a < b and may_meet(model.geom(a).name, model.geom(b).name)]
    rng = np.random.default_rng(1)
    collided = set()
    for _ in range(40):
        q = world.robot.rest.copy()
        q[7:] = rng.uniform(world.robot.lower, world.robot.upper)
        world.reset(q)
        every = [mujoco.mj_geomDistance(model, world.data, a, b, 10.0, None) for a, b in pairs]
        assert world.self_distance() == pytest.approx(min(every), abs=1e-12)
        touches_itself = any(model.geom_bodyid[geoms].min() > 0 for geoms in world.data.contact.geom)
        assert touches_itself == (world.self_distance() < 0)
        collided.add(touches_itself)
    assert collided == {True, False}


def test_a_urdf_robot_stands_too(tmp_path):
    """No motors and no rotors' inertia in the model: the same world all the same."""
    world = World(Robot.load(urdf_robot.write(tmp_path)))
    q = world.robot.rest.copy()
    q[7:] = 0.5 * (world.robot.lower + world.robot.upper)
    world.reset(q)
    np.testing.assert_array_equal(world.state()[0], q)
    world.reset(world.robot.rest)
    stand(world, 0.5)
    assert world.touching() == ()
    assert world.state()[0][2] == pytest.approx(world.robot.rest[2], abs=0.005)
    assert sum(w[2] for w in world.foot_wrenches().values()) == pytest.approx(9.81 * world.robot.mass, rel=0.01)
    np.testing.assert_array_equal([world.model.actuator(k).name for k in range(world.model.nu)], world.robot.joints)
