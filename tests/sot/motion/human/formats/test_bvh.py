"""The BVH reader against hand-computed kinematics, an independent reader, and files that are broken in every way."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sot.errors import InputError
from sot.motion import read
from sot.motion.human.formats.bvh import read_bvh
from tests.sot.motion.human.clips import short_groove

ROOT = Path(__file__).parents[5]
GROOVE = ROOT / "scenarios/inputs/data/groove.bvh"
MOCAP = ROOT / "../shared/mocap"
ARM = """HIERARCHY
ROOT base
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT upper arm {
    OFFSET 1 0 0
    CHANNELS 4 Yposition Yrotation Zrotation Xrotation
    JOINT hand
    {
      OFFSET 0 2 0
      CHANNELS 1 Xrotation
      End Site
      {
        OFFSET 0 0 3
      }
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.0333333
5 6 7 90 0 0   4   0 0 0   0
0 0 0 0 90 90  0  90 0 90  90
"""


def turn(axis: str, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    about = {"X": [[1, 0, 0], [0, c, -s], [0, s, c]], "Y": [[c, 0, s], [0, 1, 0], [-s, 0, c]]}
    return np.array(about.get(axis, [[c, -s, 0], [s, c, 0], [0, 0, 1]]))


def written(folder: Path, text: str | bytes) -> Path:
    path = folder / "clip.bvh"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_forward_kinematics_by_hand(tmp_path: Path) -> None:
    capture = read_bvh(written(tmp_path, ARM))
    assert capture.joints == ("base", "upper arm", "hand", "hand_end")
    assert capture.parents == (-1, 0, 1, 2)
    assert capture.rate == 30.0
    # A quarter turn about Z takes the arm's offset, its Y replaced by the channel: (1, 4, 0) -> (-4, 1, 0).
    np.testing.assert_allclose(capture.positions[0], [[5, 6, 7], [1, 7, 7], [-1, 7, 7], [-1, 7, 10]], atol=1e-12)
    base = turn("X", 90) @ turn("Y", 90)
    arm = base @ turn("Y", 90) @ turn("X", 90)
    hand = arm @ turn("X", 90)
    np.testing.assert_allclose(capture.rotations[1], [base, arm, hand, hand], atol=1e-12)
    shoulder = base @ [1, 0, 0]
    wrist = shoulder + arm @ [0, 2, 0]
    np.testing.assert_allclose(capture.positions[1], [[0, 0, 0], shoulder, wrist, wrist + hand @ [0, 0, 3]], atol=1e-12)


def clips() -> list[Path]:
    return [GROOVE, *sorted(MOCAP.glob("*.bvh"))]


@pytest.mark.parametrize("path", clips(), ids=lambda path: path.stem)
def test_agrees_with_an_independent_reader(path: Path) -> None:
    bvhio = pytest.importorskip("bvhio")
    capture = read_bvh(path)
    theirs = bvhio.readAsHierarchy(str(path))
    for frame in (0, capture.frames // 2, capture.frames - 1):
        theirs.loadPose(frame)
        for joint, _, _ in theirs.layout():
            if joint.Name in capture.joints:
                ours = capture.positions[frame, capture.joints.index(joint.Name)]
                np.testing.assert_allclose(ours, list(joint.PositionWorld), atol=1e-2)  # it counts in float32


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("\n", "\r\n"),
        ("  ", "\t"),
        ("Frames: 2", "Frames: 1"),
        ("Frames: 2", "frames:\t3"),
        ("Zrotation Xrotation Yrotation", "ZROTATION xrotation yRotation"),
        ("HIERARCHY", "\ufeff\n\nHIERARCHY"),
        ("MOTION", "\nMOTION\n"),
        ("End Site\n      {\n        OFFSET 0 0 3\n      }", "End Site { OFFSET 0 0 3 }"),
    ],
)
def test_reads_what_other_programs_write(tmp_path: Path, old: str, new: str) -> None:
    expected = read_bvh(written(tmp_path, ARM))
    other = read_bvh(written(tmp_path, ARM.replace(old, new)))
    assert other.joints == expected.joints
    np.testing.assert_array_equal(other.positions, expected.positions)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("HIERARCHY", "HIERARCHIE", "line 1: not a BVH"),
        ("JOINT hand", "JOINT base", "line 9: a second joint is named 'base'"),
        ("JOINT hand", "JOINT", "line 9: a joint without a name"),
        ("JOINT hand", "ROOT hand", "line 9: one ROOT"),
        ("OFFSET 0 2 0", "OFFSET 0 2", "line 11: expected 3 numbers"),
        ("OFFSET 0 2 0", "OFFSET 0 two 0", "line 11: expected 3 numbers"),
        ("      OFFSET 0 2 0\n", "", "joint 'hand' has no OFFSET"),
        ("CHANNELS 1 Xrotation", "CHANNELS 2 Xrotation", "line 12: CHANNELS says '2' but names 1"),
        ("CHANNELS 1 Xrotation", "CHANNELS 1 Wrotation", "line 12: unknown channel"),
        ("CHANNELS 1 Xrotation", "CHANNELS 2 Xrotation Xrotation", "line 12: a channel is named twice"),
        ("0.0333333", "0", "line 22: a frame time of 0 s is not plausible"),
        ("0.0333333", "33.3", "line 22: a frame time of 33.3 s is not plausible"),
        ("Frame Time: 0.0333333", "", "line 23: expected 'Frames:' and 'Frame Time:'"),
        ("90 0 0   4", "90 0 0", "line 23: expected 11 numbers, found 10"),
        ("5 6 7", "5 nan 7", "line 23: a value is not finite"),
        ("5 6 7", "5 six 7", "line 23: not a number: 'six'"),
        ("Frames: 2", "Frames: 20", "ends after 2 of 20 frames"),
        (ARM[ARM.index("5 6 7") :], "", "holds 0 frames"),
        (ARM[ARM.index("Frames") :], "", "line 20: the file ends before its frames"),
        (ARM[ARM.index("MOTION") :], "", "line 19: the file ends before MOTION"),
    ],
)
def test_says_what_is_wrong_and_where(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in ARM
    with pytest.raises(InputError, match=message) as error:
        read_bvh(written(tmp_path, ARM.replace(old, new, 1)))
    assert "clip.bvh" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("data", "message"), [(b"", "empty"), (b" \n", "empty"), (b"\x00\x01\x02", "binary")])
def test_refuses_what_is_no_text(tmp_path: Path, data: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_bvh(written(tmp_path, data))


def test_refuses_what_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        read(tmp_path / "absent.bvh")
    with pytest.raises(InputError, match=r"supported: .*\.bvh"):
        read(tmp_path / "clip.mp4")
    with pytest.raises(InputError, match=r"make a BVH of it in Blender"):
        read(tmp_path / "clip.fbx")


@settings(deadline=None, max_examples=150)
@given(data=st.data())
def test_a_damaged_file_is_bad_input_and_nothing_else(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    text = bytearray(short_groove().encode())
    damage = data.draw(st.sampled_from(["cut", "overwrite", "remove", "number"]))
    at = data.draw(st.integers(0, len(text) - 1))
    if damage == "cut":
        del text[at:]
    elif damage == "overwrite":
        text[at : at + 3] = data.draw(st.binary(min_size=1, max_size=6))
    elif damage == "remove":
        del text[at : at + data.draw(st.integers(1, 400))]
    else:
        words = text.split(b" ")
        words[at % len(words)] = data.draw(
            st.sampled_from([b"1e308", b"-1e9", b"inf", b"0", b"1e-300", b"", b"{", b"}"])
        )
        text = bytearray(b" ".join(words))
    path = written(tmp_path_factory.mktemp("fuzz"), bytes(text))
    try:
        capture = read(path)
    except InputError as error:
        assert "\n" not in str(error)
    else:
        assert np.isfinite(capture.positions).all()


@pytest.mark.skipif(not MOCAP.is_dir(), reason="needs the shared clips")
def test_reads_a_dance_quickly() -> None:
    from time import process_time  # what other processes take does not count

    started = process_time()
    read_bvh(MOCAP / "perfume_A.bvh")
    assert process_time() - started < 1.0  # 0.08 s on a free machine
