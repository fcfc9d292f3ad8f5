"""Displacement of a plan to feet that do not stand at their planned places."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

Array = np.ndarray

ZERO_SHIFT = np.zeros(2)
ZERO_TILT = np.zeros((2, 2))
COINCIDENT_DISTANCE = 0.02
"""Distance below which two planned places count as one [m]."""


class Displacement(NamedTuple):
    """An affine map of the floor that takes each foot's planned place to where it stands: ``x -> x + shift + tilt x``.

    Along the line between two feet it goes from what is true of one to what is true of the other. Being affine, it
    takes every motion of a pendulum, centre of mass and zero-moment point, to another such motion.

    Args:
        shift: Shape (2,) [m].
        tilt: Shape (2, 2).
    """

    shift: Array
    tilt: Array

    @classmethod
    def of(cls, feet: Sequence[tuple[Array, Array, float]]) -> "Displacement":
        """The displacement for one standing foot or two.

        Args:
            feet: Planned place (2,), place (2,) [m], and load of each one that stands: one that may carry less than the
                other counts by its share, so that nothing jumps when it begins to.
        """
        if not feet:
            return cls(ZERO_SHIFT, ZERO_TILT)
        if len(feet) == 1:
            ((planned, place, _),) = feet
            return cls(place - planned, ZERO_TILT)
        (first, first_at, first_load), (second, second_at, second_load) = feet
        most = max(first_load, second_load)
        off, other = first_at - first, second_at - second
        first_share, second_share = (load / most if most > 0.0 else 1.0 for load in (first_load, second_load))
        off, other = other + first_share * (off - other), off + second_share * (other - off)
        between = second - first
        squared = between @ between
        if squared < COINCIDENT_DISTANCE**2:
            return cls(0.5 * (off + other), ZERO_TILT)
        tilt = np.outer(other - off, between / squared)
        return cls(off - tilt @ first, tilt)

    def displaced_place(self, x: Array) -> Array:
        """Displaced place (2,) of a planned one [m]."""
        return x + self.shift + self.tilt @ x

    def displaced_rate(self, v: Array) -> Array:
        """Displaced velocity or acceleration (2,) of a planned one."""
        return v + self.tilt @ v
