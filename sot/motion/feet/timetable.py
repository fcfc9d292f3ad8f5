"""When feet leave the floor and land: the dancer's times, changed by the least that one foot at a time needs."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from solvers.banded import sparse_qp
from sot.motion.feet.footwork import Step

Array = NDArray[np.float64]

GRID = 0.02  # s, of which all times are multiples, as those below
SWING = 0.34  # s, least time of a foot in the air
DOUBLE = 0.12  # s, least time on both feet between steps of one and the other: two force ramps, and time to shift
STANCE = 0.20  # s, least time on the floor between two steps of a foot
SHIFT = 0.5  # s, least time before the first step, to shift the weight
LATE = 0.02  # s, a change of a time that one is ready to accept
EXACT = 1e-6  # tolerance of the programme
RETIMED = 1.0  # price of a changed duration of a step, against one of a changed middle


def timetable(steps: Sequence[Step], least: Sequence[float]) -> tuple[Step, ...]:
    """The steps in order, one after the other, at times as near to theirs as that allows.

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
    gaps[0] = SHIFT
    gaps[1::2] = np.maximum(SWING, least)
    gaps[2::2] = [STANCE if a.foot == b.foot else DOUBLE for a, b in pairwise(steps)]
    cells = np.ceil(gaps / GRID - 1e-9)
    middle, span = np.array([[0.5, 0.5], [0.5, 0.5]]), np.array([[1.0, -1.0], [-1.0, 1.0]])
    H = sp.block_diag(count * [(middle + RETIMED * span) / LATE**2])
    later = sp.diags_array([np.ones(2 * count), -np.ones(2 * count - 1)], offsets=[0, -1])
    change = sparse_qp(H, later, GRID * cells - later @ wanted, np.full(2 * count, np.inf), EXACT).x
    times = np.round((wanted + change) / GRID)
    for k in range(1, 2 * count):  # two that are half way between grid points may have been rounded apart
        times[k] = max(times[k], times[k - 1] + cells[k])
    return tuple(
        Step(step.foot, GRID * float(lift), GRID * float(land))
        for step, (lift, land) in zip(steps, times.reshape(-1, 2), strict=True)
    )
