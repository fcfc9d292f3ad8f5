"""Reader of people who carry things (.pt), as OMOMO's recordings are passed on: a tensor of joints and of one object.

PyTorch is not needed: the file is a ZIP archive of a pickled description and of the numbers, and of the description
only what builds one tensor of 32-bit numbers is let through.
"""

import pickle
import zipfile
from collections import OrderedDict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.motion.human.capture import Capture

Array = NDArray[np.float64]

RATE_HZ = 30.0
COLUMNS = 591
POSITIONS, OBJECT_PLACE, OBJECT_TURN, TURNS = slice(162, 318), slice(318, 321), slice(321, 325), slice(383, 591)
"""Columns: positions of the joints and of the object [m], quaternions of the object and of the joints (x, y, z, w)."""
MAX_BYTES = 1 << 28  # of a file, unpacked
UNIT_TOLERANCE = 1e-3  # of the length of a quaternion

_SIDE = ("Hip", "Knee", "Ankle", "Foot")
_ARM = ("Collar", "Shoulder", "Elbow", "Wrist")
_FINGERS = tuple(f"{finger}{k}" for finger in ("Index", "Middle", "Pinky", "Ring", "Thumb") for k in (1, 2, 3))


def _skeleton() -> tuple[tuple[str, ...], tuple[int, ...]]:
    """Names and parents of the 52 joints of SMPL-H, limb after limb."""
    names, parents = ["Pelvis"], [-1]

    def chain(parent: str, links: tuple[str, ...]) -> None:
        for link in links:
            parents.append(names.index(parent))
            names.append(link)
            parent = link

    for side in ("L", "R"):
        chain("Pelvis", tuple(f"{side}_{part}" for part in _SIDE))
    chain("Pelvis", ("Spine1", "Spine2", "Spine3", "Neck", "Head"))
    for side in ("L", "R"):
        chain("Spine3", tuple(f"{side}_{part}" for part in _ARM))
        for first in range(0, len(_FINGERS), 3):
            chain(f"{side}_Wrist", tuple(f"{side}_{finger}" for finger in _FINGERS[first : first + 3]))
    return tuple(names), tuple(parents)


JOINTS, PARENTS = _skeleton()


class ObjectTrack(NamedTuple):
    """Where an object is, in the file's own world: positions (T, 3) [m] and rotations (T, 3, 3)."""

    position: Array
    rotation: Array


def read_omomo(path: str | Path) -> Capture:
    """Read the person.

    Raises:
        InputError: not such a file.
    """
    path = Path(path)
    rows = _rows(path)
    return Capture(
        name=path.stem,
        rate=RATE_HZ,
        joints=JOINTS,
        parents=PARENTS,
        positions=rows[:, POSITIONS].reshape(-1, len(JOINTS), 3),
        rotations=_turns(path, rows[:, TURNS]).reshape(-1, len(JOINTS), 3, 3),
    )


def read_omomo_object(path: str | Path) -> ObjectTrack:
    """Read what the person handles.

    Raises:
        InputError: not such a file.
    """
    path = Path(path)
    rows = _rows(path)
    return ObjectTrack(rows[:, OBJECT_PLACE], _turns(path, rows[:, OBJECT_TURN]))


def _turns(path: Path, quaternions: Array) -> Array:
    """Rotations (n, 3, 3) of all quaternions of a block of columns."""
    rows = quaternions.reshape(-1, 4)
    if np.abs(np.linalg.norm(rows, axis=1) - 1.0).max() > UNIT_TOLERANCE:
        raise InputError(f"{path}: its columns hold no quaternions where a recording of OMOMO has them")
    return np.asarray(Rotation.from_quat(rows).as_matrix())


def _rows(path: Path) -> Array:
    """The tensor (T, 591)."""
    try:
        with zipfile.ZipFile(path) as archive:
            folder = next(name.removesuffix("data.pkl") for name in archive.namelist() if name.endswith("data.pkl"))
            if sum(entry.file_size for entry in archive.infolist()) > MAX_BYTES:
                raise InputError(f"{path}: larger than any recording")
            with archive.open(f"{folder}data.pkl") as description:
                key, offset, size, stride = _TensorOnly(description).load()
            numbers = np.frombuffer(archive.read(f"{folder}data/{key}"), dtype="<f4")
    except (OSError, zipfile.BadZipFile, StopIteration) as error:
        raise InputError(f"{path}: cannot be read, or no file of PyTorch") from error
    except InputError:
        raise
    except Exception as error:  # a pickle may raise anything
        raise InputError(f"{path}: holds more than one tensor of numbers, and is not read") from error
    if len(size) != 2 or size[1] != COLUMNS or tuple(stride) != (COLUMNS, 1) or size[0] < 2:
        raise InputError(f"{path}: holds a tensor of {tuple(size)}; a recording of OMOMO has (frames, {COLUMNS})")
    whole = numbers[offset : offset + size[0] * COLUMNS]
    if len(whole) != size[0] * COLUMNS or not np.isfinite(whole).all():
        raise InputError(f"{path}: is cut short, or holds something that is not a finite number")
    return whole.reshape(-1, COLUMNS).astype(float)


class _TensorOnly(pickle.Unpickler):
    """Reads key of the storage, offset, size and stride of one tensor of 32-bit numbers, and refuses all else."""

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) == ("torch._utils", "_rebuild_tensor_v2"):
            return _tensor
        if (module, name) == ("torch", "FloatStorage"):
            return None
        if (module, name) == ("collections", "OrderedDict"):
            return OrderedDict
        raise pickle.UnpicklingError(f"{module}.{name}")

    def persistent_load(self, pid: Any) -> str:
        return str(pid[2])


def _tensor(key: str, offset: int, size: tuple[int, ...], stride: tuple[int, ...], *_: Any) -> tuple[Any, ...]:
    return str(key), int(offset), tuple(map(int, size)), tuple(map(int, stride))
