"""Bounded least squares on key bodies, Ramos (20)-(28), along a clip: warm-started, then as one limited programme."""

import numpy as np
import quadprog
from numpy.typing import NDArray
from scipy.linalg.lapack import dposv

from sot.motion.kinematics import Kinematics
from sot.motion.limits import Limits
from sot.motion.parts import Part
from sot.motion.spline import LimitedFit, Spline
from sot.robot import Robot

Array = NDArray[np.float64]

DAMPING = 1e-2  # of a Gauss-Newton step, in the units of squared residuals
STEPS = 12  # most Gauss-Newton steps at one knot
SMALL = 1e-3  # rad or m, a step that ends them
LARGEST = 0.5  # rad or m, of a coordinate in one step
JERK = 300.0  # rad/s³ (m/s³), the jerk that costs as much as an error one is ready to accept


def solve_at(part: Part, kinematics: Kinematics, k: int, y: Array, limits: Limits, steps: int = STEPS) -> float:
    """Minimise a part's residuals at one knot within the joint range, from y and into y (nv,); the cost ‖e‖² at y.

    Gauss-Newton with coordinates that press against a bound held there.
    """
    columns = part.columns
    lower, upper = limits.lower[columns], limits.upper[columns]
    e, rows = np.empty(part.rows), np.zeros((part.rows, len(y)))
    diagonal = np.arange(len(columns))
    for _ in range(steps):
        kinematics.at(y)
        part.fill(kinematics, k, e, rows)
        J = kinematics.in_coordinates(rows)
        g, H = J.T @ e, J.T @ J
        H[diagonal, diagonal] += DAMPING
        x = y[columns]
        step = _bounded_step(H, g, lower - x, upper - x)
        largest = np.abs(step).max()
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


def follow(part: Part, robot: Robot, y: Array, limits: Limits) -> Array:
    """A part solved at every knot of y (T, nv), each from the one before: the path (T, nv) without rate limits."""
    kinematics = Kinematics(robot, part.columns)
    path = y.copy()
    columns = part.columns
    for k in range(len(path)):
        if k:
            path[k, columns] = path[k - 1, columns]
        solve_at(part, kinematics, k, path[k], limits)
    return path


class PartFit:
    """Fits a part over a whole clip under range, velocity and acceleration limits."""

    def __init__(self, robot: Robot, columns: Array, length: int, period: float, limits: Limits):
        self._robot, self._columns = robot, columns
        self._fit = LimitedFit(
            length,
            period,
            *(getattr(limits, name)[columns] for name in ("lower", "upper", "velocity", "acceleration")),
            smoothness=np.full(len(columns), JERK),
            damping=DAMPING,
        )

    def improve(self, part: Part, spline: Spline, others: Array, steps: int) -> Spline:
        """Gauss-Newton steps from a spline of the part's columns, the other coordinates being those of (T, nv)."""
        kinematics = Kinematics(self._robot, self._columns)
        y = others.copy()
        e, rows = np.empty((len(y), part.rows)), np.zeros((part.rows, y.shape[1]))
        J = np.empty((len(y), part.rows, len(self._columns)))
        for _ in range(steps):
            y[:, self._columns] = spline.knots
            for k in range(len(y)):
                kinematics.at(y[k])
                part.fill(kinematics, k, e[k], rows)
                J[k] = kinematics.in_coordinates(rows)
            spline, _ = self._fit.step(spline, J, e)
        return spline
