"""Xsens's open files: segments become joints; what contradicts itself, or does more than hold data, is refused."""

from pathlib import Path

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion import Human, read, recognise
from tests.sot.motion.human.formats.comparison import dancing_human, largest_angle
from tests.sot.motion.human.formats.dance import dance, mirrored
from tests.sot.motion.human.formats.writers import mvnx_text


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> Human:
    return dancing_human(tmp_path_factory.mktemp("clip"))


@pytest.fixture(scope="module")
def text() -> str:
    return mvnx_text(dance())


def written(folder: Path, text: str | bytes) -> Path:
    path = folder / "clip.mvnx"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


@pytest.mark.parametrize("joints", [True, False])
@pytest.mark.parametrize("heading", [0.0, 130.0])
def test_segments_are_the_dancers(tmp_path: Path, expected: Human, joints: bool, heading: float) -> None:
    human = recognise(read(written(tmp_path, mvnx_text(dance(heading_deg=heading), joints))))
    assert human.rate == 50.0 and human.count == expected.count
    assert largest_angle(expected, human) < 0.1
    for joint in ("left_wrist", "right_knee", "left_toe", "right_shoulder"):
        np.testing.assert_allclose(human.points[joint], expected.points[joint], atol=2e-3)
    for body in ("pelvis", "chest"):
        np.testing.assert_allclose(human.frames[body], expected.frames[body], atol=2e-3)


def test_encodings_are_those_that_xml_declares(tmp_path: Path, text: str) -> None:
    plain = read(written(tmp_path, text))
    other = read(written(tmp_path, text.replace("UTF-8", "UTF-16").encode("utf-16")))
    np.testing.assert_array_equal(other.positions, plain.positions)


def test_in_a_mirror_or_with_quaternions_in_another_order_it_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="toes point backwards"):
        recognise(read(written(tmp_path, mvnx_text(mirrored(dance())))))
    with pytest.raises(InputError, match="are quaternions in the order w, x, y, z"):
        read(written(tmp_path, mvnx_text(dance(), wxyz=False)))


BOMB = '<!DOCTYPE mvnx [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]>'


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("<mvnx", f"{BOMB}<mvnx", "line 2: declares a document type"),
        ("</frames></subject></mvnx>", "", "not an MVNX, or a truncated one"),
        ('frameRate="50"', 'frameRate="0"', "0 frames a second are not plausible"),
        ('frameRate="50"', "", "frameRate: expected a number"),
        ("<mvnx ", "<svg ", "mismatched|starts with <mvnx>"),
        ("<position>", "<position>1 ", "position: expected 69 numbers, found 70"),
        ('label="L5"', 'label="Pelvis"', "a label of its own"),
        ("L3/jL3", "Nobody/jL3", "Pelvis and L3 of its segments hang on no other"),
        ("</subject>", '</subject><subject frameRate="60"/>', "a second subject"),
    ],
)
def test_a_damaged_file_is_one_line(tmp_path: Path, text: str, old: str, new: str, words: str) -> None:
    assert old in text
    with pytest.raises(InputError, match=words) as error:
        read(written(tmp_path, text.replace(old, new)))
    assert "\n" not in str(error.value)


def test_a_frame_without_positions_is_told(tmp_path: Path, text: str) -> None:
    first, _, rest = text.partition('type="normal">')
    head, _, rest = rest.partition("<position>")
    cut = first + 'type="normal">' + head + rest.partition("</position>")[2]
    with pytest.raises(InputError, match="a frame without position: export them too"):
        read(written(tmp_path, cut))
