"""References that do not move, of targets."""

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from sot.control.pose import Pose, PoseReference
from sot.errors import InputError

Array = np.ndarray
VectorReference = Callable[[float], tuple[Array, Array, Array]]
"""t -> position, velocity and acceleration, of the same shape."""


def fixed_vector(target: Array, size: int, name: str) -> VectorReference:
    """Reference at rest at a target, shape (size,).

    Raises:
        InputError: The target has another shape; `name` says whose it is.
    """
    position, rest = _vector(target, size, name), np.zeros(size)
    return lambda t: (position, rest, rest)


def fixed_pose(target: Array | pin.SE3, name: str) -> PoseReference:
    """Reference at rest at a placement, or at a position (3,) with the world's axes.

    Raises:
        InputError: The position has another shape; `name` says whose it is.
    """
    rest = np.zeros(6)
    if isinstance(target, pin.SE3):
        pose = Pose(target.translation.copy(), target.rotation.copy(), rest, rest)
    else:
        pose = Pose(_vector(target, 3, name), np.eye(3), rest, rest)
    return lambda t: pose


def _vector(target: Array, size: int, name: str) -> Array:
    vector = np.array(target, dtype=float)
    if vector.shape != (size,) or not np.isfinite(vector).all():
        raise InputError(f"target of {name}: give {size} finite numbers, or a function of time, not {target}")
    return vector
