"""What a surface has to be for a robot to step on it."""

import numpy as np

from sot.errors import InputError
from sot.robots.surface import Surface

MAX_FRICTION_SHARE = 0.6  # of a surface's friction, that its slope may take: the rest is for what moves


def check_tread(surface: Surface) -> None:
    """Check that soles can stand on a surface.

    Raises:
        InputError: it moves, or is so steep that soles might slip.
    """
    if surface.point is not None:
        raise InputError(f"{surface.name} is no tread: it moves")
    most, slope = np.arctan(MAX_FRICTION_SHARE * surface.friction), np.arccos(surface.axes.rotation[2, 2])
    if slope > most:
        raise InputError(
            f"{surface.name} is no tread: it slopes by {np.degrees(slope):.0f}°, and soles hold on"
            f" {np.degrees(most):.0f}° at its friction of {surface.friction:g}"
        )
