"""Bounded least squares on key bodies, Ramos (20)-(28), along a clip: warm-started, then as one limited programme."""

import numpy as np
import quadprog
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.linalg.lapack import dposv

from sot.motion.limits import Limits
from sot.motion.parts import Part
from sot.motion.spline import LimitedFit, Spline

Array = NDArray[np.float64]

DAMPING = 1e-2  # of a Gauss-Newton step, in the units of squared residuals
STEPS = 10  # most Gauss-Newton steps at one knot
SMALL = 0.05  # rad or m, a step that ends them: they converge quadratically, and the fit goes on from there
LARGEST = 0.5  # rad or m, of a coordinate in one step
JERK = 500.0  # rad/s³ (m/s³), the jerk that costs as much as an error one is ready to accept


def solve_at(part: Part, k: int, y: Array, limits: Limits) -> float:
    """Minimise a part's residuals at one knot within the joint range, from y and into y (nv,).

    Returns:
        The cost ‖e‖² before the last step.
    """
    columns = part.columns
    lower, upper = limits.lower[columns], limits.upper[columns]
    e, J = np.empty(part.rows), np.empty((part.rows, len(columns)))
    diagonal = np.arange(len(columns))
    for _ in range(STEPS):
        part.evaluate(k, y, e, J)
        g, H = J.T @ e, J.T @ J
        H[diagonal, diagonal] += DAMPING
        x = y[columns]
        step = _bounded_step(H, g, lower - x, upper - x)
        largest = max(step.max(), -step.min())
        if largest > LARGEST:
            step *= LARGEST / largest
        y[columns] = x + step
        if largest < SMALL:
            break
    return float(e @ e)


def _bounded_step(H: Array, g: Array, lower: Array, upper: Array) -> Array:
    """Minimise ½ xᵀH x + gᵀx over lower <= x <= upper; lower <= 0 <= upper."""
    x = -dposv(H, g)[1]
    if (x >= lower).all() and (x <= upper).all():
        return x
    bounded = np.flatnonzero(np.isfinite(lower))
    C = np.zeros((len(g), 2 * len(bounded)))
    C[bounded, np.arange(len(bounded))] = 1.0
    C[bounded, len(bounded) + np.arange(len(bounded))] = -1.0
    return quadprog.solve_qp(H, -g, C, np.concatenate([lower[bounded], -upper[bounded]]))[0]


def follow(part: Part, y: Array, limits: Limits) -> Array:
    """A part solved along y (T, nv), each solution from the one before: the path (T, nv) without rate limits.

    Every other knot is solved; a spline gives those between.
    """
    columns = part.columns
    solved = np.append(np.arange(0, len(y) - 1, 2), len(y) - 1)
    current = y[0].copy()
    path = y.copy()
    for k in solved:
        solve_at(part, int(k), current, limits)
        path[k, columns] = current[columns]
    path[:, columns] = CubicSpline(solved, path[solved][:, columns])(np.arange(len(y)))
    return path


class PartFit:
    """Fits a part over a whole clip under range, velocity and acceleration limits."""

    def __init__(self, columns: Array, length: int, period: float, limits: Limits):
        self._columns = columns
        self._fit = LimitedFit(
            length,
            period,
            limits.lower[columns],
            limits.upper[columns],
            limits.velocity[columns],
            limits.acceleration[columns],
            smoothness=np.full(len(columns), JERK),
            damping=DAMPING,
        )

    def improve(self, part: Part, spline: Spline, others: Array, steps: int) -> Spline:
        """Gauss-Newton steps from a spline of the part's columns, the other coordinates being those of (T, nv)."""
        y = others.copy()
        e, J = np.empty((len(y), part.rows)), np.empty((len(y), part.rows, len(self._columns)))
        for _ in range(steps):
            y[:, self._columns] = spline.knots
            for k in range(len(y)):
                part.evaluate(k, y[k], e[k], J[k])
            spline, _ = self._fit.step(spline, J, e)
        return spline
