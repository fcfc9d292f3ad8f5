"""What a user adds to the world is there, and the robot collides with it."""

import mujoco
import numpy as np
import pytest

from sim import RobotState, World, build_model
from sot.errors import InputError
from sot.robots import Robot, shipped_robot_names

TABLE = """
<mujoco>
  <option timestep="0.5" gravity="0 0 0"/>
  <worldbody>
    <geom name="table" type="box" size="0.2 0.4 0.02" pos="0.7 0 0.6"/>
    <geom name="mark" type="sphere" size="0.1" pos="0.7 0 0.8" contype="0" conaffinity="0"/>
    <body name="ball" pos="0.7 0 0.9"><freejoint/><geom name="ball" type="sphere" size="0.05" mass="0.1"/></body>
  </worldbody>
</mujoco>
"""


def table(spec):
    spec.worldbody.add_geom(name="table", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.2, 0.4, 0.02], pos=[0.7, 0.0, 0.6])


@pytest.fixture(params=shipped_robot_names())
def robot(request):
    return Robot.load(request.param)


def test_text_becomes_bodies_that_collide_under_the_world_s_own_options(robot):
    world = World(robot, 0.002, scene=TABLE)
    assert world.model.opt.timestep == 0.001 and world.model.opt.gravity[2] == pytest.approx(-9.81)
    assert not world.model.geom("scene/mark").conaffinity[0]
    for _ in range(500):
        world.step(np.zeros(robot.na))
    ball = world.data.body("scene/ball")
    assert ball.xpos[2] == pytest.approx(0.67, abs=0.005)  # it has fallen through the mark, onto the table


@pytest.mark.parametrize("scene", [TABLE, table], ids=["text", "function"])
def test_the_robot_s_state_and_torques_are_as_without(robot, scene):
    alone, among = World(robot, 0.002), World(robot, 0.002, scene=scene)
    torque = 5.0 * np.random.default_rng(0).standard_normal(robot.na)
    for world in (alone, among):
        world.reset(robot.rest, np.full(robot.nv, 0.01))
        for _ in range(20):
            world.step(torque)
    np.testing.assert_allclose(among.state()[0], alone.state()[0], atol=1e-9)
    np.testing.assert_allclose(among.state()[1], alone.state()[1], atol=1e-9)


def test_every_part_of_the_robot_that_may_collide_meets_what_is_added(robot):
    model = build_model(robot, scene=table)
    added = model.geom("table")
    own = [k for k in range(model.ngeom) if model.body_rootid[model.geom_bodyid[k]] == 1 and model.geom_contype[k]]
    assert own
    for k in own:
        assert (model.geom_contype[k] & added.conaffinity[0]) or (added.contype[0] & model.geom_conaffinity[k])


def test_a_state_is_found_wherever_the_robot_is_in_the_model():
    robot = Robot.load("hrp2")
    model = build_model(robot, scene=TABLE)
    data = mujoco.MjData(model)
    state = RobotState(robot, model, data)
    rng = np.random.default_rng(1)
    q, v = robot.rest + 0.0, rng.standard_normal(robot.nv)
    q[7:] += 0.1 * rng.standard_normal(robot.na)
    state.write(q, v)
    for read, wanted in zip(state.read(), (q, v), strict=True):
        np.testing.assert_allclose(read, wanted, atol=1e-12)
    np.testing.assert_array_equal(data.body("scene/ball").xpos, 0.0)  # nobody has moved anything else yet
    assert model.key_qpos.size == 0


def test_a_model_without_the_robot_says_what_is_missing():
    robot = Robot.load("hrp2")
    model = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    with pytest.raises(InputError, match=f"no joint .*{robot.joints[0]}.* of HRP-2"):
        RobotState(robot, model, mujoco.MjData(model))


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        ("<mujoco><worldbody><gem/></worldbody></mujoco>", "scene: MuJoCo cannot read it: .*gem"),
        ("<mujoco><worldbody>", "scene: MuJoCo cannot read it"),
        ("<mujoco><worldbody><geom type='box'/></worldbody></mujoco>", "cannot compile it and the scene"),
    ],
)
def test_a_scene_that_mujoco_cannot_read_is_one_line(scene, message):
    with pytest.raises(InputError, match=message) as told:
        World(Robot.load("hrp2"), scene=scene)
    assert "\n" not in str(told.value)
