"""When a box that is carried is gripped, lifted, placed and let go, and how far all that is at any time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

KNOT_PERIOD = 0.02  # s, between knots
REACHING_TIME = 8.0  # √(leg / g), of the arms from rest to beside the box, and back
CLOSING_TIME = 2.0  # √(leg / g), of the arms from beside the box to it, of giving its weight to what it stands on
RESTING_TIME = 1.0  # √(leg / g), of arms at rest before the end


@dataclass(frozen=True)
class HandlingTimes:
    """When what is done with a box [s].

    Attributes:
        begin: the arms leave for beside the box.
        gripped: they are there, and close on it.
        lifted: the box leaves where it stands.
        raised: it is where it is carried.
        arrived: the walk is over, and the box is lowered.
        placed: it stands again.
        opening: the hands let go.
        released: they are beside it.
        end: the arms are at rest.
        unit: √(leg / g).
    """

    begin: float
    gripped: float
    lifted: float
    raised: float
    arrived: float
    placed: float
    opening: float
    released: float
    end: float
    unit: float

    @staticmethod
    def of(begin: float, arrived: float, raising: float, unit: float) -> "HandlingTimes":
        """The times of a box that is taken and carried.

        Args:
            begin, arrived: when the arms leave for it, and when the walk is over [s].
            raising: time of raising the box, and of lowering it [√(leg / g)].
            unit: √(leg / g) [s].
        """
        gripped = begin + REACHING_TIME * unit
        lifted = gripped + CLOSING_TIME * unit
        placed = arrived + raising * unit
        opening = placed + CLOSING_TIME * unit
        released = opening + CLOSING_TIME * unit
        end = released + (REACHING_TIME + RESTING_TIME) * unit
        return HandlingTimes(
            begin, gripped, lifted, lifted + raising * unit, arrived, placed, opening, released, end, unit
        )

    def knots(self) -> Array:
        """Times from zero to the end (T,) [s]."""
        return KNOT_PERIOD * np.arange(np.ceil(self.end / KNOT_PERIOD) + 1)

    def reach_share(self, t: Array) -> Array:
        """Share of the arms' way from rest to beside the box, at times (T,)."""
        return _share(t, self.begin, self.gripped) - _share(t, self.released, self.end - RESTING_TIME * self.unit)

    def close_share(self, t: Array) -> Array:
        """Share of the hands' way from beside the box to it, at times (T,)."""
        return _share(t, self.gripped, self.lifted) - _share(t, self.opening, self.released)

    def raised_share(self, t: Array) -> Array:
        """Share of the box's way up from where it stands, at times (T,)."""
        return _share(t, self.lifted, self.raised) - _share(t, self.arrived, self.placed)

    def carried_share(self, t: Array, taken: float) -> Array:
        """Share of the box's weight that the hands carry, at times (T,).

        taken: when they carry all of it [s].
        """
        return _share(t, self.lifted, taken) - _share(t, self.placed, self.opening)


def _share(t: Array, start: float, end: float) -> Array:
    return np.asarray(minimum_jerk((t - start) / (end - start)))
