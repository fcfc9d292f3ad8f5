"""When feet leave the floor and land: the dancer's times, changed by the least that one foot at a time needs."""

from collections.abc import Sequence

import numpy as np
import quadprog
from numpy.typing import NDArray

from sot.motion.footwork import Step

Array = NDArray[np.float64]

GRID = 0.02  # s, of which all times are multiples, as those below
SWING = 0.34  # s, least time of a foot in the air
DOUBLE = 0.12  # s, least time on both feet between steps of one and the other: two force ramps, and time to shift
STANCE = 0.20  # s, least time on the floor between two steps of a foot
SHIFT = 0.5  # s, least time before the first step, to shift the weight
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
    rows, bounds = [], []

    def later(first: int | None, second: int, by: float) -> None:
        row = np.zeros(2 * count)
        row[second] = 1.0
        if first is not None:
            row[first] = -1.0
        rows.append(row)
        bounds.append(by)

    later(None, 0, SHIFT)
    for k in range(count):
        later(2 * k, 2 * k + 1, GRID * np.ceil(max(SWING, least[k]) / GRID - 1e-9))
        if k + 1 < count:
            later(2 * k + 1, 2 * k + 2, STANCE if steps[k].foot == steps[k + 1].foot else DOUBLE)
    middle, span = np.array([[0.5, 0.5], [0.5, 0.5]]), np.array([[1.0, -1.0], [-1.0, 1.0]])
    H = np.kron(np.eye(count), middle + RETIMED * span)
    times = quadprog.solve_qp(H, H @ wanted, np.array(rows).T, np.array(bounds))[0].reshape(-1, 2)
    times = GRID * np.round(times / GRID)
    return tuple(Step(step.foot, float(lift), float(land)) for step, (lift, land) in zip(steps, times, strict=True))
