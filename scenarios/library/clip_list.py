"""Which clips a batch is of, under names that stay, and in which order: by a hash of the name, never sorted.

A sorted run that ends half way is a biased sample; so is a share of a sorted list.
"""

import hashlib
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from scenarios.inputs.clips import named_clips
from sot.errors import InputError
from sot.motion.human.formats.readers import READERS
from sot.text_file import read_text

LIST_ENDINGS = (".txt", ".tsv", ".list")
CLIP_ENDINGS = tuple(ending for ending in READERS if ending != ".asf")  # a skeleton, that comes with its motions
OUTSIDE = "_up_"  # in a name, a folder above the list's own


@dataclass(frozen=True)
class ListedClip:
    """A clip of a batch, or a part of one.

    Attributes:
        key: its name in the library: the path from the batch's folder, with "/" between folders, and its part.
        clip: the file, or the name of a clip of `sot list clips`.
        start, duration: the part [s], to the end by default.
    """

    key: str
    clip: str
    start: float = 0.0
    duration: float | None = None

    @property
    def digest(self) -> int:
        """Number by which clips are ordered and shared out."""
        return int.from_bytes(hashlib.sha256(self.key.encode("utf-8")).digest()[:8], "big")


def find_clips(source: str, endings: Sequence[str] = CLIP_ENDINGS) -> list[ListedClip]:
    """The clips of a folder and all below, of a list file, or of a pattern, ordered by hash.

    A list (.txt) has a clip a line, a path from the list's own folder or a name of `sot list clips`; start and duration
    [s] may follow, with tabs between.

    Args:
        source: folder, list file or pattern such as "mocap/**/*.bvh".
        endings: of the files in a folder that are clips.

    Raises:
        InputError: nothing there, or a line that cannot be read.
    """
    path = Path(source)
    if path.is_dir():
        files = (file for file in path.rglob("*") if file.suffix.lower() in endings and file.is_file())
        found = [_clip_of_file(file, path) for file in files if not _is_hidden(file.relative_to(path))]
    elif path.is_file() and path.suffix.lower() in LIST_ENDINGS:
        found = list(_clips_of_list(path))
    elif any(c in source for c in "*?["):
        root, pattern = _pattern_parts(source)
        found = [_clip_of_file(file, root) for file in root.glob(pattern) if file.is_file()]
    elif path.is_file():
        raise InputError(f"{source}: a single file; a batch takes a folder, a pattern or a list ({LIST_ENDINGS[0]})")
    else:
        raise InputError(f"{source}: no such folder or list")
    if not found:
        raise InputError(f"{source}: no clips there; they end in {', '.join(endings)}")
    by_key = {clip.key: clip for clip in found}
    if len(by_key) < len(found):
        raise InputError(f"{source}: names {len(found) - len(by_key)} clips twice")
    return sorted(found, key=lambda clip: (clip.digest, clip.key))


def share_of_rank(clips: Sequence[ListedClip], rank: int, ranks: int) -> list[ListedClip]:
    """The clips of one of several batches that share the work; a clip has the same rank however many there are.

    Raises:
        InputError: no such rank.
    """
    if not 0 <= rank < ranks:
        raise InputError(f"rank {rank} of {ranks}: ranks count from 0 to {ranks - 1}")
    return [clip for clip in clips if clip.digest % ranks == rank]


def _clip_of_file(file: Path, root: Path) -> ListedClip:
    return ListedClip(_key(file, root), str(file))


def _clips_of_list(path: Path) -> Iterator[ListedClip]:
    names = {clip.name for clip in named_clips()}
    for number, line in enumerate(read_text(path).splitlines(), 1):
        cells = [cell.strip() for cell in line.split("\t")]
        if not cells[0] or cells[0].startswith("#"):
            continue
        try:
            start = float(cells[1]) if len(cells) > 1 and cells[1] else 0.0
            duration = float(cells[2]) if len(cells) > 2 and cells[2] else None
        except ValueError:
            raise InputError(f"{path}, line {number}: after a tab come start and duration in seconds") from None
        if len(cells) > 3 or not 0.0 <= start < float("inf") or not (duration is None or 0.0 < duration < float("inf")):
            raise InputError(
                f"{path}, line {number}: expected a clip, and after tabs its start and duration in seconds"
            )
        named = cells[0] in names
        file = path.parent / cells[0]
        key = cells[0] if named else _key(file, path.parent)
        if start or duration is not None:
            key += f" {start:g}" + (f" for {duration:g}" if duration is not None else "")
        yield ListedClip(key, cells[0] if named else str(file), start, duration)


def _key(file: Path, root: Path) -> str:
    parts = Path(os.path.relpath(file, root)).parts
    return "/".join(OUTSIDE if part == ".." else part for part in parts)


def _pattern_parts(source: str) -> tuple[Path, str]:
    """The folder before the first part with a wildcard, and the pattern from there on."""
    parts = Path(source).parts
    first = next(k for k, part in enumerate(parts) if any(c in part for c in "*?["))
    return Path(*parts[:first]) if first else Path(), str(Path(*parts[first:]))


def _is_hidden(path: Path) -> bool:
    return any(part.startswith(".") for part in path.parts)
