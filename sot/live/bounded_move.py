"""A step of a small least-squares problem within bounds, compiled: `bounded_step` for one moment."""

import numpy as np
from numpy.typing import NDArray

from solvers.compiled import compiled
from sot.motion.body.retarget import MAX_STEP

Array = NDArray[np.float64]


@compiled
def bounded_move(x: Array, H: Array, g: Array, lower: Array, upper: Array) -> None:
    """Move x by the step that minimises ½ sᵀH s + gᵀs within its range: primal-dual active sets, as `bounded_step`."""
    size = len(x)
    low, high = np.zeros(size, dtype=np.bool_), np.zeros(size, dtype=np.bool_)
    step = np.zeros(size)
    for _ in range(3 * size):
        A, b = np.eye(size), np.zeros(size)
        for i in range(size):
            if low[i] or high[i]:
                b[i] = (lower[i] if low[i] else upper[i]) - x[i]
        for i in range(size):
            if low[i] or high[i]:
                continue
            right = -g[i]
            for j in range(size):
                if low[j] or high[j]:
                    right -= H[i, j] * b[j]
                else:
                    A[i, j] = H[i, j]
            step[i] = right
        for i in range(size):
            if not (low[i] or high[i]):
                b[i] = step[i]
        step[:] = np.linalg.solve(A, b)
        changed = False
        for i in range(size):
            pull = -g[i]
            for j in range(size):
                pull -= H[i, j] * step[j]
            below = pull < 0.0 if low[i] else (not high[i] and x[i] + step[i] < lower[i])
            above = pull > 0.0 if high[i] else (not low[i] and x[i] + step[i] > upper[i])
            changed = changed or below != low[i] or above != high[i]
            low[i], high[i] = below, above
        if not changed:
            break
    most = 0.0
    for i in range(size):
        most = max(most, abs(step[i]))
    scale = min(1.0, MAX_STEP / max(most, MAX_STEP))
    for i in range(size):
        x[i] = min(max(x[i] + scale * step[i], lower[i]), upper[i])
