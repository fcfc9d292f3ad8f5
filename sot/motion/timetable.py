"""When feet leave the floor and land: the dancer's times, changed by the least that one foot at a time needs."""

from collections.abc import Sequence

import numpy as np
import quadprog
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.footwork import Step
from sot.motion.stance import LEAD, TAIL

Array = NDArray[np.float64]

GRID = 0.02  # s, of which all times are multiples, as those below
SWING = 0.34  # s, least time of a foot in the air
DOUBLE = 0.12  # s, least time on both feet between steps of one and the other: two force ramps, and time to shift
STANCE = 0.20  # s, least time on the floor between two steps of a foot
SHIFT = 0.5  # s, least time before the first step and after the last, to shift the weight
RETIMED = 1.0  # price of a changed duration of a step, against one of a changed middle


def timetable(steps: Sequence[Step], duration: float) -> tuple[Step, ...]:
    """The steps in order, one after the other, at times as near to theirs as that allows.

    Least squares over lift and land of all steps; a flight, or a step of one foot that begins before the other's has
    ended, becomes two steps with a double support between them.

    Args:
        steps: in order of their middles; their times may overlap [s].
        duration: of the motion [s].

    Raises:
        InputError: more steps than the time has room for.
    """
    if not steps:
        return ()
    count = len(steps)
    wanted = np.array([(step.lift, step.land) for step in steps]).ravel()
    rows, least = [], []

    def later(first: int | None, second: int | None, by: float) -> None:
        row = np.zeros(2 * count)
        if first is not None:
            row[first] = -1.0
        if second is not None:
            row[second] = 1.0
        rows.append(row)
        least.append(by)

    later(None, 0, SHIFT)
    later(2 * count - 1, None, SHIFT - duration)
    for k in range(count):
        later(2 * k, 2 * k + 1, SWING)
        if k + 1 < count:
            later(2 * k + 1, 2 * k + 2, STANCE if steps[k].foot == steps[k + 1].foot else DOUBLE)
    middle, span = np.array([[0.5, 0.5], [0.5, 0.5]]), np.array([[1.0, -1.0], [-1.0, 1.0]])
    H = np.kron(np.eye(count), middle + RETIMED * span)
    try:
        times = quadprog.solve_qp(H, H @ wanted, np.array(rows).T, np.array(least))[0].reshape(-1, 2)
    except ValueError:
        need = SWING + DOUBLE
        raise InputError(
            f"{count} steps do not fit into {duration - LEAD - TAIL:.1f} s, each takes {need:g} s: leave some out"
        ) from None
    times = GRID * np.round(times / GRID)
    return tuple(Step(step.foot, float(lift), float(land)) for step, (lift, land) in zip(steps, times, strict=True))
