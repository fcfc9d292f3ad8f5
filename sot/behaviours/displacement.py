"""Displacement of a plan to feet that do not stand at their planned places."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from solvers.compiled import compiled

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
        first, second = feet
        return cls(*_shift_and_tilt(*first, *second))

    def displaced_place(self, x: Array) -> Array:
        """Displaced place (2,) of a planned one [m]."""
        return x + self.shift + self.tilt @ x

    def displaced_rate(self, v: Array) -> Array:
        """Displaced velocity or acceleration (2,) of a planned one."""
        return v + self.tilt @ v


@compiled
def _shift_and_tilt(
    first: Array, first_at: Array, first_load: float, second: Array, second_at: Array, second_load: float
) -> tuple[Array, Array]:
    """Shift and tilt for two standing feet: see `Displacement.of`."""
    most = max(first_load, second_load)
    first_share = first_load / most if most > 0.0 else 1.0
    second_share = second_load / most if most > 0.0 else 1.0
    off, other, between, squared = np.empty(2), np.empty(2), np.empty(2), 0.0
    for i in range(2):
        a, b = first_at[i] - first[i], second_at[i] - second[i]
        off[i], other[i] = b + first_share * (a - b), a + second_share * (b - a)
        between[i] = second[i] - first[i]
        squared += between[i] * between[i]
    shift, tilt = np.empty(2), np.zeros((2, 2))
    for i in range(2):
        if squared < COINCIDENT_DISTANCE**2:
            shift[i] = 0.5 * (off[i] + other[i])
            continue
        for j in range(2):
            tilt[i, j] = (other[i] - off[i]) * (between[j] / squared)
        shift[i] = off[i] - (tilt[i, 0] * first[0] + tilt[i, 1] * first[1])
    return shift, tilt
