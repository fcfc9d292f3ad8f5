"""The binary file of biomechanics (.c3d, c3d.org): a header, named parameters, and points over time.

Written after the format's public description. Every length is checked before it is used, so that a damaged file is
an error and nothing else; the usual library crashes on some.
"""

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError

Array = NDArray[np.float64]

BLOCK = 512  # bytes
KEY = 0x50  # second byte of every file
INTEL, DEC, MIPS = 84, 85, 86  # processors, which differ in their numbers
MAX_FRAMES_IN_HEADER = 65535
CHARACTERS, BYTES, INTEGERS, REALS = -1, 1, 2, 4  # types of parameters


@dataclass(frozen=True)
class PointFile:
    """What a file holds.

    Attributes:
        labels: of the points.
        rate: frames per second [Hz].
        unit: of the places, as the file calls it; empty if it does not.
        places: (T, P, 3) of the points; nan where a point was not seen.
    """

    labels: tuple[str, ...]
    rate: float
    unit: str
    places: Array


def read_point_file(path: Path) -> PointFile:
    """Read a file of points.

    Raises:
        InputError: it cannot be read, is none of the kind, truncated or damaged.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    if len(data) < 2 * BLOCK or data[1] != KEY:
        raise InputError(f"{path}: not a C3D, or a truncated one")
    try:
        return _parsed(path, data)
    except (struct.error, IndexError):
        raise InputError(f"{path}: a damaged or truncated C3D: its parameters end beyond the file") from None


def _parsed(path: Path, data: bytes) -> PointFile:
    start = BLOCK * max(data[0] - 1, 1)
    processor = data[start + 3]
    if processor not in (INTEL, DEC, MIPS):
        raise InputError(f"{path}: a damaged C3D: it is of no known processor ({processor})")
    numbers = _Numbers(data, processor)
    parameters = _parameters(data, start + 4, numbers)
    points, analogue, first, last = (numbers.word(2 * k) for k in (1, 2, 3, 4))
    scale, rate, data_start = numbers.real(12), numbers.real(20), numbers.word(16)
    rate = _first(parameters.get("POINT:RATE"), rate)
    scale = _first(parameters.get("POINT:SCALE"), scale)
    if points < 1:
        raise InputError(f"{path}: holds no points")
    if not np.isfinite([rate, scale]).all() or scale == 0.0:
        raise InputError(f"{path}: a damaged C3D: its rate or scale is no number")
    size = 4 if scale < 0.0 else 2
    frame_bytes = size * (4 * points + analogue)
    there = (len(data) - BLOCK * (data_start - 1)) // frame_bytes if 1 <= data_start * BLOCK <= len(data) else 0
    frames = _promised_frames(parameters, last - first + 1, there)
    if frames > there or there < 2 or frames < 2:
        raise InputError(f"{path}: ends after {max(there, 0)} of {max(frames, 2)} frames; it is truncated or damaged")
    raw = numbers.values(BLOCK * (data_start - 1), frames * (4 * points + analogue), size)
    values = raw.reshape(frames, -1)[:, : 4 * points].reshape(frames, points, 4)
    places = values[:, :, :3].copy() if scale < 0.0 else values[:, :, :3] * scale
    lost = (values[:, :, 3] < 0.0) | ~np.isfinite(places).all(axis=2) | ~np.any(places, axis=2)
    places[lost] = np.nan
    return PointFile(_labels(parameters, points), rate, _text(parameters.get("POINT:UNITS")), places)


def _promised_frames(parameters: dict[str, object], in_header: int, there: int) -> int:
    """How many frames a file says that it holds; a header alone cannot count beyond MAX_FRAMES_IN_HEADER."""
    frames = in_header
    field = [parameters.get(f"TRIAL:ACTUAL_{end}_FIELD") for end in ("START", "END")]
    counts = [
        int(v[0]) % 65536 + 65536 * (int(v[1]) % 65536) for v in field if isinstance(v, np.ndarray) and len(v) > 1
    ]
    if len(counts) == 2 and counts[1] >= counts[0]:
        frames = max(frames, counts[1] - counts[0] + 1) if counts[1] - counts[0] < there else frames
    for name in ("POINT:LONG_FRAMES", "POINT:FRAMES"):
        value = _first(parameters.get(name), 0.0)
        if np.isfinite(value) and frames >= MAX_FRAMES_IN_HEADER:
            frames = max(frames, int(value))
    return frames


class _Numbers:
    """Numbers of a file in its processor's manner."""

    def __init__(self, data: bytes, processor: int):
        self._data, self._dec = data, processor == DEC
        self._order = ">" if processor == MIPS else "<"

    def word(self, at: int) -> int:
        return int(struct.unpack_from(self._order + "H", self._data, at)[0])

    def offset(self, at: int) -> int:
        return int(struct.unpack_from(self._order + "h", self._data, at)[0])

    def real(self, at: int) -> float:
        return float(self.values(at, 1, 4)[0])

    def values(self, at: int, count: int, size: int) -> Array:
        """`count` numbers of 4 bytes, which are real, or of 2, which are whole."""
        if at < 0 or at + count * size > len(self._data):
            raise struct.error
        if size == 2:
            return np.frombuffer(self._data, self._order + "i2", count, at).astype(float)
        if not self._dec:
            with np.errstate(invalid="ignore"):
                return np.frombuffer(self._data, self._order + "f4", count, at).astype(float)
        swapped = np.frombuffer(self._data, "<u2", 2 * count, at).reshape(-1, 2)[:, ::-1]
        with np.errstate(invalid="ignore"):
            return 0.25 * np.ascontiguousarray(swapped).view("<f4")[:, 0].astype(float)  # VAX F: half words, bias 129


def _parameters(data: bytes, at: int, numbers: _Numbers) -> dict[str, object]:
    """Parameters as "GROUP:NAME" -> numbers (n,) or a list of texts."""
    groups: dict[int, str] = {}
    found: list[tuple[int, str, object]] = []
    while at + 2 < len(data):
        length, group = abs(_signed(data[at])), _signed(data[at + 1])
        if not length or not group:
            break
        name = data[at + 2 : at + 2 + length].decode("latin-1").upper().strip()
        here = at + 2 + length
        if group < 0:
            groups[-group] = name
        else:
            found.append((group, name, _parameter(data, here + 2, numbers)))
        step = numbers.offset(here)
        if step <= 0:
            break
        at = here + step
    return {f"{groups.get(group, '')}:{name}": value for group, name, value in found}


def _parameter(data: bytes, at: int, numbers: _Numbers) -> object:
    kind, count = _signed(data[at]), data[at + 1]
    sizes = [int(size) for size in data[at + 2 : at + 2 + count]]
    at += 2 + count
    total = int(np.prod(sizes, dtype=object)) if sizes else 1
    if at + total * max(abs(kind), 1) > len(data):
        raise IndexError
    if kind == CHARACTERS:
        width = sizes[0] if sizes else 1
        words = [data[at + k : at + k + width] for k in range(0, total, width)] if width and total else []
        return [word.decode("utf-8", errors="replace").strip("\0 ") for word in words]
    if kind == BYTES:
        return np.frombuffer(data, np.uint8, total, at).astype(float)
    return numbers.values(at, total, kind) if kind in (INTEGERS, REALS) else np.zeros(0)


def _signed(byte: int) -> int:
    return byte - 256 if byte > 127 else byte


def _first(value: object, otherwise: float) -> float:
    return float(value[0]) if isinstance(value, np.ndarray) and len(value) else otherwise


def _text(value: object) -> str:
    return str(value[0]) if isinstance(value, list) and value else ""


def _labels(parameters: dict[str, object], points: int) -> tuple[str, ...]:
    """A label for each point, without the name of its person; further parameters hold those beyond 255."""
    labels: list[str] = []
    for number in ("", *map(str, range(2, 10))):
        more = parameters.get(f"POINT:LABELS{number}")
        labels += more if isinstance(more, list) else []
    labels += [""] * (points - len(labels))
    return tuple(label.rpartition(":")[2].strip() for label in labels[:points])
