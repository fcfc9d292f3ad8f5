"""The flights of a dancer, which leaps; the robot keeps a foot on the floor, and says so."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sot.motion.feet.footwork import FREE, foot_track
from sot.motion.feet.stance import LEAD_IN_TIME
from sot.motion.human.human import SIDES, Human

MIN_FLIGHT_TIME = 0.1  # s: in a walk, a heel may touch later than the other foot's toes seem to leave


@dataclass(frozen=True)
class Flight:
    """A time with both feet off the floor, in the clip's time [s]."""

    start: float
    end: float


def find_flights(human: Human) -> tuple[Flight, ...]:
    """The flights of a human on the motion's time line (see `human_on_time_line`); who sits or lies does not fly."""
    free = np.all([foot_track(human, side).mode == FREE for side in SIDES], axis=0)
    edges = (
        np.flatnonzero(np.diff(free.astype(np.int8), prepend=0, append=0)).reshape(-1, 2) / human.rate - LEAD_IN_TIME
    )
    carried = [(one.start - human.start, one.end - human.start) for one in human.remarks if not one.on_feet]
    return tuple(
        Flight(float(start), float(end))
        for start, end in edges
        if end - start >= MIN_FLIGHT_TIME - 1e-9
        and not any(start <= until and end >= since for since, until in carried)
    )


def flight_remark(found: Sequence[Flight], stepping: bool) -> str:
    """The sentence that says what the robot does instead of some flights, one at least."""
    times = "once" if len(found) == 1 else f"{len(found)} times"
    longest = max(flight.end - flight.start for flight in found)
    instead = "it steps, foot after foot" if stepping else "its feet stay on the floor"
    return (
        f"The dancer leaps {times}, both feet off the floor for up to {longest:.2f} s; the robot does not: {instead}."
    )
