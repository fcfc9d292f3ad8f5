"""A guess gives back what is known of a robot, whatever it is called and however it stands in its model."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.robots.guess import Sureness, guess, robot_file
from sot.robots.robot import FEET, GROUPS, MODELS, Robot
from tests.sot.robots.guess.toys import humanoid

HRP2 = MODELS / "hrp2.xml"


@pytest.fixture(scope="module")
def hrp2():
    return guess(HRP2)


def guessed(folder: Path, text: str, name: str = "robot.xml"):
    """A guess from the text of a model."""
    (folder / name).write_text(text)
    return guess(folder / name)


def loaded(found, folder: Path) -> Robot:
    """The robot of the file that a guess writes."""
    (folder / "robot.toml").write_text(robot_file(found, folder))
    return Robot.load(folder / "robot.toml")


def positions(robot: Robot) -> dict[str, np.ndarray]:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    return {name: data.oMf[frame].translation.copy() for name, frame in robot.points.items()}


def corners(robot: Robot, foot: str) -> np.ndarray:
    around = positions(robot)[foot] + robot.sole(foot)
    return around[np.lexsort(np.round(around, 4).T)]


def test_the_shipped_robot_comes_out_as_its_file_has_it(hrp2, tmp_path):
    robot, known = loaded(hrp2, tmp_path), Robot.load("hrp2")
    for group in GROUPS:
        assert [robot.joints[k] for k in robot.groups[group]] == [known.joints[k] for k in known.groups[group]]
    found, there = positions(robot), positions(known)
    for name, place in there.items():
        np.testing.assert_allclose(found[name], place, atol=0.03, err_msg=name)
    for foot in FEET:
        np.testing.assert_allclose(corners(robot, foot), corners(known, foot), atol=1e-3)
        assert np.ptp(corners(robot, foot)[:, 2]) < 1e-4
    np.testing.assert_allclose(robot.rest, known.rest, atol=1e-6)  # its key frame
    assert robot.remarks == ()


def test_names_do_not_matter(hrp2, tmp_path):
    text, names = HRP2.read_text(), {}
    for kind in ("joint", "body"):
        for k, name in enumerate(re.findall(rf'<{kind} [^>]*?name="([^"]+)"', text)):
            names[name] = f"{kind[0]}{k}"
    text = re.sub(r'"([^"]+)"', lambda match: f'"{names.get(match[1], match[1])}"', text)
    text = re.sub(r"<site [^>]*/>", "", text)
    found = guessed(tmp_path, text)
    for group, joints in hrp2.body.groups.items():
        wanted = [names[hrp2.posed.joint_name(j)] for j in joints]
        assert [found.posed.joint_name(j) for j in found.body.groups[group]] == wanted
    heading = next(each for each in found.evidence if each.what == "heading")
    assert "names" not in heading.why


def test_rest_is_solved_where_no_key_frame_fits(hrp2, tmp_path):
    found = guessed(tmp_path, re.sub(r"<keyframe>.*</keyframe>", "", HRP2.read_text(), flags=re.S))
    robot = loaded(found, tmp_path)  # refused if the soles were not flat
    at = positions(robot)
    leg = [np.linalg.norm(at[f"left_{a}"] - at[f"left_{b}"]) for a, b in (("hip", "knee"), ("knee", "ankle"))]
    assert np.linalg.norm(at["left_hip"] - at["left_ankle"]) == pytest.approx(0.94 * sum(leg), rel=1e-3)
    com = pin.centerOfMass(robot.model, robot.model.createData(), robot.rest)
    assert com[0] == pytest.approx(corners(robot, "left_foot")[:, 0].mean(), abs=5e-3)
    for side in ("left", "right"):
        down = at[f"{side}_elbow"] - at[f"{side}_shoulder"]
        assert down[2] < -0.9 * np.linalg.norm(down)
        assert at[f"{side}_wrist"][0] > at[f"{side}_elbow"][0] + 0.05  # forearms forward


@pytest.mark.parametrize("foot", ["box", "spheres", "capsules"])
@pytest.mark.parametrize("waist_first", [False, True])
def test_arms_that_stick_out_hang_at_rest_and_a_waist_before_the_legs_is_the_chest_s(foot, waist_first, tmp_path):
    found = guessed(tmp_path, humanoid(t_pose=True, waist_first=waist_first, foot=foot))
    groups = {group: [found.posed.joint_name(j) for j in joints] for group, joints in found.body.groups.items()}
    assert [len(joints) for joints in groups.values()] == [6, 6, 1, 2, 4, 4]
    assert len({joint for joints in groups.values() for joint in joints}) == 23
    if waist_first:
        assert found.body.chest == found.posed.base != found.body.pelvis
    at = positions(loaded(found, tmp_path))
    assert at["left_elbow"][2] < at["left_shoulder"][2] - 0.2
    assert at["left_elbow"][1] > at["left_shoulder"][1]
    for side, across in (("left", 0.04), ("right", -0.04)):
        sole = found.soles[side][:, :2] - found.points.places[f"{side}_ankle"].at[:2]
        assert np.ptp(sole[:, 0]) >= 0.16 - 1e-6
        assert sole[:, 0].mean() == pytest.approx(0.03, abs=1e-3)
        assert across * sole[:, 1].max() <= 0.05 * 0.04 + 1e-9


@pytest.mark.parametrize("turn_deg", [90.0, 180.0])
def test_a_robot_that_looks_elsewhere_is_turned(turn_deg, tmp_path):
    found = guessed(tmp_path, humanoid(turn_deg=turn_deg))
    assert np.cos(found.yaw + np.deg2rad(turn_deg)) == pytest.approx(1.0, abs=1e-6)
    at = positions(loaded(found, tmp_path))
    assert at["left_hip"][1] > 0.05
    assert at["left_toe"][0] > at["left_ankle"][0]


def test_a_fixed_base_is_freed(tmp_path):
    assert loaded(guessed(tmp_path, humanoid(fixed=True)), tmp_path).na == 23


def test_fingers_and_what_follows_others_are_locked(tmp_path):
    hand = "".join(
        f'<body pos="{{at}}"><inertial pos="0 0 0" mass="0.01" diaginertia="1e-5 1e-5 1e-5"/>'
        f'<joint type="{kind}" axis="1 0 0" range="0 0.02"/><geom size="0.005"/></body>'
        for kind in ("hinge", "slide")
    )
    found = guessed(tmp_path, humanoid(fingers=hand))
    assert len(found.body.locked) == 4
    assert len(found.body.groups["left_arm"]) == 4
    robot = loaded(found, tmp_path)
    assert robot.na == 23
    assert any(each.what == "locked" and "fingers" in each.why for each in found.evidence)


def test_a_model_without_motors_gets_limits_by_scale_and_says_so(tmp_path):
    found = guessed(tmp_path, humanoid(motors=False))
    kinds = {each.what: each.sureness for each in found.evidence}
    assert kinds["effort limits"] == kinds["velocity limits"] == Sureness.UNSURE
    robot = loaded(found, tmp_path)
    knee = robot.joints.index(found.posed.joint_name(found.points.bends["left_leg"]))
    assert 0.1 < robot.effort[knee] / (robot.mass * 9.81 * 0.6) < 1.0


def test_velocities_come_from_a_urdf_beside_the_model(tmp_path):
    limits = "".join(
        f'<joint name="j{k}" type="revolute"><limit effort="30" velocity="{k + 1}"/></joint>' for k in range(23)
    )
    (tmp_path / "same.urdf").write_text(f'<robot name="r">{limits}</robot>')
    content = tomllib.loads(robot_file(guessed(tmp_path, humanoid()), tmp_path))
    assert content["limits"]["velocity"]["j4"] == 5.0
    assert "effort" not in content["limits"]  # the model's own are better


def test_motors_with_damping_and_heavy_rotors_are_not_asked_for_all_of_their_effort(tmp_path):
    text = humanoid().replace('armature="0.02"', 'armature="1" damping="10"')
    content = tomllib.loads(robot_file(guessed(tmp_path, text), tmp_path))
    assert content["limits"]["velocity"] == 6.4  # 0.8 · 80 N m / 10
    assert content["limits"]["acceleration"] == 40.0  # 0.5 · 80 N m / 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<mujoco/>", "no body"),
        ('<mujoco><worldbody><body><freejoint/><geom size="1"/></body></worldbody></mujoco>', "no two legs"),
        ("<mujoco><worldbody>", "cannot be read"),
        (re.sub(r"<body pos=\"0 0.25 0.4\">.*?</body></body>", "", humanoid(motors=False)), "no arms"),
    ],
    ids=["empty", "ball", "broken", "no arms"],
)
def test_what_is_no_humanoid_is_one_line(text, message, tmp_path):
    with pytest.raises(InputError, match=message) as error:
        guessed(tmp_path, text)
    assert "\n" not in str(error.value)
