"""Pointers of Git LFS are called that, whatever file they stand for."""

from pathlib import Path

import pytest

from sot.errors import InputError
from sot.motion import Motion, read
from sot.toml_file import read_toml

POINTER = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a214614ab2935c943f9e0ff69d22e\nsize 132735\n"


@pytest.mark.parametrize("ending", ["bvh", "amc", "c3d", "mvnx", "npz"])
def test_a_pointer_is_no_clip(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"clip.{ending}"
    path.write_text(POINTER)
    with pytest.raises(
        InputError, match=r"a Git LFS pointer, not the file itself: fetch it with `git lfs pull`"
    ) as error:
        read(path)
    assert "\n" not in str(error.value)


def test_nor_is_it_a_motion_or_a_text(tmp_path: Path) -> None:
    for name in ("motion.npz", "robot.toml"):
        (tmp_path / name).write_text(POINTER)
    with pytest.raises(InputError, match="a Git LFS pointer"):
        Motion.load(tmp_path / "motion.npz")
    with pytest.raises(InputError, match="a Git LFS pointer"):
        read_toml(tmp_path / "robot.toml", "a robot")
