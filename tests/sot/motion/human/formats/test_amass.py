"""Poses of the SMPL family: joints without the body model, sizes from standing feet, and what is refused."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion import Human, read, recognise
from tests.sot.motion.human.formats.comparison import dancing_human, largest_angle
from tests.sot.motion.human.formats.dance import dance, mirrored
from tests.sot.motion.human.formats.writers import amass_arrays, write_amass

Arrays = dict[str, np.ndarray]


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> Human:
    return dancing_human(tmp_path_factory.mktemp("clip"))


@pytest.mark.parametrize("kind", ["smplh", "smplx", "parts"])
def test_limbs_turn_as_the_dancers_on_bones_of_our_own(tmp_path: Path, expected: Human, kind: str) -> None:
    human = recognise(read(write_amass(tmp_path / "clip.npz", dance(), kind)))
    assert human.rate == 50.0
    assert largest_angle(expected, human, *(one for one in _LIMBS)) < 0.1
    assert largest_angle(expected, human, "trunk", "head") < 2.0
    for body in ("pelvis", "chest"):
        np.testing.assert_allclose(human.frames[body], expected.frames[body], atol=0.02)
    assert human.remarks == ()


_LIMBS = [f"{side}_{part}" for side in ("left", "right") for part in ("thigh", "shank", "upper_arm", "forearm")]


@pytest.mark.parametrize("size", [0.9, 1.0, 1.1])
def test_the_size_is_that_in_which_feet_stand(tmp_path: Path, size: float) -> None:
    arrays = amass_arrays(dance())
    arrays["trans"] = size * arrays["trans"]
    path = tmp_path / "clip.npz"
    np.savez(path, **arrays)
    human = recognise(read(path))
    assert human.leg == pytest.approx(0.85 * size, rel=0.05)
    for side in ("left", "right"):
        assert np.ptp(human.points[f"{side}_ankle"][:, 2]) < 0.01


def without(name: str) -> Callable[[Arrays], Any]:
    return lambda arrays: arrays.pop(name)


def put(name: str, value: object) -> Callable[[Arrays], Any]:
    return lambda arrays: arrays.update({name: np.asarray(value)})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (without("mocap_framerate"), r"says no frame rate: add 'mocap_framerate' \[Hz\]"),
        (put("mocap_framerate", 0.0), "frame rate is not plausible"),
        (put("mocap_framerate", [50.0, 50.0]), "frame rate is not plausible"),
        (without("trans"), "lacks 'trans'"),
        (put("trans", np.zeros((3, 3))), "'trans' has 3 frames, its poses have 60"),
        (put("poses", np.zeros((60, 63))), r"'poses' has shape \(60, 63\), expected numbers \(frames, 66 or more\)"),
        (put("poses", np.full((60, 66), np.nan)), "not a finite number"),
        (put("poses", np.full((60, 66), 90.0)), "are they degrees"),
        (put("poses", np.array([["a"] * 66] * 60)), "expected numbers"),
        (lambda arrays: (arrays.pop("poses"), put("pose_body", np.zeros((60, 63)))(arrays)), "lacks 'root_orient'"),
    ],
)
def test_a_file_that_lacks_something_says_what(tmp_path: Path, change: Callable[[Arrays], Any], words: str) -> None:
    arrays = amass_arrays(dance())
    change(arrays)
    path = tmp_path / "clip.npz"
    np.savez(path, **arrays)
    with pytest.raises(InputError, match=words) as error:
        read(path)
    assert "\n" not in str(error.value)


def test_a_robots_motion_is_called_one(tmp_path: Path) -> None:
    path = tmp_path / "clip.npz"
    np.savez(path, fps=[50], joint_pos=np.zeros((9, 29)), body_pos_w=np.zeros((9, 30, 3)))
    with pytest.raises(InputError, match="the joints of a robot"):
        read(path)
    np.savez(path, weights=np.zeros(3))
    with pytest.raises(InputError, match="neither AMASS poses nor a motion of `sot retarget`; it holds weights"):
        read(path)


def test_nothing_in_a_file_is_run(tmp_path: Path) -> None:
    class Bomb:
        def __reduce__(self) -> tuple[Any, tuple[str]]:
            return (Path.touch, (tmp_path / "run",))  # type: ignore[return-value]

    arrays = amass_arrays(dance()) | {"labels": np.array([Bomb()], dtype=object)}
    path = tmp_path / "clip.npz"
    np.savez(path, **arrays)
    assert recognise(read(path)).count == 60  # without what could run
    arrays["poses"] = np.array([Bomb()], dtype=object)
    np.savez(path, **arrays)
    with pytest.raises(InputError, match="neither AMASS poses nor"):
        read(path)
    assert not (tmp_path / "run").exists()


def test_in_a_mirror_it_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="its elbows bend backwards"):
        recognise(read(write_amass(tmp_path / "clip.npz", mirrored(dance()))))


def test_joints_in_another_order_are_refused(tmp_path: Path) -> None:
    """All of the left leg first, then the right one, as depth first lists them."""
    arrays = amass_arrays(dance())
    order = [0, 1, 4, 7, 10, 2, 5, 8, 11, 3, 6, 9, 12, 15, 13, 16, 18, 20, 14, 17, 19, 21]
    body = arrays["poses"][:, :66].reshape(-1, 22, 3)[:, order]
    arrays["poses"] = body.reshape(-1, 66)
    path = tmp_path / "clip.npz"
    np.savez(path, **arrays)
    with pytest.raises(InputError) as error:
        recognise(read(path))
    assert "\n" not in str(error.value)
