"""When a dancer leaps: a robot with a foot on the floor at all times does something else then, and says so."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sot.motion.feet.footwork import FREE, ground
from sot.motion.feet.stance import LEAD
from sot.motion.human.human import SIDES, Human

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


def remark(found: Sequence[Flight], stepping: bool) -> str:
    """What becomes of flights, one at least, in a sentence."""
    times = "once" if len(found) == 1 else f"{len(found)} times"
    longest = max(flight.end - flight.start for flight in found)
    instead = "it steps, foot after foot" if stepping else "its feet stay on the floor"
    return (
        f"The dancer leaps {times}, both feet off the floor for up to {longest:.2f} s; the robot does not: {instead}."
    )
