"""One list of pairs that may collide, in physics, in the controller and in plans."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sot.motion.body.clearance import Clearance
from sot.proximity import Proximity
from sot.robots.models import hrp2
from sot.robots.pairs import TOUCHING_DISTANCE
from sot.robots.robot import Robot, shipped_robot_names
from tasks.self_collision import REST_DISTANCE_SHARE, SelfCollision
from tests.sot.robots.variants import load_variant


def names_of(robot: Robot) -> set[tuple[str, str]]:
    shapes = robot.shapes.geometryObjects
    return {(shapes[pair.first].name, shapes[pair.second].name) for pair in robot.shapes.collisionPairs}


@pytest.mark.parametrize("name", shipped_robot_names())
def test_physics_controller_and_plans_have_one_list(name):
    robot = Robot.load(name)
    pairs = names_of(robot)
    compiled = robot.mujoco_spec().compile()
    geoms = zip(compiled.pair_geom1, compiled.pair_geom2, strict=True)
    ordered = {frozenset(pair) for pair in pairs}
    assert {frozenset((compiled.geom(a).name, compiled.geom(b).name)) for a, b in geoms} == ordered
    assert {frozenset(pair) for pair in Proximity(robot).pairs} == ordered
    arm = Clearance.of_arm(robot, "left", 1)
    shapes = robot.shapes.geometryObjects
    carried = {name for a in robot.groups["left_arm"] for name in (s.name for s in shapes if s.parentJoint == 2 + a)}
    in_plan = {frozenset((shapes[p.first].name, shapes[p.second].name)) for p in arm._geometry.collisionPairs}
    assert in_plan == {pair for pair in ordered if pair & carried}


def test_no_other_shapes_of_the_robot_touch_in_physics():
    robot = Robot.load("hrp2")
    compiled = robot.mujoco_spec().compile()
    data = mujoco.MjData(compiled)
    rng = np.random.default_rng(0)
    for _ in range(50):
        data.qpos[7:] = rng.uniform(robot.lower, robot.upper)
        mujoco.mj_forward(compiled, data)
        for contact in data.contact:
            pair = compiled.geom(contact.geom1).name, compiled.geom(contact.geom2).name
            assert pair in names_of(robot) or pair[::-1] in names_of(robot)


def test_rest_distances_are_those_at_rest():
    robot = Robot.load("hrp2")
    data = robot.shapes.createData()
    pin.computeDistances(robot.model, robot.model.createData(), robot.shapes, data, robot.rest)
    np.testing.assert_allclose([r.min_distance for r in data.distanceResults], robot.rest_distances, atol=1e-6)
    assert robot.rest_distances.min() > TOUCHING_DISTANCE


def geom_of(name: str) -> str:
    """The element of a collision shape in the model."""
    model = hrp2.file_texts()["hrp2.xml"]
    at = model.index(f'<geom name="{name}"')
    return model[at : model.index("/>", at) + 2]


@pytest.mark.parametrize(("gap", "watched"), [(0.012, True), (0.002, False)])
def test_legs_near_each_other_are_watched_and_those_that_touch_are_not(tmp_path, gap, watched):
    """Shanks 12 mm apart at rest, as Talos's thighs, keep half of that; shanks 2 mm apart may pass."""
    pair, plain = ("RLEG3_LINK_0", "LLEG3_LINK_0"), Robot.load("hrp2")
    apart = plain.rest_distances[SelfCollision(plain).pairs.index(pair)]
    size = f'size="{float(0.06 + (apart - gap) / 2)}"'
    robot = load_variant(tmp_path, [(geom_of(name), geom_of(name).replace('size="0.06"', size)) for name in pair])
    task = SelfCollision(robot)
    assert (pair in task.pairs) is watched
    if watched:
        index = task.pairs.index(pair)
        assert robot.rest_distances[index] == pytest.approx(gap, abs=1e-6)
        assert task.min_distances[index] == pytest.approx(REST_DISTANCE_SHARE * gap, abs=1e-6)


def test_a_model_may_let_shapes_pass(tmp_path):
    """Excluded bodies and bits that do not meet."""
    exclude = '<contact><exclude body1="LARM5_LINK" body2="LLEG2_LINK"/></contact>'
    robot = load_variant(tmp_path, [("<actuator>", exclude + "<actuator>")])
    assert names_of(Robot.load("hrp2")) - names_of(robot) == {("LLEG2_LINK_0", "LARM5_LINK_0")}


def test_limbs_without_shapes_are_remarked_on(tmp_path):
    shapes = ("LARM2_LINK_0", "LARM3_LINK_0", "LARM5_LINK_0")
    robot = load_variant(tmp_path, [(geom_of(name), "") for name in shapes])
    assert robot.remarks == ("no shape is to collide with the rest of the body, and nothing keeps from it: left arm",)
