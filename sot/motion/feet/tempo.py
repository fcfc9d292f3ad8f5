"""Time for the steps: what a dancer does too fast for the robot's feet is left out if small, and slowed down if not."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, label, sum_labels

from sot.motion.feet.footwork import Step
from sot.motion.feet.timetable import SHIFT, timetable

Array = NDArray[np.float64]

LATE = 0.3  # s, that a step may be off the dancer's time
AROUND = 0.4  # s before and after a step that is too hasty: what is slowed down for it
PACE = 1.08  # by which one round slows that down
SLOWEST = 1.5  # times slower than the dancer, at most
SMOOTH = 0.25  # s, of the change of speed
ROUNDS = 40


@dataclass(frozen=True)
class Move:
    """A step of the dancer and its length [m], the least time that the robot needs for it [s], and whether it may be
    left out."""

    step: Step
    length: float
    least: float
    small: bool


@dataclass(frozen=True)
class Tempo:
    """The moves that are made, when the robot makes them, and `clock` (T,), the robot's time at the dancer's frames."""

    moves: tuple[Move, ...]
    steps: tuple[Step, ...]
    clock: Array


def tempo(moves: Sequence[Move], times: Array) -> Tempo:
    """A smooth time map, slower than the dancer only where steps would otherwise be off their time.

    Args:
        moves: in order of their middles.
        times: (T,) of the dancer's frames, uniform, from zero [s].
    """
    kept, dt, slow = list(moves), times[1] - times[0], np.ones(len(times))
    for _ in range(ROUNDS):
        clock = clock_of(slow, dt)
        wanted = [at_clock(move.step, clock, 1.0 / dt) for move in kept]
        timed = timetable(wanted, [move.least for move in kept])
        off = np.array(
            [abs(a.lift + a.land - b.lift - b.land) / 2.0 for a, b in zip(timed, wanted, strict=True)], dtype=float
        )
        if not len(off) or off.max() <= LATE:
            break
        leave = _least_worth(kept, int(off.argmax()))
        if leave is not None:
            del kept[leave]
            continue
        late = [0.5 * (move.step.lift + move.step.land) for move, by in zip(kept, off, strict=True) if by > LATE]
        slow = slowed(slow, times, late, PACE, SLOWEST)
    if timed:
        clock[-1] = max(
            clock[-1], dt * round((timed[-1].land + SHIFT) / dt)
        )  # the last pose is held as long as it takes
    return Tempo(tuple(kept), timed, clock)


def slowed(slow: Array, times: Array, about: Sequence[float], factor: float, most: float | Array) -> Array:
    """A slowness (T,) at times (T,) that is by a factor greater about some times, but not beyond `most`, one
    for all or (T,)."""
    hasty = np.zeros(len(times), bool)
    for middle in about:
        hasty |= np.abs(times - middle) < AROUND
    return np.where(hasty, np.maximum(slow, np.minimum(factor * slow, most)), slow)


def clock_of(slow: Array, dt: float) -> Array:
    """Time (T,) that passes at a slowness (T,), made smooth.

    Wherever it is above one, whole frames are added: what lies before and after has its old frames, only later.
    """
    lost = gaussian_filter1d(slow - 1.0, SMOOTH / dt, mode="nearest")
    lost = 0.5 * (lost[1:] + lost[:-1])
    places, count = label(lost > 0.0)
    frames = sum_labels(lost, places, np.arange(1, count + 1))
    lost *= np.concatenate([[0.0], np.ceil(frames - 1e-6) / frames])[places]
    return dt * (np.arange(len(slow)) + np.concatenate([[0.0], np.cumsum(lost)]))


def at_clock(step: Step, clock: Array, rate: float) -> Step:
    """A step at the times (T,) that a clock shows at frames of a rate [Hz]."""
    lift, land = np.interp([step.lift, step.land], np.arange(len(clock)) / rate, clock)
    return Step(step.foot, float(lift), float(land))


def _least_worth(moves: Sequence[Move], worst: int) -> int | None:
    """The shortest of the small moves about the one that is most off its time."""
    middle = moves[worst].step.lift + moves[worst].step.land
    near = [
        k for k, move in enumerate(moves) if move.small and abs(move.step.lift + move.step.land - middle) < 4.0 * AROUND
    ]
    return min(near, key=lambda k: moves[k].step.land - moves[k].step.lift, default=None)
