"""Uniform cubic B-splines of vectors, and their fit under position, velocity and acceleration limits.

A cubic B-spline lies in the convex hull of its control points, its velocity and acceleration in those of their scaled
differences. Limits on these hold therefore at every instant, not only at the samples.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.linalg import solve_banded

from solvers.banded import BandedQP, BandedSolution

Array = NDArray[np.float64]

VALUE_STENCIL = np.array([1.0, 4.0, 1.0]) / 6.0  # a knot's value from its three control points
ACCELERATION_STENCIL = np.array([1.0, -2.0, 1.0])  # second derivative at a knot, times the period squared
JERK_STENCIL = np.array([-1.0, 3.0, -3.0, 1.0])  # third derivative, times the period cubed
HELD_END_WEIGHT = 1e11  # weight that holds both ends of the spline, above all residuals


@dataclass(frozen=True)
class Spline:
    """A cubic spline through T knots, `period` apart.

    Attributes:
        control: (T + 2, s) control points.
        period: time between knots [s].
    """

    control: Array
    period: float

    @property
    def knots(self) -> Array:
        """Values at the knots (T, s)."""
        c = self.control
        return VALUE_STENCIL[0] * c[:-2] + VALUE_STENCIL[1] * c[1:-1] + VALUE_STENCIL[2] * c[2:]

    @property
    def velocities(self) -> Array:
        """First derivatives at the knots (T, s)."""
        return (self.control[2:] - self.control[:-2]) / (2.0 * self.period)

    @property
    def accelerations(self) -> Array:
        """Second derivatives at the knots (T, s)."""
        return np.diff(self.control, 2, axis=0) / self.period**2

    @property
    def duration(self) -> float:
        """Time from the first knot to the last [s]."""
        return self.period * (len(self.control) - 3)

    def __call__(self, times: Array, derivative: int = 0) -> Array:
        """Values (n, s), or their derivative of an order up to 3, at times (n,) within the duration."""
        grid = self.period * np.arange(-3, len(self.control) + 1)
        return BSpline(grid, self.control, 3)(np.clip(times, 0.0, self.duration), derivative)

    @staticmethod
    def through(values: Array, period: float) -> "Spline":
        """The spline that passes through values (T, s), at rest at both ends."""
        n = len(values)
        bands = np.zeros((3, n + 2))
        bands[0, 2:], bands[1, 1:-1], bands[2, :-2] = VALUE_STENCIL[2], VALUE_STENCIL[1], VALUE_STENCIL[0]
        bands[1, [0, -1]] = 1.0
        bands[0, 1] = bands[2, -2] = 0.0
        # the first and last rows ask for c_0 = q_0: with the knot's own row, velocity stays near zero there
        right = np.vstack([values[:1], values, values[-1:]])
        return Spline(solve_banded((1, 1), bands, right), period)


class LimitedFit:
    """Least squares over a whole trajectory, under limits: one Gauss-Newton step of a sequential convex programme.

    Minimises Σ_k ‖e_k + J_k (q_k − q̄_k)‖² + Σ w ‖jerk‖² + Σ d ‖q_k − q̄_k‖² over the control points of a spline, q̄
    being the spline it starts from. What that one does at its first knot is kept; the last is reached at rest, or, of a
    part of a longer one, kept as well.
    """

    def __init__(
        self,
        length: int,
        period: float,
        lower: Array,
        upper: Array,
        velocity: Array,
        acceleration: Array,
        smoothness: Array,
        damping: float,
        rest_at_end: bool = True,
    ):
        """
        Args:
            length: number of knots T.
            period: time between them [s].
            lower, upper, velocity, acceleration: (s,) limits, infinite where there is none.
            smoothness: (s,) standard deviation expected of the jerk; its inverse square is the weight w.
            damping: weight d of a step.
            rest_at_end: whether it ends at rest; if not, the last three control points stay.
        """
        self.period, self.damping, self._rest_at_end = period, damping, rest_at_end
        self._size = size = len(lower)
        self._count = count = length + 2
        self._jerk_weight = 1.0 / smoothness**2 / period**6
        n = size * count
        order = np.arange(4)
        identity = sp.eye_array(n)
        rate = sp.diags_array([-np.ones(n), np.ones(n)], offsets=[0, size], shape=(n - size, n))
        curve = sp.diags_array(
            [value * np.ones(n) for value in ACCELERATION_STENCIL],
            offsets=list(size * order[:3]),
            shape=(n - 2 * size, n),
        )
        A = sp.vstack([identity, rate, curve], format="csr")
        top = np.concatenate(
            [
                np.tile(upper, count),
                np.tile(velocity * period, count - 1),
                np.tile(acceleration * period**2, count - 2),
            ]
        )
        bottom = np.concatenate([np.tile(lower, count), -top[n:]])
        self._qp = BandedQP(A, bottom, top, band=3 * size)  # jerk reaches that far, and only within a coordinate

    def step(
        self, spline: Spline, J: Array, e: Array, acceleration_residuals: tuple[Array, Array] | None = None
    ) -> tuple[Spline, BandedSolution]:
        """The next spline from residuals e (T, r) and their Jacobians J (T, r, s) at the knots of this one.

        acceleration_residuals: residuals and Jacobians for the second derivatives at the knots, if there are any.
        """
        normal, gradient = _normal_equations(e, J)
        normal[:, np.arange(self._size), np.arange(self._size)] += self.damping
        parts = [(VALUE_STENCIL, normal, gradient)]
        if acceleration_residuals is not None:
            parts.append((ACCELERATION_STENCIL / self.period**2, *_normal_equations(*acceleration_residuals)))
        H, g = self._assemble(spline.control, parts)
        solution = self._qp.solve(H, g, expansion_point=spline.control.ravel())
        control = solution.x.reshape(self._count, self._size)
        control[:3] = spline.control[:3]
        control[-3:] = control[-3] if self._rest_at_end else spline.control[-3:]
        return Spline(control, self.period), solution

    def _assemble(self, control: Array, parts: Sequence[tuple[Array, Array, Array]]) -> tuple[Array, Array]:
        """Banded Hessian and gradient over the control points, from those over what stencils (3,) give at the knots,
        (T, s, s) and (T, s)."""
        count, size = self._count, self._size
        length = count - 2
        H = np.zeros((count, size, self._qp.band + 1))
        g = np.zeros((count, size))
        row, column = np.divmod(np.arange(size * size), size)
        jerk = np.diff(control, 3, axis=0)
        for apart in range(3):
            block = np.zeros((count, size, size))
            for stencil, normal, _ in parts:
                for i in range(3 - apart):
                    block[i : i + length] += stencil[i] * stencil[i + apart] * normal
            stored = np.flatnonzero(row >= column) if apart == 0 else np.arange(size * size)
            offset = apart * size + row[stored] - column[stored]
            H[:, column[stored], offset] = block.reshape(count, -1)[:, stored]
        for apart in range(4):
            for i in range(4 - apart):
                H[i : i + count - 3, :, apart * size] += JERK_STENCIL[i] * JERK_STENCIL[i + apart] * self._jerk_weight
        for stencil, _, gradient in parts:
            for i in range(3):
                g[i : i + length] += stencil[i] * gradient
        for i in range(4):
            g[i : i + count - 3] += JERK_STENCIL[i] * self._jerk_weight * jerk
        self._hold_ends(H, g, control)
        return H.reshape(count * size, -1), g.ravel()

    def _hold_ends(self, H: Array, g: Array, control: Array) -> None:
        """Hold the first three control points; hold the last three as well, or make them equal to one another."""
        size = self._size
        H[:3, :, 0] += HELD_END_WEIGHT
        if not self._rest_at_end:
            H[-3:, :, 0] += HELD_END_WEIGHT
            return
        for first, second in ((-3, -2), (-2, -1)):
            difference = control[second] - control[first]
            g[first] -= HELD_END_WEIGHT * difference
            g[second] += HELD_END_WEIGHT * difference
            H[first, :, 0] += HELD_END_WEIGHT
            H[second, :, 0] += HELD_END_WEIGHT
            H[first, :, size] -= HELD_END_WEIGHT


def _normal_equations(e: Array, J: Array) -> tuple[Array, Array]:
    """Normal matrices (T, s, s) and gradients (T, s) of residuals (T, r) with Jacobians (T, r, s)."""
    Jt = J.transpose(0, 2, 1)
    return np.matmul(Jt, J), np.matmul(Jt, e[..., None])[..., 0]
