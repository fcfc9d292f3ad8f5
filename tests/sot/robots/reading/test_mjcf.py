"""Models as other people write them: each is the same robot, or is refused by name."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.robots.reading import read_model
from sot.robots.reading.mjcf import joint_efforts
from sot.robots.robot import Robot
from tests.sot.robots.variants import load_variant, write_variant

BALL = '<body name="ball" pos="1 0 0.1"><freejoint/><geom size="0.1" mass="0.4"/></body>'
KEY_END = '0 0 0.1" />'
WRIST = '<joint class="light" name="LARM6"'


def same_robot(one: Robot, other: Robot) -> None:
    """Same posture, points, soles, pairs and mass matrix."""
    assert one.joints == other.joints
    np.testing.assert_allclose(one.rest, other.rest, atol=1e-9)
    data, expected = one.model.createData(), other.model.createData()
    for q in (one.rest, pin.integrate(one.model, one.rest, np.linspace(-0.3, 0.4, one.nv))):
        for robot, d in ((one, data), (other, expected)):
            pin.framesForwardKinematics(robot.model, d, q)
        for point in other.points:
            mine, theirs = data.oMf[one.point(point)], expected.oMf[other.point(point)]
            np.testing.assert_allclose(mine.homogeneous, theirs.homogeneous, atol=1e-7, err_msg=point)
        M = [np.triu(pin.crba(robot.model, d, q)) for robot, d in ((one, data), (other, expected))]
        np.testing.assert_allclose(*M, atol=1e-6)
    for foot in one.feet:
        np.testing.assert_allclose(one.sole(foot), other.sole(foot), atol=1e-9)
    np.testing.assert_allclose(one.rest_distances, other.rest_distances, atol=1e-6)


SAME = {
    "the base is placed and turned": [('name="BODY" pos="0 0 0"', 'name="BODY" pos="0.3 0.2 0.9" euler="0 0 1.57"')],
    "a geom called floor": [("<worldbody>", '<worldbody><geom name="floor" type="plane" size="5 5 .1"/>')],
    "a shape called floor": [('name="BODY_0"', 'name="floor"')],
    "options of a model for a GPU": [
        ("<worldbody>", '<option iterations="1" timestep="0.01" gravity="0 0 0"/><worldbody>')
    ],
    "a sensor": [("<actuator>", '<sensor><gyro site="waist"/></sensor><actuator>')],
    "a frame about the foot": [("<worldbody>", '<worldbody><frame pos="0 0 3" euler="0.1 0 0"/>')],
    "the foot's site is turned": [
        (f'<site name="{side}_foot" pos', f'<site name="{side}_foot" quat="0.7071068 0 0.7071068 0" pos')
        for side in ("left", "right")
    ],
    "the chest's site is turned": [('<site name="chest" pos', '<site name="chest" euler="1.57 0 0" pos')],
}


@pytest.mark.parametrize("what", SAME)
def test_the_same_robot_written_otherwise(tmp_path, what):
    robot = load_variant(tmp_path, model=SAME[what])
    same_robot(robot, Robot.load("hrp2"))
    assert robot.remarks == ()
    assert robot.mujoco_spec().option.iterations == mujoco.MjSpec().option.iterations


def test_an_angle_at_which_a_joint_is_drawn_is_read(tmp_path):
    """A reference angle shifts what a joint's angle means."""
    bent = [('name="HEAD1" axis="0 1 0"', 'name="HEAD1" ref="0.3" axis="0 1 0"')]
    ours, plain = load_variant(tmp_path, bent), Robot.load("hrp2")
    k = 7 + ours.joints.index("HEAD1")
    q = plain.rest.copy()
    q[k] = ours.rest[k] - 0.3
    data, expected = ours.model.createData(), plain.model.createData()
    pin.framesForwardKinematics(ours.model, data, ours.rest)
    pin.framesForwardKinematics(plain.model, expected, q)
    place, other = data.oMf[ours.point("head_top")], expected.oMf[plain.point("head_top")]
    np.testing.assert_allclose(place.translation, other.translation, atol=1e-9)
    np.testing.assert_allclose(place.rotation, np.eye(3), atol=1e-9)


def test_a_scene_that_includes_the_robot(tmp_path):
    path = write_variant(tmp_path, file=[('"hrp2.xml"', '"scene.xml"')])
    ground = '<worldbody><geom name="ground" type="plane" size="5 5 .1"/></worldbody>'
    (tmp_path / "scene.xml").write_text(f'<mujoco model="scene"><include file="hrp2.xml"/>{ground}</mujoco>')
    robot = Robot.load(path)
    same_robot(robot, Robot.load("hrp2"))
    assert robot.remarks == ()


def test_what_is_not_of_the_robot_is_left_out_with_a_remark(tmp_path):
    key = (KEY_END, '0 0 0.1 1 0 0.1 1 0 0 0" />')
    robot = load_variant(tmp_path, [("</worldbody>", BALL + "</worldbody>"), key])
    same_robot(robot, Robot.load("hrp2"))
    assert robot.remarks == ("left out of the model, since they are not of the robot: ball",)


def test_two_hinges_of_one_body_are_two_joints(tmp_path):
    """As if a body without mass lay between them."""
    text = (write_variant(tmp_path).parent / "hrp2.xml").read_text()
    first = text.index('<body name="HEAD1_LINK"')
    hinge = text[
        text.index("<joint", text.index('<body name="HEAD0_LINK"')) : text.index(
            "<inertial", text.index('name="HEAD0"')
        )
    ]
    joined = text.replace(hinge, "").replace(
        text[first : text.index("<joint", first)], text[first : text.index("<joint", first)] + hinge
    )
    (tmp_path / "hrp2.xml").write_text(joined)
    with_two = read_model(tmp_path / "hrp2.xml")
    plain = read_model(write_variant(tmp_path).parent / "hrp2.xml")
    assert list(with_two.model.names) == list(plain.model.names)
    head = next(link for link in with_two.tree.links if link.name == "HEAD1_LINK")
    assert [joint.name for joint in head.joints] == ["HEAD0", "HEAD1"]


def test_couplings_springs_and_tendons_are_remarked_on(tmp_path):
    equality = '<equality><joint joint1="LARM6" joint2="LARM5"/></equality>'
    tendon = '<tendon><fixed name="cable"><joint joint="LARM4" coef="1"/></fixed></tendon>'
    spring = (WRIST, WRIST + ' stiffness="3"')
    robot = load_variant(tmp_path, [("<actuator>", equality + tendon + "<actuator>"), spring])
    same_robot(robot, Robot.load("hrp2"))
    assert robot.remarks == (
        "springs are not modelled: of LARM6",
        "couplings are not modelled: LARM6 and LARM5",
        "tendons are not modelled: cable",
    )


def test_a_base_without_a_joint_is_freed(tmp_path):
    robot = load_variant(tmp_path, [('<freejoint name="root" />', ""), ('qpos="0 0 0.6487018018 1 0 0 0 ', 'qpos="')])
    same_robot(robot, Robot.load("hrp2"))
    assert robot.remarks == ("the base 'BODY' is fixed to the world in the model: it is free here",)


REFUSED = {
    r"joint 'LARM6' slides: .*\[locked\]": [(WRIST, '<joint type="slide" class="light" name="LARM6"')],
    r"joint 'ankle' is a ball joint: .*\[locked\]": [
        ('<site name="head"', '<body><joint name="ankle" type="ball"/><geom size=".1"/></body><site name="head"'),
        ("-0.5236 0 0 0.1 0.2618", "-0.5236 0 0 0.1 0.2618 0 0 0 0"),
    ],
    r"the base 'BODY' needs one free joint": [
        ('<freejoint name="root" />', '<joint name="root" />'),
        ('qpos="0 0 0.6487018018 1 0 0 0 ', 'qpos="0 '),
    ],
    r"link 'tip' moves and has no mass": [
        ('<site name="head"', '<body name="tip"><joint name="tip"/></body><site name="head"')
    ],
    r"MuJoCo cannot read it: .*nonsense": [("<worldbody>", "<nonsense/><worldbody>")],
}


@pytest.mark.parametrize("message", REFUSED)
def test_models_that_are_no_such_robot_are_refused_in_one_line(tmp_path, message):
    path = write_variant(tmp_path, REFUSED[message])
    with pytest.raises(InputError, match=rf"hrp2\.xml: {message}") as error:
        Robot.load(path)
    assert "\n" not in str(error.value)


def test_a_model_without_bodies_is_refused(tmp_path):
    path = write_variant(tmp_path)
    (tmp_path / "hrp2.xml").write_text("<mujoco><worldbody/></mujoco>")
    with pytest.raises(InputError, match=r"hrp2\.xml: there is no body in it"):
        Robot.load(path)


def test_joints_are_locked_at_their_angles(tmp_path):
    """Also the first of two hinges of one body, a slide and a ball."""
    body = '<body name="{}" pos="0.1 0 0"><inertial pos="0 0.1 0" mass="1" diaginertia=".1 .1 .1"/>{}</body>'
    hinges = '<joint name="a" axis="0 0 1" pos="0.1 0 0"/><joint name="b" axis="1 0 0" pos="0 0.2 0" ref="0.1"/>'
    inner = body.format("two", hinges + body.format("slider", '<joint name="s" type="slide" axis="0 1 0"/>'))
    text = body.format("base", "<freejoint/>" + inner).replace("</body></body>", "</body></body>")
    path = tmp_path / "toy.xml"
    path.write_text(f"<mujoco><compiler angle='radian'/><worldbody>{text}</worldbody></mujoco>")
    whole = mujoco.MjModel.from_xml_path(str(path))
    for locked, free in (({"a": 0.4, "s": 0.05}, "b"), ({"b": 0.4, "s": 0.05}, "a")):
        reading = read_model(path, locked)
        data, expected = mujoco.MjData(reading.compiled), mujoco.MjData(whole)
        for joint, angle in (*locked.items(), (free, 0.7)):
            expected.joint(joint).qpos[:] = angle
        data.joint(free).qpos[:] = 0.7
        mujoco.mj_kinematics(whole, expected)
        mujoco.mj_kinematics(reading.compiled, data)
        for link in ("two", "slider"):
            place = data.body(link).xpos - data.body("base").xpos
            np.testing.assert_allclose(place, expected.body(link).xpos - expected.body("base").xpos, atol=1e-12)
            np.testing.assert_allclose(data.body(link).xmat, expected.body(link).xmat, atol=1e-12)


def test_efforts_are_found_wherever_a_model_has_them():
    actuators = """<motor joint="a" gear="50" ctrlrange="-1 2"/><position joint="b" ctrlrange="-1 1" forcerange="-7 9"/>
        <motor joint="c" ctrlrange="-30 30"/><position joint="d" ctrlrange="-1 1"/>"""
    joints = "".join(
        f'<body><joint name="{name}" {more}/><geom size=".1"/></body>'
        for name, more in (("a", ""), ("b", ""), ("c", 'actuatorfrcrange="-20 20"'), ("d", ""), ("e", ""))
    )
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><worldbody>{joints}</worldbody><actuator>{actuators}</actuator></mujoco>"
    )
    np.testing.assert_array_equal(joint_efforts(model), [50.0, 7.0, 20.0, np.inf, np.inf])


def test_an_inertia_that_no_body_has_is_mended_with_a_remark(tmp_path):
    path = write_variant(tmp_path)
    text = (tmp_path / "hrp2.xml").read_text()
    at = text.index('fullinertia="', text.index('name="LARM6_LINK"'))
    end = text.index('"', at + 13)
    (tmp_path / "hrp2.xml").write_text(text[:at] + 'fullinertia="0.0001 0.0001 0.01 0 0 0' + text[end:])
    (remark,) = Robot.load(path).remarks
    assert remark == "inertias that no body can have (A + B < C) are mended, as of link LARM6_LINK"


def test_what_mujoco_warns_of_is_a_remark_and_no_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    robot = load_variant(tmp_path, [('<material name="', '<material specular="nan" name="')])
    assert robot.remarks == ("MuJoCo warns of the model: XML contains a 'NaN'. Please check it carefully.",)
    assert not list(tmp_path.glob("MUJOCO_LOG*"))
