"""Parts that all readers of text files of joint angles share: lines, numbers, rates, turns about own axes."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sot.errors import InputError
from sot.text_file import read_text

RATE_RANGE_HZ = (5.0, 2000.0)  # what a motion capture system can plausibly have recorded
AXES = "XYZ"
MAX_QUOTED = 80  # characters of a line that a message shows


def read_lines(path: Path, kind: str) -> list[str]:
    """The lines of a text file; kind: what it should be, for messages.

    Raises:
        InputError: it cannot be read, is empty or no text.
    """
    try:
        text = read_text(path)
    except InputError as error:
        raise InputError(f"{error}; give {kind}") from None
    if not text.strip():
        raise InputError(f"{path}: the file is empty")
    return text.splitlines()


def parse_numbers(where: str, words: Sequence[str], count: int) -> tuple[float, ...]:
    """`count` finite numbers from words; where: the place in the file, for messages.

    Raises:
        InputError: more, fewer, or something else.
    """
    try:
        found = tuple(map(float, words))
    except ValueError:
        found = ()
    if len(found) != count or not all(map(math.isfinite, found)):
        wanted = "a number" if count == 1 else f"{count} numbers"
        held = " ".join(words)
        held = f"'{held}'" if len(held) <= MAX_QUOTED else f"{len(words)}, '{held[:MAX_QUOTED]}…'"
        raise InputError(f"{where}: expected {wanted}, found {held}")
    return found


def rotate_about_own_axis(rotation: np.ndarray, axis: int, angle: np.ndarray) -> None:
    """Multiply (T, 3, 3) rotations from the right by turns (T,) [rad] about one of their own axes, in place."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    u, v = (axis + 1) % 3, (axis + 2) % 3
    first, second = rotation[:, :, u].copy(), rotation[:, :, v]
    rotation[:, :, u] = c * first + s * second
    rotation[:, :, v] = c * second - s * first
