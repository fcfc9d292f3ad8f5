"""Text files that a person writes, in TOML."""

import tomllib
from collections.abc import Iterable
from difflib import get_close_matches
from math import isfinite
from pathlib import Path
from typing import Any

from sot.errors import InputError
from sot.text_file import read_text


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """The content of a file; kind: what it should be, for messages.

    Raises:
        InputError: it cannot be read, or is no TOML.
    """
    try:
        text = read_text(path)
    except InputError as error:
        raise InputError(f"{error}; give {kind} (.toml)") from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not a TOML file: {error}") from None


def named_file(file: str | Path, folder: Path, names: Iterable[str], kind: str) -> Path:
    """Path of a file that is given by its name in a folder, or by its own path (`.toml`); kind: for the message.

    Raises:
        InputError: there is none of that name.
    """
    path = Path(file)
    if path.suffix == ".toml":
        return path.resolve()
    if str(file) not in (known := tuple(names)):
        raise InputError(f"unknown {kind} '{file}': choose one of {', '.join(known)}, or give a {kind} file (.toml)")
    return (folder / f"{file}.toml").resolve()


def is_number(value: Any) -> bool:
    """Whether a value is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def nearest(name: Any, known: Iterable[str], words: str = "did you mean") -> str:
    """The known name that is most like another, as the end of a sentence; nothing if none is."""
    found = get_close_matches(str(name), list(known), n=1)
    return f" ({words} '{found[0]}'?)" if found else ""
