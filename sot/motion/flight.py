"""When a dancer leaps: a robot with a foot on the floor at all times does something else then, and says so."""

from dataclasses import dataclass

import numpy as np

from sot.motion.footwork import FREE, ground
from sot.motion.human import SIDES, Human
from sot.motion.stance import LEAD

SHORTEST = 0.1  # s; between two steps of a walk, a heel may touch later than the other foot's toes seem to leave


@dataclass(frozen=True)
class Flight:
    """Both feet off the floor, in the clip's time [s]."""

    start: float
    end: float


def flights(human: Human) -> tuple[Flight, ...]:
    """The flights of a human on the motion's time line (see `stance.on_time_line`)."""
    free = np.all([ground(human, side).mode == FREE for side in SIDES], axis=0)
    edges = np.flatnonzero(np.diff(free.astype(np.int8), prepend=0, append=0)).reshape(-1, 2) / human.rate - LEAD
    return tuple(Flight(float(start), float(end)) for start, end in edges if end - start >= SHORTEST - 1e-9)
