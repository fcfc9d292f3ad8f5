"""Robot files: what they name, what they refuse, and another robot that is only another file."""

from dataclasses import FrozenInstanceError

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.robots.robot import FEET, POINTS, Robot, shipped_robot_names
from tests.sot.robots import urdf_robot


def test_every_shipped_robot_loads():
    assert shipped_robot_names() == ("hrp2", "hrp2_modified")
    for name in shipped_robot_names():
        robot = Robot.load(name)
        assert robot.name == name
        assert robot.label.startswith("HRP-2-like")
        assert len(robot.joints) == robot.na == robot.nv - 6 == robot.nq - 7
        assert set(POINTS) <= set(robot.points)


def test_limits_are_per_joint_and_sane():
    robot = Robot.load("hrp2")
    for limit in (robot.velocity, robot.acceleration, robot.acceleration_hard, robot.effort):
        assert limit.shape == (robot.na,)
        assert np.all(limit > 0) and np.all(np.isfinite(limit))
    assert np.all(robot.lower < robot.rest[7:]) and np.all(robot.rest[7:] < robot.upper)
    assert np.all(robot.acceleration == 60) and np.all(robot.acceleration_hard == 400)


def test_robot_is_immutable_and_loaded_once():
    robot = Robot.load("hrp2")
    assert Robot.load("hrp2") is robot
    with pytest.raises(FrozenInstanceError):
        robot.name = "other"
    with pytest.raises(ValueError, match="read-only"):
        robot.rest[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        robot.sole("left_foot")[0, 0] = 1.0
    with pytest.raises(TypeError):
        robot.points["waist"] = 0


@pytest.mark.parametrize("name", shipped_robot_names())
def test_groups_partition_the_joints(name):
    robot = Robot.load(name)
    parts = ("left_leg", "right_leg", "chest", "head", "left_arm", "right_arm")
    assert sorted(k for part in parts for k in robot.groups[part]) == list(range(robot.na))
    assert set(robot.groups["legs"]) == {*robot.groups["left_leg"], *robot.groups["right_leg"]}
    assert all(robot.joints[k].startswith("RARM") for k in robot.groups["right_arm"])


@pytest.mark.parametrize("name", shipped_robot_names())
def test_soles_lie_flat_on_the_ground_at_rest(name):
    robot = Robot.load(name)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    for foot in FEET:
        placement = data.oMf[robot.point(foot)]
        np.testing.assert_allclose(placement.rotation, np.eye(3), atol=1e-9)
        corners = np.array([placement.act(corner) for corner in robot.sole(foot)])
        np.testing.assert_allclose(corners[:, 2], 0.0, atol=1e-12)
        assert np.ptp(corners[:, 0]) == pytest.approx(0.230)
        assert np.ptp(corners[:, 1]) == pytest.approx(0.131)


def test_unknown_names_say_what_is_known():
    with pytest.raises(InputError, match=r"unknown robot 'asimo'.*hrp2, hrp2_modified"):
        Robot.load("asimo")
    robot = Robot.load("hrp2")
    with pytest.raises(InputError, match=r"no point 'tail'.*waist"):
        robot.point("tail")
    with pytest.raises(InputError, match=r"no foot 'left_hand'.*left_foot"):
        robot.sole("left_hand")


def test_a_urdf_robot_is_the_same_robot(tmp_path):
    """Same tables through the other format: same dynamics but for the armature, which a URDF cannot say."""
    ours = Robot.load("hrp2")
    urdf = Robot.load(urdf_robot.write(tmp_path))
    assert urdf.joints != ours.joints  # Pinocchio sorts a URDF's branches by name
    order = [ours.joints.index(name) for name in urdf.joints]
    for ours_array, urdf_array in (
        (ours.lower, urdf.lower),
        (ours.upper, urdf.upper),
        (ours.velocity, urdf.velocity),
        (ours.effort, urdf.effort),
        (ours.damping, urdf.damping),
        (ours.friction, urdf.friction),
    ):
        np.testing.assert_allclose(urdf_array, ours_array[order], atol=1e-3)
    assert urdf.rest[2] == pytest.approx(ours.rest[2], abs=1e-9)

    q = pin.randomConfiguration(ours.model, np.full(ours.nq, -1.0), np.full(ours.nq, 1.0))
    q_urdf = np.concatenate((q[:7], q[7:][order]))
    columns = [*range(6), *(6 + np.array(order))]
    M = pin.crba(ours.model, ours.model.createData(), q) - np.diag(np.r_[np.zeros(6), ours.armature])
    M_urdf = pin.crba(urdf.model, urdf.model.createData(), q_urdf)
    symmetric = np.triu(M) + np.triu(M, 1).T
    np.testing.assert_allclose(np.triu(M_urdf) + np.triu(M_urdf, 1).T, symmetric[np.ix_(columns, columns)], atol=1e-9)
    for point in ("left_foot", "right_hand", "head_top"):
        placements = []
        for robot, configuration in ((ours, q), (urdf, q_urdf)):
            data = robot.model.createData()
            pin.framesForwardKinematics(robot.model, data, configuration)
            placements.append(data.oMf[robot.point(point)].homogeneous)
        np.testing.assert_allclose(*placements, atol=1e-9)


BAD_FILES = {
    "not a TOML file": ("[points]", "[points"),
    "'label' is missing": ('label = "A robot from a URDF"', ""),
    "'model' must be a str": ('model = "robot.urdf"', "model = 3"),
    "no model file 'other.urdf' beside it": ("robot.urdf", "other.urdf"),
    "'package.sha256' is missing": ("[rest]", '[package]\nname = "p"\nversion = "1"\n\n[rest]'),
    "'locked' must be a table of joints": ("[rest]", 'locked = "all"\n\n[rest]'),
    "'points.chest' names the frame 'THORAX'": ("CHEST1_LINK", "THORAX"),
    "'points' lacks neck": ('neck = "HEAD0_LINK"', ""),
    "'points.head_top.position' must be three numbers": ("[0, 0, 0.19]", "[0, 0.19]"),
    "'rest' names 'RLEG9', which is no joint": ("RLEG2 = -0.453786", "RLEG9 = -0.453786"),
    "'rest.RLEG2' must be a number": ("RLEG2 = -0.453786", 'RLEG2 = "bent"'),
    "'groups.chest' names 'CHEST7', which is no joint": ('"CHEST0", "CHEST1"', '"CHEST0", "CHEST7"'),
    "'groups.head' is missing": ('head = ["HEAD0", "HEAD1"]', ""),
    "[limits] lacks 'acceleration' of all joints: one number": ("acceleration = 60", ""),
    "[limits] are not positive: 'acceleration' of all joints": ("acceleration = 60", "acceleration = 0"),
    "'soles.left_foot' needs three corners": (", [0.13, -0.056, 0], [-0.1, -0.056, 0], [-0.1, 0.075, 0]", ""),
    "the frame 'LLEG4_LINK' is on another link": ("left_foot = [[0.13, 0.075, 0]", 'left_foot = ["LLEG4_LINK"'),
}


@pytest.mark.parametrize("message", BAD_FILES)
def test_bad_robot_files_are_refused_in_one_line(tmp_path, message):
    good, bad = BAD_FILES[message]
    assert good in urdf_robot.ROBOT_FILE
    path = urdf_robot.write(tmp_path, urdf_robot.ROBOT_FILE.replace(good, bad, 1))
    with pytest.raises(InputError) as error:
        Robot.load(path)
    assert message in str(error.value)
    assert "robot.toml" in str(error.value) and "\n" not in str(error.value)


def test_a_broken_model_or_no_file_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"nowhere.toml: cannot be read"):
        Robot.load(tmp_path / "nowhere.toml")
    path = urdf_robot.write(tmp_path)
    (tmp_path / "robot.urdf").write_text("<robot name=")
    with pytest.raises(InputError, match=r"robot.urdf: Pinocchio cannot read it"):
        Robot.load(path)


def test_effort_in_the_file_overrides_the_model(tmp_path):
    robot = Robot.load(urdf_robot.write(tmp_path, urdf_robot.ROBOT_FILE + "\n[limits.effort]\nLLEG3 = 123\n"))
    assert robot.effort[robot.joints.index("LLEG3")] == 123
    assert robot.effort[robot.joints.index("RLEG3")] == 250
