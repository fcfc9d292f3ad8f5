"""The times of the robot's steps: the dancer's, changed by the least with which one foot at a time steps."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from solvers.banded import sparse_qp
from sot.motion.feet.footwork import Step

Array = NDArray[np.float64]

TIME_GRID = 0.02  # s, of which all times are multiples, as those below
MIN_SWING_TIME = 0.34  # s of a foot in the air
MIN_DOUBLE_SUPPORT_TIME = 0.12  # s between steps of one foot and the other: two force ramps, and a shift of weight
MIN_STANCE_TIME = 0.20  # s of a foot on the floor between two of its steps
WEIGHT_SHIFT_TIME = 0.5  # s before the first step, in which the weight shifts
ACCEPTED_TIME_CHANGE = 0.02  # s, that costs one unit
QP_TOLERANCE = 1e-6  # of the programme's multipliers and residuals
DURATION_CHANGE_WEIGHT = 1.0  # of a change of a step's duration, against that of its middle


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
