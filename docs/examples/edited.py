"""Edits of a dance in a stack file: `sot replay groove --stack docs/examples/edited.py`."""

import numpy as np

from scenarios.stacks import planted_stack as stack  # noqa: F401
from sot.motion import Edit


def twist(t):
    """How far the chest turns beyond the dance [deg]."""
    return 8.0 * np.sin(2.0 * np.pi * t)


def edits(robot, motion):
    """x_n(t) = x_o(t) + x_m(t): what is added, in metres and radians."""
    return [
        Edit("right_hand", "z", by=0.10, start=2.0, end=4.0),
        Edit("head", "yaw", through=[(2.0, 0.4), (2.5, -0.4), (3.0, 0.4), (3.5, -0.4)], ease=0.4),
        Edit("left_hand", target=(0.35, 0.25, 1.0), start=1.5, end=3.5),
        Edit("chest", "yaw", by=lambda t: np.deg2rad(twist(t)), start=1.0, end=4.0),
    ]
