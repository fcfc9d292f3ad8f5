"""Text files that a person writes, in TOML."""

import tomllib
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
