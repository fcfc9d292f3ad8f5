"""What an estimator is: sensors in, state out."""

from collections.abc import Mapping
from typing import NamedTuple, Protocol

import numpy as np
import pinocchio as pin

from sot.hardware.readings import Readings

Array = np.ndarray


class Footing(NamedTuple):
    """What a plan knows of a foot that is to stand. Its poses are not changed in place: one is read when it is new.

    Attributes:
        floor: place of the surface under its sole, z out of the surface; None if it is not known.
        foothold: where the foot is to stand, the pose of its frame; None if there is no such place.
    """

    floor: pin.SE3 | None = None
    foothold: pin.SE3 | None = None


LEVEL_GROUND = Footing(pin.SE3.Identity())
"""A foot that is to stand on z = 0, wherever."""


class Estimator(Protocol):
    """State of a robot from its sensors. It knows where the robot is set down, and nothing else but readings."""

    def reset(self, q: Array, v: Array) -> None:
        """Start over with a robot that is set down at (q, v), Pinocchio's conventions, (nq,) and (nv,)."""
        ...

    def __call__(self, t: float, readings: Readings, standing: Mapping[str, Footing]) -> tuple[Array, Array]:
        """The state at a time [s], new arrays (nq,) and (nv,) in Pinocchio's conventions.

        Args:
            t: now, at or after the readings' stamp.
            readings: newer ones than the last.
            standing: the feet that are planned to stand now; whether they do is for the estimator to find out.
        """
        ...

    @property
    def loads(self) -> Mapping[str, float]:
        """Vertical force of the floor on each foot (see `Robot.feet`) by the last readings [N]."""
        ...
