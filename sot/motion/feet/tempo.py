"""The tempo of steps: where a dancer steps too fast for the robot, small steps are left out, others slowed down."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, label, sum_labels

from sot.motion.feet.footwork import Step
from sot.motion.feet.timetable import WEIGHT_SHIFT_TIME, retimed_steps

Array = NDArray[np.float64]

MAX_STEP_DELAY = 0.3  # s between the middle of a robot's step and that of the dancer's
SLOWED_HALF_WIDTH = 0.4  # s before and after a step that is too fast: the time that is slowed down
SLOWDOWN_FACTOR = 1.08  # by which one iteration slows that down
MAX_SLOWNESS = 1.5  # times slower than the dancer
SLOWNESS_SMOOTHING_TIME = 0.25  # s, standard deviation of the filter of the slowness
MAX_ITERATIONS = 40


@dataclass(frozen=True)
class AskedStep:
    """A step of the dancer that the robot is asked to make.

    Attributes:
        step: when the dancer makes it.
        length: how far the foot moves [m].
        min_time: that the robot needs in the air [s].
        omissible: whether it may be left out.
        high: whether it lifts the foot high.
    """

    step: Step
    length: float
    min_time: float
    omissible: bool
    high: bool = False


@dataclass(frozen=True)
class Tempo:
    """The dancer's steps that are made, the robot's steps, and its time at the dancer's frames, `clock` (T,) [s]."""

    moves: tuple[AskedStep, ...]
    steps: tuple[Step, ...]
    clock: Array


def step_tempo(moves: Sequence[AskedStep], times: Array, max_slowness: float = MAX_SLOWNESS) -> Tempo:
    """The robot's steps and clock, slower than the dancer only where steps would otherwise be off their time.

    Args:
        moves: in order of their middles.
        times: (T,) of the dancer's frames, uniform, from zero [s].
        max_slowness: times slower than the dancer.
    """
    kept, dt, slow = list(moves), times[1] - times[0], np.ones(len(times))
    for _ in range(MAX_ITERATIONS):
        clock = clock_from_slowness(slow, dt)
        wanted = [step_at_clock(move.step, clock, 1.0 / dt) for move in kept]
        timed = retimed_steps(wanted, [move.min_time for move in kept])
        off = np.array(
            [abs(a.lift + a.land - b.lift - b.land) / 2.0 for a, b in zip(timed, wanted, strict=True)], dtype=float
        )
        if not len(off) or off.max() <= MAX_STEP_DELAY:
            break
        leave = _shortest_omissible(kept, int(off.argmax()))
        if leave is not None:
            del kept[leave]
            continue
        late = [
            0.5 * (move.step.lift + move.step.land) for move, by in zip(kept, off, strict=True) if by > MAX_STEP_DELAY
        ]
        slow = slowness_raised(slow, times, late, SLOWDOWN_FACTOR, max_slowness)
    if timed:
        clock[-1] = max(
            clock[-1], dt * round((timed[-1].land + WEIGHT_SHIFT_TIME) / dt)
        )  # the last pose is held as long as it takes
    return Tempo(tuple(kept), timed, clock)


def slowness_raised(slow: Array, times: Array, about: Sequence[float], factor: float, most: float | Array) -> Array:
    """A slowness (T,) at times (T,) raised by a factor near the times `about`, `most` (a number or (T,)) at most."""
    hasty = np.zeros(len(times), bool)
    for middle in about:
        hasty |= np.abs(times - middle) < SLOWED_HALF_WIDTH
    return np.where(hasty, np.maximum(slow, np.minimum(factor * slow, most)), slow)


def clock_from_slowness(slow: Array, dt: float) -> Array:
    """The clock (T,) of a slowness (T,): its integral over frames of `dt`, the slowness made smooth [s].

    Wherever it is above one, whole frames are added: what lies before and after has its old frames, only later.
    """
    lost = gaussian_filter1d(slow - 1.0, SLOWNESS_SMOOTHING_TIME / dt, mode="nearest")
    lost = 0.5 * (lost[1:] + lost[:-1])
    places, count = label(lost > 0.0)
    frames = sum_labels(lost, places, np.arange(1, count + 1))
    lost *= np.concatenate([[0.0], np.ceil(frames - 1e-6) / frames])[places]
    return dt * (np.arange(len(slow)) + np.concatenate([[0.0], np.cumsum(lost)]))


def step_at_clock(step: Step, clock: Array, rate: float) -> Step:
    """A step of the dancer at the robot's times, which a clock (T,) shows at frames of a rate [Hz]."""
    lift, land = np.interp([step.lift, step.land], np.arange(len(clock)) / rate, clock)
    return Step(step.foot, float(lift), float(land))


def _shortest_omissible(moves: Sequence[AskedStep], worst: int) -> int | None:
    """The omissible step that takes the least time, of those near the `worst`; None if there is none."""
    middle = moves[worst].step.lift + moves[worst].step.land
    near = [
        k
        for k, move in enumerate(moves)
        if move.omissible and abs(move.step.lift + move.step.land - middle) < 4.0 * SLOWED_HALF_WIDTH
    ]
    return min(near, key=lambda k: moves[k].step.land - moves[k].step.lift, default=None)
