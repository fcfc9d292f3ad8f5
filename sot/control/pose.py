"""A point's pose over time, and the names of its six axes."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Array = np.ndarray
AXES = "xyzRPY"
"""Letters that choose axes: position, and rotation about X, Y and Z."""
AXIS_NAMES = ("x", "y", "z", "roll", "pitch", "yaw")


class Pose(NamedTuple):
    """Where a point is to be and how it is to move, in the world.

    Args:
        position: Shape (3,) [m].
        rotation: Shape (3, 3).
        velocity: Linear over angular, world axes, shape (6,) [m/s, rad/s].
        acceleration: Its derivative, shape (6,) [m/s², rad/s²].
    """

    position: Array
    rotation: Array
    velocity: Array
    acceleration: Array


PoseReference = Callable[[float], Pose]
"""t -> where a point is to be then."""
