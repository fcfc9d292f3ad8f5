"""Acclaim files: kinematics against the same motion in a BVH, what programs write, and damage as bad input."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.motion import read
from sot.motion.human.formats.acclaim import DEFAULT_RATE_HZ, read_acclaim
from sot.motion.human.formats.bvh import read_bvh

ASF = """# a comment
:version 1.10
:name someone
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
   root and bonedata are words here
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name thigh
     direction 0 -1 0
     length 7
     axis 0 0 20 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
     id 2
     name shank
     direction 0 -2 0
     length 6
     axis 90 0 90 ZXY
    dof rz ry
  end
  begin
     id 3
     name sole
     direction 0 0 1
     length 2
     axis 0 0 0 XYZ
  end
  begin
     id 4
     name spine
     direction 0 1 0
     length 5
     axis 0 0 0 XYZ
    dof ry
  end
:hierarchy
  begin
    root thigh spine
    thigh shank
    shank sole
  end
"""
AMC = """#!a comment
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 0 0 90
thigh 0 0 0
shank 0 0
spine 30
2
root 1 2 3 10 20 30
thigh -15 25 35
shank 40 -50
spine -60
"""


def written(folder: Path, skeleton: str, motion: str | bytes, name: str = "clip") -> Path:
    """The motion's path, the skeleton beside it under the same name."""
    (folder / f"{name}.asf").write_text(skeleton, encoding="utf-8")
    path = folder / f"{name}.amc"
    path.write_bytes(motion if isinstance(motion, bytes) else motion.encode())
    return path


def turn(order: str, *degrees: float) -> np.ndarray:
    """About axes that stay, in order."""
    return Rotation.from_euler(order.lower(), degrees, degrees=True).as_matrix()


def test_forward_kinematics_by_hand(tmp_path: Path) -> None:
    capture = read_acclaim(written(tmp_path, ASF, AMC))
    assert capture.joints == ("root", "thigh", "spine", "shank", "sole", "spine_end", "sole_end")
    assert capture.parents == (-1, 0, 0, 1, 3, 2, 4)
    assert (capture.rate, capture.frames, capture.name) == (DEFAULT_RATE_HZ, 2, "clip")
    # A quarter turn about Z takes down to the right, and up to the left.
    here = [[1, 2, 3], [1, 2, 3], [1, 2, 3], [8, 2, 3], [14, 2, 3], [-4, 2, 3], [14, 2, 5]]
    np.testing.assert_allclose(capture.positions[0], here, atol=1e-12)

    root = turn("XYZ", 10, 20, 30)
    axes = turn("Z", 20)
    thigh = root @ axes @ turn("XYZ", -15, 25, 35) @ axes.T
    axes = turn("ZXY", 90, 90, 0)  # the angles are of X, Y, Z; the letters say in which order they are turned
    shank = thigh @ axes @ turn("ZY", 40, -50) @ axes.T
    spine = root @ turn("Y", -60)
    knee = [1, 2, 3] + thigh @ [0, -7, 0]
    ankle = knee + shank @ [0, -6, 0]
    tips = [1, 2, 3] + spine @ [0, 5, 0], ankle + shank @ [0, 0, 2]
    hip = [1, 2, 3]
    np.testing.assert_allclose(capture.positions[1], [hip, hip, hip, knee, ankle, *tips], atol=1e-12)
    turns = [root, thigh, spine, shank, shank, spine, shank]
    np.testing.assert_allclose(capture.rotations[1], turns, atol=1e-12)


def test_agrees_with_the_same_motion_in_a_bvh(tmp_path: Path) -> None:
    """The BVH's joints have the world's axes at zero, and its channels stand in the opposite order."""
    plain = ASF.replace("axis 0 0 20 XYZ", "axis 0 0 0 XYZ").replace("axis 90 0 90 ZXY", "axis 0 0 0 XYZ")
    values = np.random.default_rng(4).uniform(-170, 170, size=(5, 12))
    frames = "".join(
        f"{k}\nroot {_text(v[:6])}\nthigh {_text(v[6:9])}\nshank {_text(v[9:11])}\nspine {_text(v[11:])}\n"
        for k, v in enumerate(values, start=1)
    )
    ours = read_acclaim(written(tmp_path, plain, frames))
    reverse = [0, 1, 2, 5, 4, 3, 8, 7, 6, 10, 9, 11]
    bvh = tmp_path / "same.bvh"
    bvh.write_text(
        "HIERARCHY\nROOT root { OFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n"
        "JOINT thigh {\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Yrotation Xrotation\n"
        "JOINT shank {\nOFFSET 0 -7 0\nCHANNELS 2 Yrotation Zrotation\n"
        "JOINT sole {\nOFFSET 0 -6 0\nEnd Site {\nOFFSET 0 0 2\n}\n}\n}\n}\n"
        "JOINT spine {\nOFFSET 0 0 0\nCHANNELS 1 Yrotation\nEnd Site {\nOFFSET 0 5 0\n}\n}\n}\nMOTION\n"
        "Frames: 5\nFrame Time: 0.01\n" + "".join(_text(v[reverse]) + "\n" for v in values)
    )
    theirs = read_bvh(bvh)
    order = [theirs.joints.index(name) for name in ours.joints]
    np.testing.assert_allclose(ours.positions, theirs.positions[:, order], atol=1e-9)
    np.testing.assert_allclose(ours.rotations, theirs.rotations[:, order], atol=1e-9)


def _text(values: np.ndarray) -> str:
    return " ".join(repr(float(value)) for value in values)


def _radians(text: str) -> str:
    """The motion with its angles in radians."""
    lines = []
    for line in text.splitlines():
        name, *values = line.split()
        kept = 3 if name == "root" else 0
        turned = [repr(float(np.radians(float(v)))) for v in values[kept:]] if name.isalpha() else values[kept:]
        lines.append(" ".join([name, *values[:kept], *turned]))
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("skeleton", "motion"),
    [
        (ASF.replace("\n", "\r\n"), AMC.replace("\n", "\r\n")),
        (ASF.replace(":bonedata", ":BONEDATA").replace("dof rx ry rz", "DOF RX, RY, RZ"), AMC.replace("\n", "\n\n")),
        (ASF.replace("  angle deg\n", ""), AMC),
        (ASF.replace("begin\n    root thigh spine", "begin\n    root thigh\n    root spine"), AMC),
        (ASF, AMC.replace("thigh 0 0 0\nshank 0 0\n", "shank 0 0\nthigh 0 0 0\n")),
        (ASF, AMC.replace("2\nroot", "8\nroot").replace("1\nroot", "7\nroot")),
        (ASF, _radians(AMC).replace(":DEGREES", ":RADIANS")),
    ],
)
def test_reads_what_other_programs_write(tmp_path: Path, skeleton: str, motion: str) -> None:
    expected = read_acclaim(written(tmp_path, ASF, AMC))
    other = read_acclaim(written(tmp_path, skeleton, motion))
    assert other.joints == expected.joints
    np.testing.assert_allclose(other.positions, expected.positions, atol=1e-9)


def test_angles_and_rate_are_the_file_s_where_it_says(tmp_path: Path) -> None:
    radians = ASF.replace("angle deg", "angle rad").replace("0 0 20", f"0 0 {np.pi / 9!r}")
    radians = radians.replace("90 0 90", f"{np.pi / 2!r} 0 {np.pi / 2!r}")
    motion = _radians(AMC).replace(":DEGREES", ":samples-per-second 60")
    capture = read_acclaim(written(tmp_path, radians, motion))
    np.testing.assert_allclose(capture.positions, read_acclaim(written(tmp_path, ASF, AMC)).positions, atol=1e-9)
    assert capture.rate == 60.0


def test_either_file_finds_the_other(tmp_path: Path) -> None:
    same = written(tmp_path, ASF, AMC, "01")
    expected = read_acclaim(same).positions
    np.testing.assert_array_equal(read_acclaim(same.with_suffix(".asf")).positions, expected)
    take = written(tmp_path, ASF, AMC, "01_02")
    take.with_suffix(".asf").unlink()
    np.testing.assert_array_equal(read_acclaim(take).positions, expected)  # the only skeleton
    (tmp_path / "02.asf").write_text(ASF.replace("length 7", "length 9"))
    np.testing.assert_array_equal(read_acclaim(take).positions, expected)  # the one that the name begins with
    other = take.rename(tmp_path / "walk.amc")
    with pytest.raises(InputError, match=r"walk.amc: which skeleton is meant, 01.asf, 02.asf\? name its own walk.asf"):
        read_acclaim(other)
    with pytest.raises(InputError, match=r"02.asf: which motion is meant, 01.amc, walk.amc\? give one of them"):
        read_acclaim(tmp_path / "02.asf")
    for skeleton in tmp_path.glob("*.asf"):
        skeleton.unlink()
    with pytest.raises(InputError, match=r"walk.amc: its skeleton \(.asf\) is missing"):
        read_acclaim(other)
    with pytest.raises(InputError, match="No such file"):
        read(tmp_path / "absent.amc")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (":version 1.10\n", "", None),
        ("# a comment\n:version 1.10\n", "HIERARCHY\n", "line 1: not an ASF"),
        (":bonedata", ":bones", "has no :bonedata"),
        (ASF[ASF.index(":hierarchy") :], "", "has no :hierarchy"),
        ("   order TX TY TZ RX RY RZ\n", "", "its :root has no order"),
        ("TX TY TZ", "TX TY TY", "line 11: a degree of freedom is named twice"),
        ("orientation 0 0 0", "orientation 0 90 0", "line 14: .* turned root .* make it 0 0 0"),
        ("     name shank\n", "", "line 27: the bone that begins here has no name"),
        ("     length 6\n", "", "line 27: the bone that begins here has no length"),
        ("name shank", "name thigh", "line 27: a second bone is named 'thigh'"),
        ("direction 0 -2 0", "direction 0 0 0", "line 27: bone 'shank' needs a length of at least 0, and a direction"),
        ("length 6", "length -6", "line 27: bone 'shank' needs"),
        ("length 6", "length nan", "line 31: expected a number, found 'nan'"),
        ("direction 0 -2 0", "direction 0 -2", "line 30: expected 3 numbers"),
        ("90 0 90 ZXY", "90 0 ZXY", "line 32: expected 3 numbers"),
        ("90 0 90 ZXY", "90 0 90 ZXX", "line 32: expected three angles and the order"),
        ("dof rz ry", "dof rz l", "line 33: 'l' cannot be read here, where rx, ry, rz can"),
        ("    shank sole\n", "    shank toes\n", "line 54: no bone is named 'toes'"),
        ("    shank sole\n", "", "does not lead from the root to 'sole'"),
        ("root thigh spine\n    thigh shank", "root spine\n    shank thigh\n    thigh shank", "not lead .* 'thigh'"),
        ("    shank sole\n", "    shank sole thigh\n", "line 54: 'thigh' starts at one bone's end only"),
        ("  end\n:hierarchy", ":hierarchy", "what begins at line 42 has no end; it is truncated"),
        ("    shank sole\n  end\n", "    shank sole\n", "what begins at line 51 has no end"),
        ("  begin\n    root", "    root", "line 51: 'root' does not belong here"),
    ],
)
def test_says_what_is_wrong_with_a_skeleton(tmp_path: Path, old: str, new: str, message: str | None) -> None:
    assert old in ASF
    path = written(tmp_path, ASF.replace(old, new, 1), AMC)
    if message is None:
        assert read_acclaim(path).frames == 2
        return
    with pytest.raises(InputError, match=message) as error:
        read_acclaim(path)
    assert "clip.asf" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (AMC, "HIERARCHY\nROOT Hips\n", "line 1: not an AMC"),
        ("shank 0 0\n", "", "frame 1 holds nothing for 1 bones, 'shank' first"),
        ("shank 40 -50\nspine -60\n", "", "frame 2 holds nothing for 2 bones, 'spine' first; is it truncated"),
        ("shank 40 -50\nspine -60\n", "shank 40", r"line 12: 'shank' needs 2 numbers \(rz ry\) and has 1"),
        ("shank 0 0", "shank 0 0 0", r"line 7: 'shank' needs 2 numbers \(rz ry\) and has 3"),
        ("shank 0 0", "sole 0", "line 7: 'sole' needs no numbers and has 1"),
        ("shank 0 0", "shank 0 nan", "line 7: expected 2 numbers, found '0 nan'"),
        ("shank 0 0", "shank 0 one", "line 7: expected 2 numbers, found '0 one'"),
        ("shank 0 0", "thigh 0 0 0", "line 7: 'thigh' stands twice in frame 1"),
        ("shank 0 0", "calf 0 0", "line 7: 'calf' is no bone of clip.asf; is it the skeleton of this motion"),
        ("2\nroot", "3\nroot", "line 9: frame 3 follows frame 1; some are missing"),
        (AMC[AMC.index("2\nroot") :], "", "holds 1 frames"),
        (AMC[AMC.index("1\nroot") :], "", "holds 0 frames"),
        (":DEGREES", ":samples-per-second 1e9", "line 3: 1e\\+09 frames a second are not plausible"),
    ],
)
def test_says_what_is_wrong_with_a_motion(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in AMC
    with pytest.raises(InputError, match=message) as error:
        read_acclaim(written(tmp_path, ASF, AMC.replace(old, new, 1)))
    assert "clip.amc" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("data", "message"), [(b"", "empty"), (b"\x00\x01", "a binary file.*; give an AMC")])
def test_refuses_what_is_no_text(tmp_path: Path, data: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_acclaim(written(tmp_path, ASF, data))


@settings(deadline=None, max_examples=150)
@given(data=st.data())
def test_a_damaged_file_is_bad_input_and_nothing_else(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    texts = [bytearray(ASF.encode()), bytearray(AMC.encode())]
    text = texts[data.draw(st.integers(0, 1))]
    at = data.draw(st.integers(0, len(text) - 1))
    match data.draw(st.sampled_from(["cut", "overwrite", "remove", "word"])):
        case "cut":
            del text[at:]
        case "overwrite":
            text[at : at + 3] = data.draw(st.binary(min_size=1, max_size=6))
        case "remove":
            del text[at : at + data.draw(st.integers(1, 200))]
        case "word":
            words = text.split(b" ")
            other = st.sampled_from(
                [b"1e308", b"-1e9", b"inf", b"0", b"", b"begin\n", b"end\n", b"root", b"thigh", b"("]
            )
            words[at % len(words)] = data.draw(other)
            text[:] = b" ".join(words)
    folder = tmp_path_factory.mktemp("fuzz")
    (folder / "clip.asf").write_bytes(texts[0])
    (folder / "clip.amc").write_bytes(texts[1])
    try:
        capture = read(folder / "clip.amc")
    except InputError as error:
        assert "\n" not in str(error)
    else:
        assert np.isfinite(capture.positions).all()
