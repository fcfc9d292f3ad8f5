"""Checks of the rows that tasks return, before compiled code reads them."""

from collections.abc import Sequence

import numpy as np

from solvers.rows import Rows
from sot.control.task import Task, Variable
from sot.errors import InvalidRowsError

_WANTED_COLUMNS: dict[Variable, str] = {
    "acceleration": "the robot has {} velocities",
    "torque": "the robot has {} joints",
    "force": "the contacts have {} force variables now",
}


def check_rows(task: Task, rows: Rows, columns: Sequence[int]) -> None:
    """See that rows are float arrays of fitting shapes without nan; bounds of limits may be infinite.

    Args:
        task: Who returned the rows.
        rows: What it returned.
        columns: Numbers of columns that rows may have in the kind of variable that the task is about.

    Raises:
        InvalidRowsError: Naming the task and the sizes.
    """

    def invalid(what: str) -> InvalidRowsError:
        return InvalidRowsError(f"task '{task.name}': {what}")

    if not isinstance(rows, Rows):
        raise invalid(f"rows(tick) returned {type(rows).__name__}, not Rows: return self.make_rows(A, lower, upper)")
    matrix = "Jacobian" if task.variable == "acceleration" else "matrix"
    for part, values in ((f"its {matrix} is", rows.A), ("its bounds are", rows.lower), ("its bounds are", rows.upper)):
        if not isinstance(values, np.ndarray) or values.dtype != np.float64:
            kind = f"an array of {values.dtype}" if isinstance(values, np.ndarray) else type(values).__name__
            raise invalid(f"{part} {kind}: make it an array of floats (float64)")
    A, lower, upper = rows.A, rows.lower, rows.upper
    if A.ndim != 2 or lower.ndim != 1 or upper.ndim != 1:
        shapes = f"{A.shape}, its bounds {lower.shape} and {upper.shape}"
        raise invalid(f"its {matrix} has shape {shapes}, not (m, {columns[0]}), (m,) and (m,)")
    if A.shape[1] not in columns:
        raise invalid(f"its {matrix} has {A.shape[1]} columns, {_WANTED_COLUMNS[task.variable].format(columns[0])}")
    if not len(A) == len(lower) == len(upper):
        raise invalid(f"its {matrix} has {len(A)} rows, its bounds {len(lower)} and {len(upper)}")
    if not np.isfinite(A).all():
        raise invalid(f"its {matrix} holds a value that is not finite")
    if task.equality:
        if not np.isfinite(lower).all():
            raise invalid(f"what it wants ({task.unit}) holds a value that is not finite")
        if lower is not upper and not np.array_equal(lower, upper):
            raise invalid("its lower and upper bounds differ: a limit needs `equality = False` in its class")
    elif np.isnan(lower).any() or np.isnan(upper).any():
        raise invalid("its bounds hold a value that is not a number")
