"""Coordinates that start early for what they will be asked for: a plan of each over the future that is known."""

import numpy as np
import quadprog
from numpy.typing import NDArray

from sot.live.com_preview import KNOT_PERIOD

Array = NDArray[np.float64]

MAX_KNOTS = 20
"""Knots of a plan at most: more of the future than 0.4 s changes little."""
BLOCKS = (2, 2, 4, 4, 8)
"""Knots over which an acceleration stays the same, from now on; a shorter plan takes the first of them. With a first
block of one knot, accelerations chatter: they change only as fast as the jerk allows."""
ACCELERATION_COST = 3e-4
"""Mean square of an error [rad² or m²] that costs as much as all of the acceleration limit."""


class JointPreview:
    """Accelerations of coordinates towards targets that are known for a while, a little programme each.

    Over the known future, accelerations u are chosen so that the sum of squared errors at the knots is least,

        min Σ (x(t_k) − x_t(t_k))²,   |u| <= a_max,   |ẋ| <= v_max.

    A target that a coordinate cannot keep up with is then met in the middle of its way, instead of behind it.

    Args:
        velocity, acceleration: limits (n,) of the coordinates.
        horizon: how much of the future is known [s].

    Attributes:
        times: of the knots, from now on [s].
    """

    def __init__(self, velocity: Array, acceleration: Array, horizon: float) -> None:
        self._velocity, self._acceleration = velocity, acceleration
        knots, T = min(max(round(horizon / KNOT_PERIOD), 1), MAX_KNOTS), KNOT_PERIOD
        ends = np.unique(np.minimum(np.cumsum(BLOCKS), knots))
        sizes = np.diff(ends, prepend=0)
        blocks = np.repeat(np.eye(len(ends)), sizes, axis=0)
        self.times: Array = T * np.arange(1, knots + 1).astype(float)
        since = np.maximum(self.times[:, None] - T * np.arange(knots), 0.0)
        position = 0.5 * (since**2 - np.maximum(since - T, 0.0) ** 2) @ blocks
        speed = (T * np.tri(knots) @ blocks)[ends - 1]
        self._position = acceleration[:, None, None] * position  # (n, T, b) in shares of the limits
        self._speed = acceleration[:, None, None] * speed
        cost = ACCELERATION_COST * np.diag(sizes).astype(float)
        self._hessian: Array = self._position.transpose(0, 2, 1) @ self._position + cost
        self._gain: Array = np.linalg.solve(self._hessian, self._position.transpose(0, 2, 1))
        one = np.eye(len(ends))
        self._rows = [np.vstack([one, -one, V, -V]).T.copy() for V in self._speed]

    def __call__(self, x: Array, dx: Array, wanted: Array) -> Array:
        """Accelerations (n,) to begin with, from a state (n,); wanted (T, n) at the `times` from now."""
        rate = np.clip(dx, -self._velocity, self._velocity)
        way = (wanted - x - self.times[:, None] * rate).T
        shares = np.einsum("nbt,nt->nb", self._gain, way)  # the least error without limits, which most are within
        speed = np.abs(rate[:, None] + np.einsum("nbc,nc->nb", self._speed, shares)).max(axis=1)
        for k in np.flatnonzero((speed > self._velocity) | (np.abs(shares).max(axis=1) > 1.0)):
            shares[k] = self._limited(int(k), way[k], float(rate[k]))
        return np.asarray(self._acceleration * shares[:, 0])

    def _limited(self, k: int, way: Array, rate: float) -> Array:
        """Shares (b,) of the acceleration limit of one coordinate for its way (T,) beside its rate."""
        count, most = self._speed.shape[1], self._velocity[k]
        bounds = np.repeat([-1.0, -1.0, -most - rate, rate - most], count)
        return np.asarray(quadprog.solve_qp(self._hessian[k], self._position[k].T @ way, self._rows[k], bounds)[0])
