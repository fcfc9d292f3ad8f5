"""Pickles that anybody may have made: only plain data and arrays of numbers are read from them, nothing is run.

A pickle is a program; an unpickler that knows no other names than those of NumPy's arrays can only build arrays.
"""

import io
import pickle
import re
import zlib
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO, ClassVar

import numpy as np

from sot.errors import InputError
from sot.git_lfs import refuse_pointer

MAX_BYTES = 4_000_000_000
MAX_QUOTED = 200  # characters of what the file says
PLAIN_DTYPE = re.compile(r"[|<>=]?[biufcSUO]\d*")
OLD_CORE, CORE = "numpy.core", "numpy._core"  # of NumPy before and since 2.0


class _JoblibArray:
    """What joblib pickles in the place of an array, whose bytes follow at once."""

    def __init__(self) -> None:
        self.state: dict[str, Any] = {}


def _plain_dtype(code: Any, *flags: Any) -> np.dtype[Any]:
    if not isinstance(code, str) or not PLAIN_DTYPE.fullmatch(code):
        raise pickle.UnpicklingError("it holds arrays of something that is not a number")
    return np.dtype(code, False, True)  # a copy, whose byte order the pickle changes


def _latin1(text: str, encoding: str) -> bytes:
    """Bytes that an old protocol holds as text."""
    if encoding != "latin1":
        raise pickle.UnpicklingError("it holds bytes in an unknown encoding")
    return text.encode("latin1")


# Those in Python, of which what an opcode does can be changed; in C it cannot.
_PythonUnpickler: Any = pickle._Unpickler
_PythonPickler: Any = pickle._Pickler

_ARRAY: Any = np.zeros(1)
_SCALAR: Any = np.float64(0.0)
_KNOWN: dict[tuple[str, str], Callable[..., Any]] = {
    (f"{CORE}.multiarray", "_reconstruct"): _ARRAY.__reduce__()[0],
    (f"{CORE}.multiarray", "scalar"): _SCALAR.__reduce__()[0],
    (f"{CORE}.numeric", "_frombuffer"): _ARRAY.__reduce_ex__(5)[0],
    ("numpy", "ndarray"): np.ndarray,
    ("numpy", "dtype"): _plain_dtype,
    ("collections", "OrderedDict"): OrderedDict,
    ("_codecs", "encode"): _latin1,
    ("joblib.numpy_pickle", "NumpyArrayWrapper"): _JoblibArray,
}


class _Unpickler(_PythonUnpickler):
    """Builds plain data and arrays, and refuses every other name."""

    def __init__(self, file: BinaryIO) -> None:
        super().__init__(file)
        self._file = file

    def find_class(self, module: str, name: str) -> Any:
        found = _KNOWN.get((module.replace(OLD_CORE, CORE), name))
        if found is None:
            raise pickle.UnpicklingError(f"it asks for {module}.{name}, and may hold nothing but data")
        return found

    def persistent_load(self, pid: Any) -> Any:
        raise pickle.UnpicklingError("it refers to something outside of it")

    def _build(self) -> None:
        """Give an object its state: arrays, their types, and what joblib has in the place of arrays."""
        state: Any = self.stack[-1]
        made: Any = self.stack[-2]
        if isinstance(made, _JoblibArray) and isinstance(state, dict):
            self.stack[-2:] = [_joblib_array(state, self._file)]
        elif (isinstance(made, np.dtype) and state[2:5] == (None, None, None)) or isinstance(made, np.ndarray):
            self.stack.pop()
            self.stack[-1].__setstate__(state)
        else:
            raise pickle.UnpicklingError(f"it changes a {type(made).__name__}, and may hold nothing but data")

    dispatch: ClassVar = {**_PythonUnpickler.dispatch, pickle.BUILD[0]: _build}


def _joblib_array(state: dict[str, Any], file: BinaryIO) -> np.ndarray:
    """The array whose bytes follow joblib's description of it."""
    dtype, shape = state["dtype"], tuple(int(n) for n in state["shape"])
    if not isinstance(dtype, np.dtype) or dtype.hasobject:
        raise pickle.UnpicklingError("it holds arrays of something that is not a number")
    if state.get("numpy_array_alignment_bytes") is not None:
        file.read(file.read(1)[0])
    size = int(np.prod(shape, dtype=float)) * dtype.itemsize
    data = file.read(size) if 0 <= size <= MAX_BYTES else b""
    if len(data) != size:
        raise pickle.UnpicklingError("an array of it is cut off")
    return np.frombuffer(data, dtype).reshape(shape, order="F" if state.get("order") == "F" else "C")


def read_pickle(path: Path, kind: str) -> Any:
    """The plain data and arrays of a pickle, Python's or joblib's.

    Args:
        path: The file.
        kind: What it should be, for messages.

    Raises:
        InputError: it cannot be read, is damaged, too large, or asks for anything but data.
    """
    refuse_pointer(path)
    try:
        if path.stat().st_size > MAX_BYTES:
            raise pickle.UnpicklingError(f"larger than {MAX_BYTES / 1e9:g} GB")
        data = path.read_bytes()
        if data[:1] == b"x":  # compressed by joblib
            data = zlib.decompressobj().decompress(data, MAX_BYTES)
        return _Unpickler(io.BytesIO(data)).load()
    except Exception as error:  # a damaged pickle raises nearly anything
        words = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{path}: cannot be read as {kind}: {words[:MAX_QUOTED]}") from None


class _PortablePickler(_PythonPickler):
    """Pickles arrays under the names that NumPy had before 2.0, which every version reads."""

    def save_global(self, obj: Any, name: str | None = None) -> None:
        module = str(getattr(obj, "__module__", ""))
        if not module.startswith(CORE):
            super().save_global(obj, name)
            return
        words = f"{module.replace(CORE, OLD_CORE)}\n{name or obj.__qualname__}\n"
        self.write(pickle.GLOBAL + words.encode("ascii"))
        self.memoize(obj)


def write_pickle(path: Path, content: Any) -> None:
    """Write plain data and arrays; `pickle.load` and `joblib.load` read it, with any version of NumPy."""
    with path.open("wb") as file:
        _PortablePickler(file, protocol=3).dump(content)
