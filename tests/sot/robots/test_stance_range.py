import numpy as np
import pinocchio as pin
import pytest

from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.stance_range import PLANNED_DISTANCE_LEGS, Stance, leg_pairs, planned_distances
from tasks import SelfCollision
from tests.sot.robots.thick_legs import with_thick_legs


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def test_ankles_are_where_they_are_wanted(robot):
    stance, data = Stance(robot), robot.model.createData()
    turns = [pin.utils.rotate("z", yaw) @ pin.utils.rotate("x", 0.1) for yaw in (0.2, -0.1)]
    ankles = [leg.ankle - leg.hip + [0.02, 0.01, 0.03] for leg in stance.legs]
    q = stance.configuration(stance.postures([leg.rest for leg in stance.legs], ankles, turns))
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    at_rest = [data.oMf[robot.point(f"{side}_ankle")].rotation.copy() for side in ("left", "right")]
    pin.framesForwardKinematics(robot.model, data, q)
    for leg, side, ankle, turn, before in zip(stance.legs, ("left", "right"), ankles, turns, at_rest, strict=True):
        pose = data.oMf[robot.point(f"{side}_ankle")]
        np.testing.assert_allclose(pose.translation, leg.hip + ankle, atol=2e-3)
        np.testing.assert_allclose(pose.rotation, turn @ before, atol=3e-3)


def test_legs_that_do_not_reach_have_no_posture(robot):
    stance = Stance(robot)
    rest = [leg.rest for leg in stance.legs]
    too_long = [1.2 * (leg.ankle - leg.hip) for leg in stance.legs]
    assert stance.postures(rest, too_long, [np.eye(3), np.eye(3)]) is None


def test_legs_are_apart_as_far_as_plans_keep_them(robot):
    """HRP-2's thighs are 64 mm apart at rest: with 25 mm more each 14 mm, of which a plan keeps three quarters."""
    thick = with_thick_legs(robot, 0.025)
    for one, kept in ((robot, PLANNED_DISTANCE_LEGS * leg_length(robot)), (thick, 0.75 * 0.014)):
        stance = Stance(one)
        assert stance.are_apart([leg.rest for leg in stance.legs])
        assert planned_distances(one, one.rest_distances)[_thighs(one)] == pytest.approx(kept, abs=1e-4)
        inward = [leg.rest.copy() for leg in stance.legs]
        for angles, way in zip(inward, (-1.0, 1.0), strict=True):
            angles[1] += way * 0.2  # a hip that rolls in
        assert not stance.are_apart(inward)


def test_plans_keep_more_than_the_controller(robot):
    """Half as much again or more, of every pair."""
    task = SelfCollision(robot)
    kept = dict(zip(task.pairs, task.min_distances, strict=True))
    shapes = robot.shapes
    for pair, planned in zip(
        shapes.collisionPairs, planned_distances(robot, robot.rest_distances).tolist(), strict=True
    ):
        names = shapes.geometryObjects[pair.first].name, shapes.geometryObjects[pair.second].name
        assert planned > 1.49 * kept[names]


def test_feet_are_no_pair(robot):
    names = [shape.name for shape in robot.shapes.geometryObjects]
    found = [(names[right], names[left]) for right, left in leg_pairs(robot)]
    assert ("RLEG2_LINK_0", "LLEG2_LINK_0") in found
    assert all(right.startswith("RLEG") and left.startswith("LLEG") for right, left in found)
    feet = {robot.model.frames[robot.point(foot)].parentJoint for foot in robot.feet}
    owners = [shape.parentJoint for shape in robot.shapes.geometryObjects]
    assert not any(owners[right] in feet and owners[left] in feet for right, left in leg_pairs(robot))


def _thighs(robot):
    names = [shape.name for shape in robot.shapes.geometryObjects]
    pairs = [{names[pair.first], names[pair.second]} for pair in robot.shapes.collisionPairs]
    return pairs.index({"RLEG2_LINK_0", "LLEG2_LINK_0"})
