"""Text files that a person writes, in TOML."""

import tomllib
from pathlib import Path
from typing import Any

from sot.errors import InputError


def read_toml(path: Path, kind: str) -> dict[str, Any]:
    """The content of a file; kind: what it should be, for messages.

    Raises:
        InputError: it cannot be read, or is no TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}): give {kind} (.toml)") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not a TOML file: {error}") from None
