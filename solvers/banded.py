"""A quadratic program over a whole trajectory, solved in time linear in its length.

A trajectory couples only neighbouring samples, so that its Hessian H and the normal matrix AᵀWA of its limits are
banded. A primal-dual interior point method then needs nothing but banded Cholesky factorisations.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.linalg.blas import dsbmv
from scipy.linalg.lapack import dpbtrf, dpbtrs
from scipy.sparse.csgraph import reverse_cuthill_mckee

Array = NDArray[np.float64]

STEP_SHARE_TO_BOUNDARY = 0.995  # share of the longest step that keeps slacks and multipliers positive
TYPICAL_MULTIPLIER = 100.0  # of a limit, for half the distance between its bounds as unit
VIOLATION_TOLERANCE = 1e-5  # largest violation of a limit, relative to half the distance between its bounds
GRADIENT_TOLERANCE = 1e-9  # gradient left, relative to its largest part
CURVATURE_ROUNDING = 1e-13  # rounding of the gradient, relative to the largest entry of the Hessian
BLOCKED_BAND = 65  # subdiagonals from which on LAPACK factorises in blocks
MIN_WIDENED_BAND = 48  # subdiagonals from which on its blocks are worth the zeros of a wider band


@dataclass(frozen=True)
class BandedSolution:
    """Answer x (n,), whether it is optimal, iterations (0: no limit was active) and the largest violation."""

    x: Array
    solved: bool
    iterations: int
    violation: float


class BandedQP:
    """min ½ xᵀH x + gᵀx  subject to  lower <= A x <= upper, with banded H and AᵀA.

    The structure of the limits is analysed once; `solve` may then be called with many H and g. The method is
    Mehrotra's predictor-corrector; where no limit is active, the unconstrained minimum is returned at once. Objectives
    should sum squares of errors, each divided by the error that is acceptable: TYPICAL_MULTIPLIER and the tolerance of
    `solve` assume it.
    """

    def __init__(self, A: sp.sparray, lower: Array, upper: Array, band: int):
        """
        Args:
            A: (m, n) sparse limits; two columns that share a row are at most `band` apart.
            lower, upper: (m,) bounds, infinite where there is none; every row needs lower < upper.
            band: number of subdiagonals of H.

        Raises:
            ValueError: a row with lower >= upper, or a row wider than the band.
        """
        if not np.all(lower < upper):
            raise ValueError("a limit leaves no room: every row needs lower < upper")
        A = sp.csr_array(A)
        above, below = np.isfinite(upper), np.isfinite(lower)
        self.n, self.band = A.shape[1], band
        room = 0.5 * (upper - lower)
        unit = np.where(np.isfinite(room), room, np.maximum(1.0, np.abs(np.where(above, upper, lower))))
        A = sp.diags_array(1.0 / unit) @ A  # slacks of the order of one, whatever the units of the rows
        self._row_units = np.concatenate([unit[above], unit[below]])
        self._G = sp.vstack([A[above], -A[below]], format="csr")  # every limit as a row of G x <= h
        self._G.sum_duplicates()  # and sorts the columns of each row
        self._h = np.concatenate([upper[above], -lower[below]]) / self._row_units
        self._Gt = self._G.T.tocsr()
        self._factor_band = BLOCKED_BAND if MIN_WIDENED_BAND <= band < BLOCKED_BAND else band
        self._normal_cells, self._weights_to_normal = _normal_matrix_map(self._G, band, self._factor_band)

    def solve(
        self,
        H: Array,
        g: Array,
        expansion_point: Array | None = None,
        first_multiplier: float = TYPICAL_MULTIPLIER,
        max_iterations: int = 60,
        tolerance: float = 1e-3,
    ) -> BandedSolution:
        """Minimise with the given Hessian and gradient.

        Args:
            H: (n, band + 1) lower diagonals of the positive definite Hessian, `H[j, i - j] = H_ij`.
            g: (n,) gradient at `expansion_point`.
            expansion_point: (n,) point about which the objective is expanded, zero unless given.
            first_multiplier: the limits' multipliers at the start, counted in half the distance between the bounds.
            max_iterations: most Newton steps.
            tolerance: of complementarity: the mean product of multiplier and distance to the bound, in the same unit.
        """
        G, Gt, normal_cells = self._G, self._Gt, self._normal_cells
        origin = np.zeros(self.n) if expansion_point is None else expansion_point
        h = self._h - G @ origin
        widened = np.zeros((self.n, self._factor_band + 1))
        widened[:, : self.band + 1] = H
        x = _cholesky_solve(_banded_cholesky(widened.copy()), -g)
        slack = h - G @ x
        if slack.size == 0 or slack.min() >= 0.0:
            return BandedSolution(origin + x, True, 0, 0.0)
        curvature_rounding = CURVATURE_ROUNDING * _max_abs(H)
        s, z = np.maximum(slack, 1.0), np.full(slack.size, first_multiplier)
        solved, iteration, normal = False, 0, np.empty_like(widened)
        while iteration < max_iterations:
            curvature = dsbmv(self.band, 1.0, H.T, x, lower=1)
            dual = curvature + g + Gt @ z
            gradient_tolerance = GRADIENT_TOLERANCE * (1.0 + max(_max_abs(g), _max_abs(curvature))) + curvature_rounding
            primal = h - G @ x - s
            gap = float(s @ z) / s.size
            solved = gap < tolerance and _max_abs(dual) < gradient_tolerance and _max_abs(primal) < VIOLATION_TOLERANCE
            if solved:
                break
            iteration += 1
            np.copyto(normal, widened)
            normal.ravel()[normal_cells] += self._weights_to_normal @ (z / s)
            factor = _banded_cholesky(normal)

            def newton(
                target: Array,
                factor: Array = factor,
                dual: Array = dual,
                primal: Array = primal,
                s: Array = s,
                z: Array = z,
            ) -> tuple[Array, Array, Array]:
                dx = _cholesky_solve(factor, Gt @ ((target + z * primal) / s) - dual)
                ds = primal - G @ dx
                return dx, ds, -(target + z * ds) / s

            _, ds, dz = newton(s * z)
            predicted_gap = float((s + _max_step(s, ds) * ds) @ (z + _max_step(z, dz) * dz)) / s.size
            dx, ds, dz = newton(s * z + ds * dz - (predicted_gap / gap) ** 3 * gap)
            step = min(1.0, STEP_SHARE_TO_BOUNDARY * min(_max_step(s, ds), _max_step(z, dz)))
            x, s, z = x + step * dx, s + step * ds, z + step * dz
        violation = float(max(0.0, (self._row_units * (G @ x - h)).max()))
        return BandedSolution(origin + x, solved, iteration, violation)


def sparse_qp(H: sp.sparray, A: sp.sparray, lower: Array, upper: Array, tolerance: float) -> BandedSolution:
    """Minimise ½ xᵀH x subject to lower <= A x <= upper, with the variables reordered so that the matrices are banded.

    Args:
        H: (n, n) sparse and positive definite.
        A: (m, n) sparse limits, of variables that are coupled along a line, if in no particular order.
        lower, upper: (m,) bounds, infinite where there is none.
        tolerance: see `BandedQP.solve`.
    """
    A, H = sp.csr_array(A), sp.csr_array(H)
    H.eliminate_zeros()
    pattern = sp.csr_array(abs(A).T @ abs(A) + abs(H))
    order = reverse_cuthill_mckee(pattern, symmetric_mode=True)
    place = np.argsort(order)
    coupled, entries = sp.coo_array(pattern), sp.coo_array(H)
    row, column = place[coupled.row], place[coupled.col]
    band = int(np.abs(row - column).max())
    row, column = place[entries.row], place[entries.col]
    below = row >= column
    diagonals = np.zeros((len(order), band + 1))
    diagonals[column[below], (row - column)[below]] = entries.data[below]
    qp = BandedQP(A[:, order], lower, upper, band)
    solution = qp.solve(diagonals, np.zeros(len(order)), tolerance=tolerance)
    return replace(solution, x=solution.x[place])


def _normal_matrix_map(G: sp.csr_array, band: int, stored: int) -> tuple[NDArray[np.int64], sp.csr_array]:
    """Cells where the lower diagonals of GᵀWG are not zero, of a flattened matrix of `stored` subdiagonals, and the
    linear map from row weights w to the values of these cells."""
    products, cells, rows = [], [], []
    counts = np.diff(G.indptr)
    for count in np.unique(counts[counts > 0]):
        row = np.flatnonzero(counts == count)
        entry = G.indptr[row][:, None] + np.arange(count)
        column, value = G.indices[entry], G.data[entry]
        for a in range(count):
            for b in range(a + 1):
                offset = column[:, a] - column[:, b]
                if offset.max() > band:
                    raise ValueError(f"a limit couples variables {offset.max()} apart, the band is {band}")
                products.append(value[:, a] * value[:, b])
                cells.append(column[:, b].astype(np.int64) * (stored + 1) + offset)
                rows.append(row)
    if not products:
        return np.zeros(0, np.int64), sp.csr_array((0, G.shape[0]))
    cell = np.concatenate(cells)
    used = np.zeros(G.shape[1] * (stored + 1), bool)
    used[cell] = True
    entries = np.concatenate(products), ((np.cumsum(used) - 1)[cell], np.concatenate(rows))
    return np.flatnonzero(used), sp.csr_array(entries, shape=(int(used.sum()), G.shape[0]))


def _banded_cholesky(H: Array) -> Array:
    """Banded Cholesky factor; overwrites H."""
    factor, info = dpbtrf(H.T, lower=1, overwrite_ab=1)
    if info:
        raise np.linalg.LinAlgError(f"H is not positive definite at variable {info}")
    return factor


def _cholesky_solve(factor: Array, b: Array) -> Array:
    return dpbtrs(factor, b, lower=1)[0]


def _max_step(value: Array, step: Array) -> float:
    """Largest multiple of the step, at most 1, for which a positive value stays non-negative."""
    return 1.0 / max(1.0, -float((step / value).min()))


def _max_abs(value: Array) -> float:
    return float(np.abs(value).max())
