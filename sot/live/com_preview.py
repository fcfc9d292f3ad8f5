"""The centre of mass over standing feet with the little future there is: a gentle plan that stays well inside."""

from collections.abc import Sequence

import numpy as np
import quadprog
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.polygon import Polygon

Array = NDArray[np.float64]

KNOT_PERIOD = 0.02
"""Time between the knots of a plan [s], and between plans."""
HORIZON = 0.6
"""Time for which what is wanted now is assumed to stay [s]."""
BLOCKS = (1, 1, 2, 2, 4, 4, 6, 10)
"""Knots over which a jerk stays the same, from now on: they add up to the horizon."""
ACCEPTED_ERROR = 0.02
"""Distance from the wanted place that costs as much as an accepted jerk [m]."""
ACCEPTED_JERK = 4.0
"""Jerk that costs as much as an accepted error [m/s³]."""
ACCEPTED_EXCESS = 1e-4
"""The same of the zero-moment point beyond its room, so that there always is a plan [m]."""
COM_MARGIN_PER_SOLE = (0.34, 0.70)
"""Distance that the wanted centre of mass keeps from the support's edges, in lengths and breadths of a sole."""
ZMP_MARGIN_PER_SOLE = (0.29, 0.59)
"""The same of the planned zero-moment point."""


class ComPreview:
    """Plan of the horizontal centre of mass, a little programme every KNOT_PERIOD.

    Over the horizon the jerk of the centre of mass is chosen so that it goes to the wanted place, the zero-moment point
    z = c − c̈ h/g stays inside the inset support, and c + ċ/ω as well at the end. Without a future ξ must never
    leave the inset: z would have to pass it to bring it back, and there is no room there. Hence gentle margins.

    Args:
        support: of both soles.
        sole: length and breadth of one sole (2,) [m].
        place: where the centre of mass is at the start, at rest (2,) [m].
        height: of the centre of mass [m].
    """

    def __init__(self, support: Polygon, sole: Array, place: Array, height: float) -> None:
        self.c, self.dc, self.ddc = place.copy(), np.zeros(2), np.zeros(2)
        self._com_room = shrunk_within(support, sole * COM_MARGIN_PER_SOLE)
        self._zmp_room = shrunk_within(support, sole * ZMP_MARGIN_PER_SOLE)
        self._jerk = np.zeros((2, len(BLOCKS)))
        steps, T = sum(BLOCKS), KNOT_PERIOD
        assert abs(steps * T - HORIZON) < 1e-9
        k = np.arange(1, steps + 1)[:, None]
        i = np.arange(steps)[None]
        since = np.where(k > i, (k - i) * T, 0.0)  # time from a jerk's start to a knot
        before = np.where(k > i, since - T, 0.0)
        position, velocity, acceleration = (
            (since**n - before**n) / factor for n, factor in ((3, 6.0), (2, 2.0), (1, 1.0))
        )
        blocks = np.repeat(np.eye(len(BLOCKS)), BLOCKS, axis=0)
        self._position, self._velocity, self._acceleration = (
            matrix @ blocks for matrix in (position, velocity, acceleration)
        )
        t = T * k
        self._times: Array = t[:, 0].astype(float)
        self._free = np.hstack([np.ones_like(t), t, 0.5 * t**2])
        self._free_rate = np.hstack([np.zeros_like(t), np.ones_like(t), t])
        self._free_curve = np.hstack([np.zeros_like(t), np.zeros_like(t), np.ones_like(t)])
        weight = np.diag(np.array(BLOCKS, dtype=float)) / ACCEPTED_JERK**2
        self._hessian = self._position.T @ self._position / ACCEPTED_ERROR**2 + weight
        self._H = np.zeros((2 * len(BLOCKS) + 1, 2 * len(BLOCKS) + 1))
        self._H[:-1, :-1] = np.kron(np.eye(2), self._hessian)
        self._H[-1, -1] = 1.0 / ACCEPTED_EXCESS**2
        self._set_height(height)

    def _set_height(self, height: float) -> None:
        self._height = height
        over = height / GRAVITY
        zmp = self._position - over * self._acceleration
        end = (self._position + np.sqrt(over) * self._velocity)[-1:]
        rows = np.vstack([zmp, end])
        normals = self._zmp_room.normals
        inside = np.vstack([np.hstack([n[0] * rows, n[1] * rows]) for n in normals])
        excess = -np.ones((len(inside), 1))
        none = np.append(np.zeros(2 * len(BLOCKS)), -1.0)
        self._rows = np.vstack([np.hstack([inside, excess]), none])

    def wanted_place(self, place: Array) -> Array:
        """The place nearest to a wanted one (2,) at which the centre of mass may be [m]."""
        return np.asarray(self._com_room.nearest_point(np.ascontiguousarray(place)))

    def plan(self, wanted: Array, future: Sequence[tuple[float, Array]] = ()) -> None:
        """Plan anew from the state of now.

        What angular momentum does to the zero-moment point is left out, and gets the room that the margins leave. With
        it, as if it were to die out, a plan made the centre of mass run away before an arm that went on turning.

        wanted: where the centre of mass is to be now (2,) [m].
        future: how much later [s] it will be wanted how much farther (2,) [m], in order; the last stays.
        """
        over = self._height / GRAVITY
        state = np.stack([self.c, self.dc, self.ddc])
        free, rate, curve = self._free @ state, self._free_rate @ state, self._free_curve @ state
        goal = np.broadcast_to(self.wanted_place(wanted), free.shape)
        if future:
            later = np.array([0.0, *(time for time, _ in future)])
            farther = np.vstack([np.zeros(2), *(way for _, way in future)])
            goal = np.array([self.wanted_place(wanted + way) for way in _interpolated(self._times, later, farther)])
        a = (self._position.T @ (goal - free)) / ACCEPTED_ERROR**2
        zmp = np.vstack([free - over * curve, (free + np.sqrt(over) * rate)[-1:]])
        room = self._zmp_room
        bound = np.concatenate(
            [offset - zmp @ normal for normal, offset in zip(room.normals, room.offsets, strict=True)]
        )
        x = quadprog.solve_qp(self._H, np.append(a.T.ravel(), 0.0), -self._rows.T, -np.append(bound, 0.0))[0]
        self._jerk = x[:-1].reshape(2, -1)

    def advance(self, period: float) -> None:
        """Go on by a period, not beyond the first knots of the plan [s]."""
        jerk = self._jerk[:, 0]
        self.c = self.c + period * self.dc + 0.5 * period**2 * self.ddc + period**3 / 6.0 * jerk
        self.dc = self.dc + period * self.ddc + 0.5 * period**2 * jerk
        self.ddc = self.ddc + period * jerk


def _interpolated(times: Array, at: Array, values: Array) -> Array:
    """Values (T, 2) at times (T,), linear between those (n, 2) at times (n,)."""
    return np.column_stack([np.interp(times, at, column) for column in values.T])


def shrunk_within(support: Polygon, margins: Array, heading: float = 0.0) -> Polygon:
    """The support with its edges moved inward along and across a heading [rad], by less where nothing would be left."""
    share = 1.0
    while True:
        inner = support.shrunk(share * margins[0], share * margins[1], heading)
        if len(inner.vertices) >= 3 and inner.margin(inner.centre) > 0.0:
            return inner
        share *= 0.8
