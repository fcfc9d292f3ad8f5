"""The up axis of a file: from the body, from the zero pose where the clip leaves it open, or as asked for."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion import read, recognise
from sot.motion.human.capture import Capture, find_legs
from sot.motion.human.formats.bvh import read_bvh
from sot.motion.human.world import UP_AXES, to_world, up_axis
from tests.sot.motion.human.clips import Change, changed_groove, lying, seated, short_groove, x_up

Y_TO_Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def written(folder: Path, text: str) -> Path:
    path = folder / "clip.bvh"
    path.write_text(text)
    return path


def found(capture: Capture) -> tuple[int, float]:
    return up_axis(capture, find_legs(capture), 0.01)


@pytest.mark.parametrize("axis", UP_AXES)
def test_any_axis_may_be_up(tmp_path: Path, axis: str) -> None:
    capture = read_bvh(written(tmp_path, short_groove(30)))
    index, sign = UP_AXES[axis]
    turn = np.roll(np.eye(3), index - 1, axis=0)  # Y becomes the axis
    if sign < 0.0:
        turn = np.diag([-1.0, -1.0, -1.0]) @ turn
        turn[(index + 1) % 3] *= -1.0  # a rotation still
    assert np.linalg.det(turn) == pytest.approx(1.0)
    turned = replace(capture, positions=capture.positions @ turn.T, rotations=turn @ capture.rotations, zero_pose=None)
    assert found(turned) == (index, sign)
    np.testing.assert_allclose(to_world(turned).positions, to_world(capture).positions, atol=1e-9)


def test_a_file_with_x_up_is_danced_as_any_other(tmp_path: Path) -> None:
    text = short_groove(40)
    plain = recognise(read(written(tmp_path, text)))
    other = recognise(read(written(tmp_path, x_up(text))))
    for name, place in plain.points.items():
        np.testing.assert_allclose(other.points[name], place, atol=1e-6)
    for body, rotation in plain.frames.items():
        np.testing.assert_allclose(other.frames[body], rotation, atol=1e-6)


@pytest.mark.parametrize("change", [seated, lying])
def test_who_sits_or_lies_does_not_turn_the_room(tmp_path: Path, change: Change) -> None:
    capture = read_bvh(written(tmp_path, changed_groove(change)))
    assert found(capture) == UP_AXES["y"]


def test_who_stands_in_a_file_whose_zero_pose_lies_stands(tmp_path: Path) -> None:
    capture = read_bvh(written(tmp_path, short_groove(30)))
    turned = replace(capture, positions=capture.positions @ Y_TO_Z_UP.T)  # Z up; the zero pose keeps Y up
    assert found(turned) == UP_AXES["z"]


def test_the_up_axis_can_be_asked_for(tmp_path: Path) -> None:
    path = written(tmp_path, short_groove(30))
    np.testing.assert_array_equal(read(path, up="Y").positions, read(path).positions)
    assert read(path, up="-y").positions[0, 0, 2] != pytest.approx(read(path).positions[0, 0, 2])
    with pytest.raises(InputError, match="up axis 'w' is not known: choose one of x, y, z, -x, -y, -z"):
        read(path, up="w")


def test_the_forward_axis_can_be_asked_for(tmp_path: Path) -> None:
    """The dancer faces the file's Z: what is asked to be forward is turned to +X, and the dancer with it."""
    path = written(tmp_path, short_groove(30))
    heading = {way: recognise(read(path, forward=way)).pelvis_frame()[0, :2, 0] for way in ("z", "-z", "x")}
    np.testing.assert_allclose(heading["z"], [1.0, 0.0], atol=0.05)
    np.testing.assert_allclose(heading["-z"], [-1.0, 0.0], atol=0.05)
    np.testing.assert_allclose(heading["x"], [0.0, -1.0], atol=0.05)  # its X is the dancer's left
    with pytest.raises(InputError, match="forward axis 'y' lies along the up axis"):
        read(path, forward="y")


def test_the_unit_can_be_asked_for(tmp_path: Path) -> None:
    path = written(tmp_path, short_groove(30))
    leg = recognise(read(path)).leg
    assert recognise(read(path, unit="cm")).leg == pytest.approx(leg)
    assert recognise(read(path, unit="mm")).leg == pytest.approx(0.1 * leg)
    with pytest.raises(InputError, match="unit 'furlong' is not known: choose one of m, cm, mm, in, cmu, ft"):
        read(path, unit="furlong")


def upside_down(joints: dict[str, np.ndarray]) -> None:
    """On the hands, throughout."""
    joints["Hips"][:] = 0.0, 180.0, 0.0
    joints["place"][:] = 0.0, 112.0, 0.0
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        for joint in ("UpLeg", "Leg", "Foot", "ForeArm"):
            joints[side + joint][:] = 0.0
        joints[f"{side}Arm"][:] = 0.0, 0.0, 85.0 * sign
    for joint in ("Spine", "Spine1", "Spine2"):
        joints[joint][:] = 0.0


def on_all_fours(joints: dict[str, np.ndarray]) -> None:
    """On hands and knees, throughout."""
    upside_down(joints)
    joints["Hips"][:] = 0.0, 85.0, 0.0
    joints["place"][:] = 0.0, 54.0, 0.0
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        joints[f"{side}UpLeg"][:] = 0.0, -85.0, 0.0
        joints[f"{side}Leg"][:] = 0.0, 90.0, 0.0
        joints[f"{side}Foot"][:] = 0.0, 50.0, 0.0
        joints[f"{side}Arm"][:] = -60.0 * sign, 0.0, 0.0


@pytest.mark.parametrize(("change", "words"), [(upside_down, "is upside down"), (on_all_fours, "crawls")])
def test_who_never_stands_has_the_zero_poses_up_axis(tmp_path: Path, change: Change, words: str) -> None:
    path = written(tmp_path, changed_groove(change))
    assert found(read_bvh(path)) == UP_AXES["y"]
    (told,) = recognise(read(path)).remarks
    assert told.words.startswith(f"The dancer {words} from 0.00 to 1.98 s; the robot stands")
