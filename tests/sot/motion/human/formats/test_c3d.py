"""Markers: numbers of all processors, joints among the markers of the usual sets, gaps, and an independent library."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion import Human, read, recognise
from sot.motion.human.formats.c3d_file import read_point_file
from tests.sot.motion.human.formats.comparison import dancing_human, largest_angle
from tests.sot.motion.human.formats.dance import dance
from tests.sot.motion.human.formats.writers import c3d_bytes, markers


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> Human:
    return dancing_human(tmp_path_factory.mktemp("clip"))


def written(folder: Path, points: dict[str, np.ndarray], **options: Any) -> Path:
    path = folder / "clip.c3d"
    path.write_bytes(c3d_bytes(points, 50.0, **options))
    return path


@pytest.mark.parametrize(
    "options",
    [{}, {"whole": True}, {"big": True}, {"vax": True}, {"unit": "m"}, {"whole": True, "big": True}],
    ids=str,
)
def test_numbers_of_every_kind_are_read(tmp_path: Path, options: dict[str, Any]) -> None:
    points = markers(dance())
    points["C7"][5] = np.nan
    file = read_point_file(written(tmp_path, points, **options))
    assert file.rate == 50.0 and file.labels == tuple(points) and file.unit == options.get("unit", "mm")
    scale = 1.0 if file.unit == "m" else 1e-3
    np.testing.assert_allclose(scale * file.places, np.stack(list(points.values()), axis=1), atol=1e-4)


@pytest.mark.parametrize(("style", "inner"), [("plug_in_gait", False), ("plug_in_gait", True), ("optitrack", False)])
def test_joints_lie_where_the_dancers_are(tmp_path: Path, expected: Human, style: str, inner: bool) -> None:
    human = recognise(read(written(tmp_path, markers(dance(), style, inner))))
    assert largest_angle(expected, human) < 5.0
    assert largest_angle(expected, human, "left_shank", "right_shank") < (0.1 if inner else 1.0)
    assert human.leg == pytest.approx(expected.leg, abs=0.015)
    waist = human.points["waist"] - expected.points["waist"]
    for name in ("hip", "knee", "ankle", "toe", "shoulder", "elbow", "wrist"):
        for side in ("left", "right"):
            off = human.points[f"{side}_{name}"] - expected.points[f"{side}_{name}"] - waist
            assert np.linalg.norm(off, axis=1).max() < 0.035, (side, name)
    for body in ("pelvis", "chest", "head"):
        turn = np.einsum("tji,tjk->tik", human.frames[body], expected.frames[body])
        assert np.degrees(np.arccos(0.5 * (np.trace(turn, axis1=1, axis2=2).min() - 1.0))) < 6.0


def test_gaps_are_filled_and_long_ones_told(tmp_path: Path, expected: Human) -> None:
    points = markers(dance())
    points["LELB"][20:24] = np.nan
    points["RKNE"][30:45] = np.nan
    human = recognise(read(written(tmp_path, points)))
    (told,) = human.remarks
    assert told.words == "Out of sight from 0.60 to 0.90 s and interpolated: RKNE."
    assert largest_angle(expected, human) < 8.0


def test_markers_of_no_known_set_are_told_with_what_lacks(tmp_path: Path) -> None:
    points = markers(dance())
    del points["LKNE"], points["RFHD"], points["LBHD"]
    with pytest.raises(InputError, match=r"of plug_in_gait it lacks LKNE, RFHD; it has") as error:
        read(written(tmp_path, points))
    assert "\n" not in str(error.value)
    points = markers(dance())
    points["LKNE"][:40] = np.nan  # hardly ever seen
    with pytest.raises(InputError, match="lacks LKNE"):
        read(written(tmp_path, points))


def test_in_a_mirror_or_with_sides_swapped_it_is_refused(tmp_path: Path) -> None:
    points = {name: place * [1.0, -1.0, 1.0] for name, place in markers(dance()).items()}
    with pytest.raises(InputError, match="toes point backwards"):
        recognise(read(written(tmp_path, points)))
    swapped = {
        ({"L": "R", "R": "L"}.get(name[0], name[0]) + name[1:]): place for name, place in markers(dance()).items()
    }
    with pytest.raises(InputError):
        recognise(read(written(tmp_path, swapped)))


def test_axes_in_a_wrong_order_are_refused(tmp_path: Path) -> None:
    """An odd order is a mirror; an even one turns the room, which the up axis is found for."""
    odd = {name: place[:, [0, 2, 1]] for name, place in markers(dance()).items()}
    with pytest.raises(InputError, match="backwards"):
        recognise(read(written(tmp_path, odd)))
    even = {name: place[:, [1, 2, 0]] for name, place in markers(dance()).items()}
    assert recognise(read(written(tmp_path, even))).segment_direction("trunk")[:, 2].min() > 0.9


@pytest.mark.parametrize("size", [10, 600, 1024, 2200, 20000])
def test_a_cut_off_file_is_one_line(tmp_path: Path, size: int) -> None:
    path = written(tmp_path, markers(dance()))
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(InputError, match="truncated") as error:
        read(path)
    assert "\n" not in str(error.value)


def test_a_library_of_others_reads_and_writes_the_same(tmp_path: Path) -> None:
    ezc3d = pytest.importorskip("ezc3d")
    points = markers(dance())
    points["C7"][5] = np.nan
    theirs = ezc3d.c3d(str(written(tmp_path, points)))
    ours = read_point_file(tmp_path / "clip.c3d")
    np.testing.assert_allclose(theirs["data"]["points"][:3].transpose(2, 1, 0), ours.places, rtol=1e-6)
    theirs["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    theirs.write(str(tmp_path / "again.c3d"))
    again = read_point_file(tmp_path / "again.c3d")
    assert again.rate == 100.0 and [label.rpartition(":")[2] for label in again.labels] == list(ours.labels)
    np.testing.assert_allclose(again.places, ours.places, rtol=1e-6)
