"""Which clips a batch is of, and in which order."""

import pytest

from scenarios.library.clip_list import find_clips, share_of_rank
from sot.errors import InputError


@pytest.fixture
def folder(tmp_path):
    for name in (
        "a/walk.bvh",
        "a/run.BVH",
        "b/c/jump.amc",
        "b/c/jump.asf",
        "notes.txt",
        ".hidden/x.bvh",
        "b/.part.bvh",
    ):
        path = tmp_path / "mocap" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
    return tmp_path / "mocap"


def test_a_folder_and_all_below_by_hash(folder):
    keys = [clip.key for clip in find_clips(str(folder))]
    assert sorted(keys) == ["a/run.BVH", "a/walk.bvh", "b/c/jump.amc"]
    assert keys == [clip.key for clip in sorted(find_clips(str(folder)), key=lambda clip: clip.digest)]


def test_the_order_does_not_depend_on_where_the_folder_is(folder, tmp_path):
    before = [clip.key for clip in find_clips(str(folder))]
    folder.rename(tmp_path / "elsewhere")
    assert [clip.key for clip in find_clips(str(tmp_path / "elsewhere"))] == before


def test_many_names_are_not_sorted(tmp_path):
    for k in range(40):
        (tmp_path / f"{k:02}.bvh").write_text("")
    keys = [clip.key for clip in find_clips(str(tmp_path))]
    assert keys != sorted(keys)
    parts = [share_of_rank(find_clips(str(tmp_path)), rank, 3) for rank in range(3)]
    assert sorted(clip.key for part in parts for clip in part) == sorted(keys)
    assert all(5 < len(part) < 25 for part in parts)


def test_patterns_and_endings(folder):
    assert [clip.key for clip in find_clips(str(folder / "**" / "*.amc"))] == ["b/c/jump.amc"]
    assert [clip.key for clip in find_clips(str(folder), (".txt",))] == ["notes.txt"]


def test_a_list_with_parts_and_names(folder):
    path = folder / "clips.txt"
    path.write_text("# a comment\na/walk.bvh\na/walk.bvh\t1.5\t2\ngroove\t\t3\n../other.bvh\n\n")
    clips = {clip.key: clip for clip in find_clips(str(path))}
    assert set(clips) == {"a/walk.bvh", "a/walk.bvh 1.5 for 2", "groove 0 for 3", "_up_/other.bvh"}
    assert clips["groove 0 for 3"].clip == "groove"
    part = clips["a/walk.bvh 1.5 for 2"]
    assert (part.clip, part.start, part.duration) == (str(folder / "a/walk.bvh"), 1.5, 2.0)


@pytest.mark.parametrize(
    "text", ["a.bvh\tx", "a.bvh\t-1", "a.bvh\t0\t0", "a.bvh\t0\t1\t2", "a.bvh\tnan", "a.bvh\na.bvh", "# nothing\n"]
)
def test_lists_that_cannot_be_read(text, tmp_path):
    path = tmp_path / "clips.txt"
    path.write_text(text)
    with pytest.raises(InputError):
        find_clips(str(path))


def test_what_is_no_batch(folder, tmp_path):
    (tmp_path / "empty").mkdir()
    for source in (tmp_path / "empty", tmp_path / "nothing", folder / "a/walk.bvh", folder / "*.c3d"):
        with pytest.raises(InputError):
            find_clips(str(source))
    with pytest.raises(InputError, match="ranks count"):
        share_of_rank(find_clips(str(folder)), 2, 2)
