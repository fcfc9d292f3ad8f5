"""Points in the world's axes at rest, a robot that looks along +X, and soles where the feet touch the floor."""

import re

import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.robots.models import hrp2
from sot.robots.posture import UPRIGHT_POINTS
from sot.robots.robot import Robot, shipped_robot_names
from tests.sot.robots.reading.test_mjcf import same_robot
from tests.sot.robots.variants import load_variant, write_variant


def placements(robot: Robot, q: np.ndarray) -> dict[str, pin.SE3]:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return {point: data.oMf[robot.point(point)].copy() for point in robot.points}


@pytest.mark.parametrize("name", shipped_robot_names())
def test_upright_points_have_the_worlds_axes_at_rest(name):
    robot = Robot.load(name)
    at = placements(robot, robot.rest)
    for point in set(UPRIGHT_POINTS) & set(robot.points):
        np.testing.assert_allclose(at[point].rotation, np.eye(3), atol=1e-9)


def test_a_point_of_a_site_takes_the_position_of_the_file(tmp_path):
    """The file's position counts though the model has a site of the point's own name."""
    robot = load_variant(
        tmp_path,
        file=[('left_hand = "left_hand"', 'left_hand = { frame = "left_hand", position = [0.02, 0.0, -0.05] }')],
    )
    ours, plain = placements(robot, robot.rest), placements(Robot.load("hrp2"), robot.rest)
    moved = plain["left_hand"].actInv(ours["left_hand"])
    np.testing.assert_allclose(moved.translation, [0.02, 0.0, -0.05], atol=1e-12)
    sites = {site.name: site for site in robot.mujoco_spec().sites}
    assert sites["left_hand"].pos[2] == pytest.approx(
        robot.model.frames[robot.point("left_hand")].placement.translation[2]
    )


def with_base_heading(text: str, angle: float) -> str:
    """The model whose key frame has the base turned about the vertical by an angle."""
    quaternion = f" {np.cos(angle / 2)} 0 0 {np.sin(angle / 2)} 0"
    assert "0.6487018018 1 0 0 0 0" in text
    return text.replace("0.6487018018 1 0 0 0 0", "0.6487018018" + quaternion)


@pytest.mark.parametrize("quarters", [1, 2, -1])
def test_a_robot_that_looks_elsewhere_is_turned(tmp_path, quarters):
    path = write_variant(tmp_path)
    model = tmp_path / "hrp2.xml"
    model.write_text(with_base_heading(model.read_text(), quarters * np.pi / 2))
    robot = Robot.load(path)
    same_robot(robot, Robot.load("hrp2"))
    (remark,) = robot.remarks
    assert "it is turned to look along +X" in remark


def test_a_base_that_is_drawn_in_other_axes_is_the_same_robot(tmp_path):
    """All that the base is and carries is drawn half a turn away, as iCub's, which looks backwards."""
    path = write_variant(tmp_path)
    model = tmp_path / "hrp2.xml"
    text = model.read_text()
    joint = '<freejoint name="root" />'
    start, end = text.index(joint) + len(joint), text.rindex("</body>")
    inertial, inside = re.match(r"(\s*<inertial[^>]*/>)(.*)", text[start:end], re.DOTALL).groups()
    (x, y, z), (*moments, xy, xz, yz) = (
        [float(number) for number in re.search(rf'{name}="([^"]*)"', inertial).group(1).split()]
        for name in ("pos", "fullinertia")
    )
    numbers = " ".join(map(repr, (*moments, xy, -xz, -yz)))
    mass = re.search(r'mass="[^"]*"', inertial).group()
    inertial = f'<inertial pos="{-x} {-y} {z}" {mass} fullinertia="{numbers}"/>'
    model.write_text(f'{text[:start]}{inertial}<frame quat="0 0 0 1">{inside}</frame>{text[end:]}')
    robot = Robot.load(path)
    same_robot(robot, Robot.load("hrp2"))
    (remark,) = robot.remarks
    assert "180° from +Y in its model: it is turned to look along +X" in remark


def test_swapped_sides_are_refused(tmp_path):
    """All left points on the right: then the toes look backwards where the left is at +Y."""
    text = hrp2.file_texts()["hrp2.toml"]
    points = text[text.index("[points]") : text.index("[soles]")]
    swapped = re.sub(r'= "(left|right)_', lambda m: '= "' + ("right_" if m.group(1) == "left" else "left_"), points)
    with pytest.raises(InputError, match=r"toes look backwards.*left and right swapped"):
        load_variant(tmp_path, file=[(points, swapped)])


def test_a_robot_that_lies_or_looks_aside_is_refused(tmp_path):
    lying, aside = tmp_path / "lying", tmp_path / "aside"
    for folder, key, message in (
        (lying, "0.6487018018 0.7071068 0 0.7071068 0 ", "does not stand at rest"),
        (aside, "0.6487018018 0.92388 0 0 0.382683 ", "45° away from"),
    ):
        folder.mkdir()
        with pytest.raises(InputError, match=rf"hrp2\.toml: .*{message}"):
            load_variant(folder, [("0.6487018018 1 0 0 0 ", key)])


def test_a_sole_off_its_shapes_is_moved_to_them(tmp_path):
    """By 8 mm here, on both feet, with a remark each; the robot then stands where it does without the mistake."""
    text = write_variant(tmp_path).parent / "hrp2.xml"
    model = text.read_text()
    raised = re.sub(r'(name="(?:left|right)_(?:foot|sole_\w+)" pos="\S+ \S+) -0\.105"', r'\1 -0.097"', model)
    assert raised != model
    text.write_text(raised)
    robot, plain = Robot.load(tmp_path / "hrp2.toml"), Robot.load("hrp2")
    assert [remark for remark in robot.remarks if "8.0 mm above the lowest of its shapes" in remark] == list(
        robot.remarks
    )
    assert robot.rest[2] == pytest.approx(plain.rest[2], abs=1e-9)
    np.testing.assert_allclose(
        placements(robot, robot.rest)["left_foot"].homogeneous,
        placements(plain, plain.rest)["left_foot"].homogeneous,
        atol=1e-9,
    )


def test_feet_that_do_not_stand_flat_are_refused(tmp_path):
    bent = "[rest]\nRLEG2 = -0.3\nRLEG3 = 0.6\nRLEG4 = -0.3\n\n[points]"
    with pytest.raises(InputError, match=r"at rest left_foot is .* mm above the other foot|right_foot is .* mm above"):
        load_variant(tmp_path, file=[('rest = "half_sitting"', ""), ("[points]", bent)])
    uneven = tmp_path / "uneven"
    uneven.mkdir()
    corner = '<site name="left_sole_front_out" pos="0.13 0.075 -0.1'
    with pytest.raises(InputError, match=r"'soles.left_foot' is not flat: .* 5.0 mm"):
        load_variant(uneven, [(corner + '05"', corner + '"')])
