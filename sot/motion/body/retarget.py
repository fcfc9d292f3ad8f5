"""Bounded least squares on key bodies, Ramos (20)-(28): knot by knot, then as one limited programme over the clip."""

import numpy as np
import quadprog
from numpy.typing import NDArray

from sot.motion.body.limits import Limits
from sot.motion.body.parts import Indices, Part
from sot.motion.body.spline import LimitedFit, Spline

Array = NDArray[np.float64]

GAUSS_NEWTON_DAMPING = 1e-2  # of a Gauss-Newton step, in the units of squared residuals
MAX_GAUSS_NEWTON_STEPS = 10  # most Gauss-Newton steps at one knot
CONVERGED_STEP = 0.05  # rad or m, a step below this ends the iteration, which converges quadratically
MAX_ACTIVE_SET_ROUNDS = 8  # most changes of the active bounds in one step
MAX_STEP = 0.5  # rad or m, largest change of a coordinate in one step
ACCEPTED_JERK = 500.0  # rad/s³ (m/s³), the jerk that costs as much as an acceptable error


def solve_knots(part: Part, knots: Indices, y: Array, limits: Limits) -> tuple[Array, Array]:
    """Minimise a part's residuals within the joint range at each of some knots, from its row of y (n, nv).

    Returns:
        The part's coordinates (n, s), and the costs ‖e‖² (n,) before the last step.
    """
    columns = part.columns
    lower, upper = limits.lower[columns], limits.upper[columns]
    y, cost = y.copy(), np.empty(len(y))
    left = np.arange(len(y))  # rows that still move
    for _ in range(MAX_GAUSS_NEWTON_STEPS):
        e, J = part.evaluate(knots[left], y[left])
        Jt = J.transpose(0, 2, 1)
        g, H = (Jt @ e[..., None])[..., 0], Jt @ J + GAUSS_NEWTON_DAMPING * np.eye(len(columns))
        x = y[left[:, None], columns]
        step = bounded_step(H, g, lower - x, upper - x)
        largest = np.abs(step).max(axis=1)
        step *= np.minimum(1.0, MAX_STEP / np.maximum(largest, MAX_STEP))[:, None]
        y[left[:, None], columns] = x + step
        cost[left] = np.sum(e**2, axis=1)
        left = left[largest >= CONVERGED_STEP]
        if not len(left):
            break
    return y[:, columns], cost


def bounded_step(H: Array, g: Array, lower: Array, upper: Array) -> Array:
    """Minimise ½ xᵀH x + gᵀx over lower <= x <= upper for each of n problems, g and bounds (n, s), H (n, s, s).

    Primal-dual active sets (Hintermüller, Ito and Kunisch 2002), all problems at once: at a bound are the coordinates
    that would pass it and those already there that gain by staying. The few for which this goes round in circles are
    solved one by one.
    """
    x = np.linalg.solve(H, -g[..., None])[..., 0]
    low, high = x < lower, x > upper
    left = np.flatnonzero((low | high).any(axis=1))
    for _ in range(MAX_ACTIVE_SET_ROUNDS):
        if not len(left):
            break
        below, above, own = low[left], high[left], H[left]
        fixed = np.where(below, lower[left], np.where(above, upper[left], 0.0))
        free = ~(below | above)
        reduced = own * (free[:, :, None] & free[:, None, :])
        reduced[:, np.arange(g.shape[1]), np.arange(g.shape[1])] += ~free
        right = -(g[left] + (own @ fixed[..., None])[..., 0])
        x[left] = now = np.linalg.solve(reduced, np.where(free, right, 0.0)[..., None])[..., 0] + fixed
        pull = -(g[left] + (own @ now[..., None])[..., 0])
        low[left] = np.where(below, pull < 0.0, now < lower[left])
        high[left] = np.where(above, pull > 0.0, now > upper[left])
        left = left[((low[left] != below) | (high[left] != above)).any(axis=1)]
    bounded = np.isfinite(lower[0])
    C = np.eye(g.shape[1])[:, bounded]
    for i in left:
        ends = np.concatenate([lower[i, bounded], -upper[i, bounded]])
        x[i] = quadprog.solve_qp(H[i], -g[i], np.hstack([C, -C]), ends)[0]
    return np.clip(x, lower, upper)


class PartFit:
    """Fits a part over a whole clip under range, velocity and acceleration limits."""

    def __init__(self, columns: Indices, length: int, period: float, limits: Limits, rest_at_end: bool = True):
        """rest_at_end: whether it ends at rest, see `LimitedFit`."""
        self._columns = columns
        self._fit = LimitedFit(
            length,
            period,
            limits.lower[columns],
            limits.upper[columns],
            limits.velocity[columns],
            limits.acceleration[columns],
            smoothness=np.full(len(columns), ACCEPTED_JERK),
            damping=GAUSS_NEWTON_DAMPING,
            rest_at_end=rest_at_end,
        )

    def refine(
        self,
        part: Part,
        spline: Spline,
        others: Array,
        steps: int,
        acceleration_residuals: tuple[Array, Array] | None = None,
        first_knot: int = 0,
    ) -> Spline:
        """Gauss-Newton steps from a spline of the part's columns, the other coordinates being those of (T, nv).

        acceleration_residuals: residuals (T, r) and Jacobians (T, r, nv) for the coordinates' second derivatives.
        first_knot: the part's knot with which they all begin.
        """
        acceleration_residuals = (
            None
            if acceleration_residuals is None
            else (acceleration_residuals[0], acceleration_residuals[1][:, :, self._columns])
        )
        y, knots = others.copy(), first_knot + np.arange(len(others))
        for _ in range(steps):
            y[:, self._columns] = spline.knots
            e, J = part.evaluate(knots, y)
            spline, _ = self._fit.step(spline, J, e, acceleration_residuals)
        return spline
