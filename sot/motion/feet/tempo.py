"""The times of the robot's steps: the dancer's, changed by the least with which one foot at a time steps.

Where a dancer steps too fast for the robot, small steps are left out, others slowed down.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, label, sum_labels

from solvers.banded import sparse_qp
from sot.motion.feet.footwork import Step

Array = NDArray[np.float64]

TIME_GRID = 0.02  # s, of which all times are multiples, as those below
MIN_SWING_TIME = 0.34  # s of a foot in the air
MIN_DOUBLE_SUPPORT_TIME = 0.14  # s between steps of one foot and the other: two force ramps, and a shift of weight
MIN_STANCE_TIME = 0.20  # s of a foot on the floor between two of its steps
WEIGHT_SHIFT_TIME = 0.5  # s before the first step, in which the weight shifts
ACCEPTED_TIME_CHANGE = 0.02  # s, that costs one unit
QP_TOLERANCE = 1e-6  # of the programme's multipliers and residuals
DURATION_CHANGE_WEIGHT = 1.0  # of a change of a step's duration, against that of its middle
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


def retimed_steps(steps: Sequence[Step], least: Sequence[float]) -> tuple[Step, ...]:
    """The steps one after the other, at times as near to their own as that allows.

    Least squares over lift and land of all steps; a flight, or a step of one foot that begins before the other's has
    ended, becomes two steps with a double support between them.

    Args:
        steps: in order of their middles; their times may overlap [s].
        least: time that each needs in the air, SWING at least [s].
    """
    if not steps:
        return ()
    count = len(steps)
    wanted = np.array([(step.lift, step.land) for step in steps]).ravel()
    gaps = np.empty(2 * count)  # least, from one time to the next, the first from zero
    gaps[0] = WEIGHT_SHIFT_TIME
    gaps[1::2] = np.maximum(MIN_SWING_TIME, least)
    gaps[2::2] = [MIN_STANCE_TIME if a.foot == b.foot else MIN_DOUBLE_SUPPORT_TIME for a, b in pairwise(steps)]
    cells = np.ceil(gaps / TIME_GRID - 1e-9)
    middle, span = np.array([[0.5, 0.5], [0.5, 0.5]]), np.array([[1.0, -1.0], [-1.0, 1.0]])
    H = sp.block_diag(count * [(middle + DURATION_CHANGE_WEIGHT * span) / ACCEPTED_TIME_CHANGE**2])
    later = sp.diags_array([np.ones(2 * count), -np.ones(2 * count - 1)], offsets=[0, -1])
    change = sparse_qp(H, later, TIME_GRID * cells - later @ wanted, np.full(2 * count, np.inf), QP_TOLERANCE).x
    times = np.round((wanted + change) / TIME_GRID)
    for k in range(1, 2 * count):  # two that are half way between grid points may have been rounded apart
        times[k] = max(times[k], times[k - 1] + cells[k])
    return tuple(
        Step(step.foot, TIME_GRID * float(lift), TIME_GRID * float(land))
        for step, (lift, land) in zip(steps, times.reshape(-1, 2), strict=True)
    )


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
