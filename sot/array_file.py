"""Files of named arrays (.npz) that anybody may have written: read without running what is in them."""

import struct
import tokenize
import zipfile
import zlib
from pathlib import Path

import numpy as np

from sot.errors import InputError
from sot.git_lfs import refuse_pointer

MAX_BYTES = 4e9  # of all arrays of a file together
MAX_QUOTED = 200  # characters of what numpy says, or of a name
_DAMAGE = (
    OSError,
    ValueError,
    EOFError,
    KeyError,
    TypeError,
    AttributeError,
    SyntaxError,
    MemoryError,
    OverflowError,
    RuntimeError,  # encrypted, or packed by a method that is not there
    struct.error,
    tokenize.TokenError,  # of an array's header
    zlib.error,
    zipfile.BadZipFile,
)


def array_names(path: Path) -> tuple[str, ...]:
    """Names of the arrays of a file; none if it is no such file."""
    try:
        with zipfile.ZipFile(path) as file:
            return tuple(name.removesuffix(".npy") for name in file.namelist())
    except _DAMAGE:
        return ()


def read_arrays(path: Path, kind: str) -> dict[str, np.ndarray]:
    """The arrays of a file by their names, but for those of Python objects, which could run a program.

    kind: what the file should be, for messages.

    Raises:
        InputError: it cannot be read, is damaged, a pointer, or holds more than MAX_BYTES.
    """
    refuse_pointer(path)
    try:
        with zipfile.ZipFile(path) as file:
            if sum(member.file_size for member in file.infolist()) > MAX_BYTES:
                raise InputError(f"{path}: holds more than {MAX_BYTES / 1e9:g} GB: no {kind}")
        with np.load(path, allow_pickle=False) as arrays:
            found = {name: arrays[name] for name in arrays.files if not _holds_objects(arrays, name)}
    except _DAMAGE as error:
        words = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{path}: cannot be read as {kind} (.npz): {words[:MAX_QUOTED]}") from None
    for name, values in found.items():
        if not isinstance(values, np.ndarray):  # bytes, of what is no array at all
            raise InputError(f"{path}: cannot be read as {kind} (.npz): '{name[:MAX_QUOTED]}' is damaged")
    return found


def _holds_objects(arrays: np.lib.npyio.NpzFile, name: str) -> bool:
    try:
        arrays[name]
    except ValueError as error:
        if "allow_pickle" in str(error):
            return True
        raise
    return False
