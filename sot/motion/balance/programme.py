"""A CoM motion that keeps the ZMP inside the support polygon: one sparse convex programme for a whole clip.

With the height of the CoM and the angular momentum L about it given, the ZMP is linear in the horizontal CoM:
    z_x = c_x − h c̈_x − L̇_y / (m (g + c̈_z)),   z_y = c_y − h c̈_y + L̇_x / (m (g + c̈_z)),   h = c_z / (g + c̈_z).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.linalg.blas import dsbmv

from solvers.banded import BandedQP
from sot.motion.balance.centroidal import Centroidal
from sot.motion.body.spline import ACCELERATION_STENCIL, JERK_STENCIL, VALUE_STENCIL, Spline
from sot.motion.feet.support import Support

Array = NDArray[np.float64]

ACCEPTED_COM_ERROR = 0.02  # m, from the wanted CoM: costs as much as ACCEPTED_JERK
ACCEPTED_JERK = 20.0  # m/s³, of the CoM
EXCURSION_PRICE = 1e5  # 1/m, of the ZMP out of the inset: only if it must
HELD_END_WEIGHT = 1e12  # holds the CoM at rest at both ends


@dataclass(frozen=True)
class BalancePlan:
    """Horizontal CoM as a spline (2), its ZMP (T, 2) at the knots, and the largest excursion out of the inset [m]."""

    com: Spline
    zmp: Array
    excursion: float


def plan_balance(
    motion: Centroidal,
    wanted: Array,
    supports: Sequence[Support],
    period: float,
    start: float = 0.0,
    held: Spline | None = None,
) -> BalancePlan:
    """The CoM nearest to the wanted one whose ZMP stays in the inset of what supports it.

    Where no such CoM exists, the ZMP leaves the inset by the least (an exact penalty). It starts and ends at rest,
    where the wanted CoM starts and over the middle of the support, unless its ends are given.

    Args:
        motion: the whole body's at T knots, of which height and angular momentum are kept.
        wanted: (T, 2) horizontal CoM to stay near to [m].
        supports: in order of time.
        period: time between knots [s].
        start: of the first knot [s].
        held: a CoM whose first and last three control points are kept.
    """
    length = len(wanted)
    times = start + period * np.arange(length)
    until = [*(support.start for support in supports[1:]), np.inf]
    height, offset = motion.pendulum()

    # variables of a knot: its control point's x and y, and the excursion of the ZMP; a row for each edge at each knot
    n = 3 * (length + 2)
    rows = []
    for support, stop in zip(supports, until, strict=True):
        # where supports meet, both count: between two knots the ZMP runs straight
        knots = np.flatnonzero((times > support.start - period + 1e-9) & (times < stop + period - 1e-9))
        normals, offsets = support.inset.normals, support.inset.offsets
        rows.append((np.repeat(knots, len(offsets)), np.tile(normals, (len(knots), 1)), np.tile(offsets, len(knots))))
    knot, normal, edge = (np.concatenate(part) for part in zip(*rows, strict=True))
    stencil = VALUE_STENCIL - height[knot, None] * ACCELERATION_STENCIL / period**2
    values = np.column_stack([(stencil[:, :, None] * normal[:, None]).reshape(-1, 6), -np.ones(len(knot))])
    columns = 3 * knot[:, None] + [0, 1, 3, 4, 6, 7, 5]
    zmp_rows = sp.csr_array((values.ravel(), columns.ravel(), 7 * np.arange(len(knot) + 1)), shape=(len(knot), n))
    excursions = sp.csr_array((np.ones(length + 2), (np.arange(length + 2), np.arange(2, n, 3))), shape=(length + 2, n))
    A = sp.vstack([zmp_rows, excursions], format="csr")
    lower = np.concatenate([np.full(len(knot), -np.inf), np.zeros(length + 2)])
    upper = np.concatenate([edge - np.sum(offset[knot] * normal, axis=1), np.full(length + 2, np.inf)])

    first, last = (wanted[0], supports[-1].polygon.centre) if held is None else (held.control[:3], held.control[-3:])
    around = np.zeros((length + 2, 3))
    around[1:-1, :2], around[:3, :2], around[-3:, :2] = wanted, first, last
    H, g = _objective(wanted, period)
    g += dsbmv(H.shape[1] - 1, 1.0, H.T, around.ravel(), lower=1)
    H.reshape(-1, 3, 10)[[0, 1, 2, -3, -2, -1], :2, 0] += HELD_END_WEIGHT
    solution = BandedQP(A, lower, upper, band=H.shape[1] - 1).solve(H, g, around.ravel(), EXCURSION_PRICE)
    control = solution.x.reshape(-1, 3)
    com = Spline(control[:, :2].copy(), period)
    zmp = com.knots - height[:, None] * com.accelerations + offset
    return BalancePlan(com, zmp, float(control[:, 2].max()))


def _objective(target: Array, period: float) -> tuple[Array, Array]:
    """Banded Hessian (n, 10) and gradient at zero (n,) over (x, y, excursion) of every control point."""
    length = len(target)
    H = np.zeros((length + 2, 3, 10))
    g = np.zeros((length + 2, 3))
    jerk = JERK_STENCIL / (period**3 * ACCEPTED_JERK)
    value = VALUE_STENCIL / ACCEPTED_COM_ERROR
    for i in range(3):
        g[i : i + length, :2] -= value[i] * target / ACCEPTED_COM_ERROR
        for apart in range(3 - i):
            H[i : i + length, :2, 3 * apart] += value[i] * value[i + apart]
    for i in range(4):
        for apart in range(4 - i):
            H[i : i + length - 1, :2, 3 * apart] += jerk[i] * jerk[i + apart]
    H[:, 2, 0] = 1.0
    g[:, 2] = EXCURSION_PRICE
    return H.reshape(-1, 10), g.ravel()
