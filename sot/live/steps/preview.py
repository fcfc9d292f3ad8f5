"""The centre of mass over feet that step, with the steps decided so far: a programme over a receding horizon."""

from collections.abc import Sequence

import numpy as np
import quadprog
from numpy.typing import NDArray

from solvers.compiled import compiled
from sot.gravity import GRAVITY
from sot.live.steps.step_plan import Room

Array = NDArray[np.float64]

KNOT_PERIOD = 0.04
"""Time between the knots of a plan, and between plans [s]."""
KNOTS = 40
"""Knots of a plan: two steps and coming to rest after them."""
FINE_KNOTS = 26
"""First knots each of which has a jerk of its own; later ones share it by twos."""
ACCEPTED_ZMP_ERROR = 0.03
"""Distance of the zero-moment point from the middle of what carries that costs as much as an accepted jerk [m]."""
ACCEPTED_JERK = 60.0
"""Jerk that costs as much [m/s³]."""
ACCEPTED_END_SPEED = 0.02
"""Speed at the end of the horizon that costs as much [m/s]."""
ACCEPTED_EXCESS = 1e-4
"""The same of the zero-moment point beyond its room, so that there always is a plan [m]."""
ACCEPTED_STRETCH = 2e-4
"""The same of the centre of mass beyond where the legs of all feet that stand reach [m]."""
REACH_TOLERANCE = 1e-3
"""Distance beyond their reach that is not looked at [m]."""
EXCESS, STRETCH = 2, 1
"""Columns of both in a programme, from the end."""
MAX_CUTS = 2
"""How often a plan is made again with the edges of the legs' reach that it was beyond."""


class StepPreview:
    """Plan of the horizontal centre of mass, a programme every KNOT_PERIOD.

    With a jerk that is constant from knot to knot, z = c − c̈ h/g + β Σ (c̈_f − c̈) is linear in the jerks; the sum, over
    both feet, is the angular momentum of their legs (`zmp_shift_of_swing`). It minimises

        Σ |z − z_wish|² + Σ |jerk|² + |ċ_end|²,    z in its room at every knot,

    c where the legs of all feet that stand reach, and c + ċ/ω in the room over the feet as they stand in the end: from
    there the robot can come to rest whatever comes next.

    Args:
        place: where the centre of mass is at the start, at rest (2,) [m].
        height: of the centre of mass [m].
        leg_shift: β [m per m/s²].

    Attributes:
        c, dc, ddc: place, velocity and acceleration now (2,).
        places: planned at the knots of the plan that is followed (n, 2) [m].
    """

    def __init__(self, place: Array, height: float, leg_shift: float) -> None:
        self.c, self.dc, self.ddc = place.copy(), np.zeros(2), np.zeros(2)
        self._leg_shift = leg_shift
        T = KNOT_PERIOD
        k, i = np.arange(1, KNOTS + 1)[:, None], np.arange(KNOTS)[None]
        since = np.where(k > i, (k - i) * T, 0.0)
        before = np.where(k > i, since - T, 0.0)
        sizes = np.concatenate([np.ones(FINE_KNOTS, int), np.full((KNOTS - FINE_KNOTS) // 2, 2)])
        blocks = np.repeat(np.eye(len(sizes)), sizes, axis=0)
        self._position, self._rate, self._curve = (
            ((since**n - before**n) / factor) @ blocks for n, factor in ((3, 6.0), (2, 2.0), (1, 1.0))
        )
        t = T * k
        one, nothing = np.ones_like(t), np.zeros_like(t)
        self._free, self._free_rate = np.hstack([one, t, 0.5 * t**2]), np.hstack([nothing, one, t])
        self._free_curve = np.hstack([nothing, nothing, one])
        self._jerk_price = np.diag(sizes / ACCEPTED_JERK**2)
        self.jerk, self.places = np.zeros((2, len(sizes))), np.tile(place, (KNOTS, 1))
        self._set_height(height)

    @property
    def times(self) -> Array:
        """Times of the knots from now (n,) [s]."""
        return KNOT_PERIOD * np.arange(1, KNOTS + 1, dtype=float)

    def _set_height(self, height: float) -> None:
        over = height / GRAVITY
        self._over = over + 2.0 * self._leg_shift
        self._zmp = self._position - self._over * self._curve
        self._time = float(np.sqrt(over))
        self._end = self._position[-1] + np.sqrt(over) * self._rate[-1]
        H = self._zmp.T @ self._zmp / ACCEPTED_ZMP_ERROR**2 + self._jerk_price
        H += np.outer(self._rate[-1], self._rate[-1]) / ACCEPTED_END_SPEED**2
        size = len(H)
        factor = np.linalg.inv(np.linalg.cholesky(H)).T
        self._inverse_factor = np.zeros((2 * size + 2, 2 * size + 2))  # R⁻¹ of the Hessian RᵀR
        self._inverse_factor[:-2, :-2] = np.kron(np.eye(2), factor)
        self._inverse_factor[-2, -2], self._inverse_factor[-1, -1] = ACCEPTED_EXCESS, ACCEPTED_STRETCH
        self._no_less = np.eye(2, 2 * size + 2, 2 * size)

    def solve(self, rooms: Sequence[Room], wish: Array, end: Room, swings: Array) -> tuple[Array, float]:
        """Jerks (2, blocks), and by how much the zero-moment point is beyond its room at most [m].

        Args:
            rooms: at the knots, n.
            wish: where the zero-moment point would best be at the knots (n, 2) [m].
            end: over the feet as they stand in the end.
            swings: how far the foot in the air moves the zero-moment point at the knots (n, 2) [m].
        """
        state = np.stack([self.c, self.dc, self.ddc])
        places = self._free @ state
        free = places - self._over * (self._free_curve @ state) + swings
        rate = self._free_rate[-1] @ state
        final = places[-1] + self._time * rate
        pull = self._zmp.T @ (wish - free) / ACCEPTED_ZMP_ERROR**2
        pull -= np.outer(self._rate[-1], rate) / ACCEPTED_END_SPEED**2
        regions = [*(room.inside for room in rooms), end.inside]
        knots = np.repeat(np.arange(len(regions)), [len(region.offsets) for region in regions])
        normals = np.concatenate([region.normals for region in regions])
        offsets = np.concatenate([region.offsets for region in regions])
        moves, unmoved = np.vstack([self._zmp, self._end]), np.vstack([free, final])
        linear = np.append(pull.T.ravel(), [0.0, 0.0])
        rows, bounds = _rows(normals, offsets, moves, unmoved, knots, EXCESS)
        A, b = [rows, self._no_less], [bounds, np.zeros(2)]
        x = self._optimum(linear, A, b)
        for _ in range(MAX_CUTS):
            planned = places + self._position @ x[:-2].reshape(2, -1).T
            beyond, normals, offsets = _stretched(rooms, planned, x[-1] + REACH_TOLERANCE)
            if not len(beyond):
                break
            rows, bounds = _rows(normals, offsets, self._position, places, beyond, STRETCH)
            A.append(rows)
            b.append(bounds)
            x = self._optimum(linear, A, b)
        return x[:-2].reshape(2, -1), float(x[-2])

    def _optimum(self, linear: Array, rows: Sequence[Array], bounds: Sequence[Array]) -> Array:
        """The least of ½ xᵀHx − linearᵀx with rows x >= bounds."""
        C, b = np.concatenate(rows).T, np.concatenate(bounds)
        return np.asarray(quadprog.solve_qp(self._inverse_factor, linear, C, b, 0, True)[0])

    def follow(self, jerk: Array) -> None:
        """Take up jerks (2, blocks) that were solved for the state of now."""
        self.jerk = jerk
        self.places = self._free @ np.stack([self.c, self.dc, self.ddc]) + self._position @ jerk.T

    def advance(self, period: float, since: float) -> None:
        """Go on by a period [s], that begins some time after the plan was made [s]."""
        jerk = self.jerk[:, min(int(since / KNOT_PERIOD + 1e-6), FINE_KNOTS - 1)]
        self.c = self.c + period * self.dc + 0.5 * period**2 * self.ddc + period**3 / 6.0 * jerk
        self.dc = self.dc + period * self.ddc + 0.5 * period**2 * jerk
        self.ddc = self.ddc + period * jerk


def first_knot_from(t: float) -> float:
    """The first time of the plans' knots that is not before a time [s]."""
    return KNOT_PERIOD * float(np.ceil(t / KNOT_PERIOD - 1e-6))


@compiled
def _rows(
    normals: Array, offsets: Array, moves: Array, unmoved: Array, knots: NDArray[np.int_], slack: int
) -> tuple[Array, Array]:
    """Rows (m, 2 blocks + 2) and bounds (m,), rows x >= bounds, that keep places inside edges, but for a slack.

    Args:
        normals, offsets: of the edges (m, 2), (m,).
        moves, unmoved: what jerks change of places (n, blocks), and where these are without (n, 2).
        knots: the place of each edge (m,).
        slack: number of the slack's column from the end.
    """
    count, size = len(offsets), moves.shape[1]
    rows, bounds = np.zeros((count, 2 * size + 2)), np.empty(count)
    for i in range(count):
        x, y, k = normals[i, 0], normals[i, 1], knots[i]
        for j in range(size):
            rows[i, j], rows[i, size + j] = -x * moves[k, j], -y * moves[k, j]
        rows[i, 2 * size + 2 - slack] = 1.0
        bounds[i] = x * unmoved[k, 0] + y * unmoved[k, 1] - offsets[i]
    return rows, bounds


def _stretched(rooms: Sequence[Room], places: Array, accepted: float) -> tuple[NDArray[np.int_], Array, Array]:
    """Edges of the legs' reach that a place of some (n, 2), one a room, is beyond by more than is accepted [m]: for all
    places in that room, their numbers (m,), the edges' normals (m, 2) and offsets (m,)."""
    numbers, normals, offsets = [np.zeros(0, int)], [np.zeros((0, 2))], [np.zeros(0)]
    for room in dict.fromkeys(rooms):
        at = np.flatnonzero([one is room for one in rooms])
        over = (places[at] @ room.reach.normals.T - room.reach.offsets).max(axis=0)
        for edge in np.flatnonzero(over > accepted):
            numbers.append(at)
            normals.append(np.tile(room.reach.normals[edge], (len(at), 1)))
            offsets.append(np.full(len(at), room.reach.offsets[edge]))
    return np.concatenate(numbers), np.concatenate(normals), np.concatenate(offsets)
