"""Checks of what strangers send: shapes, sizes and finite numbers, before anything is made of them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

MAX_JOINTS = 128
MAX_NAME_LENGTH = 64
MAX_COORDINATE_M = 1e3
MIN_QUATERNION_NORM = 0.5


class Malformed(ValueError):  # noqa: N818 - says what the datagram is
    """What a datagram holds is not of the protocol; its text is the reason, a word or two."""


def names(value: Any) -> tuple[str, ...]:
    """Names of joints, unique.

    Raises:
        Malformed: they are not.
    """
    if not isinstance(value, list) or not 0 < len(value) <= MAX_JOINTS:
        raise Malformed("joints")
    if not all(isinstance(name, str) and 0 < len(name) <= MAX_NAME_LENGTH for name in value):
        raise Malformed("joints")
    if len(set(value)) < len(value):
        raise Malformed("joints")
    return tuple(value)


def parents(value: Any, count: int) -> tuple[int, ...]:
    """Parents of joints, each before its children, -1 for none.

    Raises:
        Malformed: they are not.
    """
    if not isinstance(value, list) or len(value) != count:
        raise Malformed("parents")
    if not all(type(parent) is int and -1 <= parent < joint for joint, parent in enumerate(value)):
        raise Malformed("parents")
    return tuple(value)


def table(value: Any, count: int, width: int) -> Array:
    """Finite numbers (count, width).

    Raises:
        Malformed: they are not.
    """
    if not isinstance(value, list) or len(value) != count:
        raise Malformed("shape")
    if not all(isinstance(row, list) and len(row) == width for row in value):
        raise Malformed("shape")
    if not all(type(number) in (int, float) for row in value for number in row):
        raise Malformed("shape")
    try:
        numbers = np.array(value, dtype=float)
    except OverflowError:
        raise Malformed("not finite") from None
    return finite(numbers)


def finite(numbers: Array) -> Array:
    """Numbers that are finite and no further than a kilometre.

    Raises:
        Malformed: they are not.
    """
    if not np.isfinite(numbers).all():
        raise Malformed("not finite")
    if np.abs(numbers).max(initial=0.0) > MAX_COORDINATE_M:
        raise Malformed("too large")
    return numbers


def quaternions(numbers: Array) -> Array:
    """Quaternions (n, 4), xyzw, of length near one.

    Raises:
        Malformed: they are not.
    """
    length = np.linalg.norm(numbers, axis=1)
    if length.min(initial=1.0) < MIN_QUATERNION_NORM or length.max(initial=1.0) > 1.0 / MIN_QUATERNION_NORM:
        raise Malformed("rotation")
    return numbers / length[:, None]


def rotations(numbers: Array) -> Array:
    """Rotation matrices (n, 3, 3) of quaternions (n, 4), xyzw.

    Raises:
        Malformed: they are none.
    """
    result: Array = Rotation.from_quat(quaternions(numbers)).as_matrix()
    return result


def number(value: Any, most: float) -> float:
    """A finite number of a size up to `most`.

    Raises:
        Malformed: it is not.
    """
    if type(value) not in (int, float) or not -most <= value <= most:
        raise Malformed("number")
    return float(value)
