"""The one way in: what MuJoCo reads of a model and what Pinocchio is given are the same robot."""

import numpy as np
import pinocchio as pin
import pytest

from sot.robots.reading import read_model
from sot.robots.robot import MODELS, Robot, shipped_robot_names


@pytest.mark.parametrize("name", shipped_robot_names())
def test_shipped_models_are_what_pinocchio_itself_reads(name):
    """Joints, numbers and shapes equal to rounding."""
    path = MODELS / f"{name}.xml"
    ours, theirs = Robot.load(name).model, pin.buildModelFromMJCF(str(path))
    assert list(ours.names)[2:] == list(theirs.names)[2:]
    for array in ("armature", "damping", "upperDryFrictionLimit"):
        np.testing.assert_array_equal(getattr(ours, array), getattr(theirs, array))
    for array in ("lowerPositionLimit", "upperPositionLimit"):
        np.testing.assert_array_equal(getattr(ours, array)[7:], getattr(theirs, array)[7:])
    assert [j.shortname() for j in ours.joints.tolist()] == [j.shortname() for j in theirs.joints.tolist()]
    for mine, other in zip(ours.inertias, theirs.inertias, strict=True):
        np.testing.assert_allclose(mine.matrix(), other.matrix(), rtol=1e-13, atol=1e-15)
    for mine, other in zip(ours.jointPlacements, theirs.jointPlacements, strict=True):
        np.testing.assert_allclose(mine.homogeneous, other.homogeneous, atol=1e-15)
    shapes = Robot.load(name).shapes.geometryObjects
    expected = pin.buildGeomFromMJCF(theirs, str(path), pin.GeometryType.COLLISION).geometryObjects
    assert [shape.name for shape in shapes] == [shape.name for shape in expected]
    for mine, other in zip(shapes, expected, strict=True):
        assert mine.parentJoint == other.parentJoint and type(mine.geometry) is type(other.geometry)
        np.testing.assert_allclose(mine.placement.translation, other.placement.translation, atol=1e-12)
        one, another = mine.placement.rotation, other.placement.rotation  # a capsule has no up and down
        np.testing.assert_allclose(np.abs(one), np.abs(another), atol=1e-12)


@pytest.mark.parametrize("name", shipped_robot_names())
def test_rest_is_the_key_frame_of_the_file(name):
    key = read_model(MODELS / f"{name}.xml").key_frames["half_sitting"]
    robot = Robot.load(name)
    np.testing.assert_array_equal(robot.rest[7:], [key.angles[joint] for joint in robot.joints])
    np.testing.assert_array_equal(key.rotation, np.eye(3))
