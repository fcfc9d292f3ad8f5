"""Pointers that Git LFS leaves in the place of a large file: the file itself was never fetched."""

from pathlib import Path

from sot.errors import InputError

POINTER = b"version https://git-lfs.github.com/spec/"


def refuse_pointer(path: Path) -> None:
    """Refuse a file that is a pointer; what cannot be read is left to its reader.

    Raises:
        InputError: it is one.
    """
    try:
        with path.open("rb") as file:
            begins = file.read(len(POINTER))
    except OSError:
        return
    if begins == POINTER:
        raise InputError(f"{path}: a Git LFS pointer, not the file itself: fetch it with `git lfs pull`")
