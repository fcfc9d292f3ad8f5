"""The HRP-2-like models: what is committed, and whether it stands as the published figures say."""

import numpy as np
import pinocchio as pin
import pytest

from sot.robots.models import hrp2
from sot.robots.robot import MODELS, Robot

NAMES = ("hrp2", "hrp2_modified")


@pytest.fixture(params=NAMES)
def robot(request) -> Robot:
    return Robot.load(request.param)


def at(robot: Robot, q: np.ndarray, *points: str) -> list[np.ndarray]:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return [data.oMf[robot.point(point)].translation.copy() for point in points]


@pytest.mark.parametrize("file", hrp2.file_texts())
def test_committed_files_are_what_the_tables_write(file):
    assert (MODELS / file).read_text(encoding="utf-8") == hrp2.file_texts()[file]


def test_joint_order():
    chains = {"RLEG": 6, "LLEG": 6, "CHEST": 2, "HEAD": 2, "RARM": 7, "LARM": 7}
    expected = tuple(f"{chain}{k}" for chain, count in chains.items() for k in range(count))
    assert Robot.load("hrp2").joints == expected
    modified = Robot.load("hrp2_modified").joints
    assert tuple(j for j in modified if j not in ("CHEST2", "HEAD2")) == expected
    assert modified.index("CHEST2") == modified.index("CHEST1") + 1


def test_mass_is_the_quoted_one(robot):
    assert robot.mass == pytest.approx(58.0, abs=1e-9)


def test_half_sitting_is_the_published_one(robot):
    com = pin.centerOfMass(robot.model, robot.model.createData(), robot.rest)
    np.testing.assert_allclose(com, (0.01, 0.0, 0.81), atol=0.002)
    right, left, waist = at(robot, robot.rest, "right_ankle", "left_ankle", "waist")
    np.testing.assert_allclose(right, (0.0095, -0.095, 0.105), atol=1e-5)
    np.testing.assert_allclose(left, (0.0095, 0.095, 0.105), atol=1e-5)
    np.testing.assert_allclose(waist, (0.0, 0.0, 0.648702), atol=1e-6)


def test_stretched_size(robot):
    q = pin.neutral(robot.model)
    top, sole, hip, knee, ankle = at(robot, q, "head_top", "left_foot", "left_hip", "left_knee", "left_ankle")
    assert top[2] - sole[2] == pytest.approx(1.54, abs=0.001)
    assert -sole[2] == pytest.approx(0.705)
    np.testing.assert_allclose(np.cross(knee - hip, ankle - hip), 0.0, atol=1e-12)  # a straight leg is straight


def test_left_mirrors_right(robot):
    """Mirrored angles put the left points where the mirror shows the right ones."""
    rng = np.random.default_rng(0)
    q = robot.rest.copy()
    right = dict(zip(robot.joints, rng.uniform(robot.lower, robot.upper), strict=True))
    for k, name in enumerate(robot.joints):
        if name.startswith("R"):
            q[7 + k] = right[name]
        elif name.startswith("L"):
            twin = "R" + name[1:]
            q[7 + k] = right[twin] * (1.0 if hrp2.JOINTS[twin][0] == "y" else -1.0)
            assert robot.lower[k] <= q[7 + k] <= robot.upper[k]
    for point in ("knee", "foot", "toe", "elbow", "hand"):
        left, mirrored = at(robot, q, f"left_{point}", f"right_{point}")
        np.testing.assert_allclose(left, mirrored * (1, -1, 1), atol=1e-12)


def test_roll_joints_change_no_mass():
    """With its roll joints at zero the modified robot is the same body: same momentum map of the free base."""
    inertias = []
    for name in NAMES:
        model = Robot.load(name).model
        data = model.createData()
        pin.ccrba(model, data, Robot.load(name).rest, np.zeros(model.nv))
        inertias.append(data.Ig.matrix())
    np.testing.assert_allclose(*inertias, atol=1e-9)


def test_velocity_limits_follow_the_gears():
    robot = Robot.load("hrp2")
    assert robot.velocity[robot.joints.index("LLEG3")] == pytest.approx(785.4 / 200, abs=1e-3)
    assert robot.velocity[robot.joints.index("RARM5")] == pytest.approx(785.4 / 350, abs=1e-3)


def test_torque_limits_and_losses(robot):
    figures = {
        "RLEG3": (250, 0.5, 0.3, 0.54),
        "CHEST0": (100, 0.5, 0.3, 0.30),
        "LARM1": (100, 0.2, 0.1, 0.33),
        "LARM3": (60, 0.2, 0.1, 0.40),
        "HEAD1": (50, 0.2, 0.1, 0.10),
        "RARM6": (20, 0.2, 0.1, 0.02),
    }
    for joint, expected in figures.items():
        k = robot.joints.index(joint)
        assert (robot.effort[k], robot.damping[k], robot.friction[k], robot.armature[k]) == expected
