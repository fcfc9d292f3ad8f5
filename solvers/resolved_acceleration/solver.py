"""Prioritised tasks by weighted, damped pseudo-inverses: Hammam (9)-(16), (34)-(42), Dariush (9), (10), Algorithm 1.

A level's answer minimises, in what the levels above leave,

    ‖A x − b‖² + λ² ‖x − ζ‖²_W,

with a damping λ, a weight matrix W that stands in for limits, and a preferred answer ζ. Of one level that is
``x = ζ + J† (b − J ζ)`` with J† of Hammam (10); of two, Hammam (34)-(39), and (32) with (42) where the projectors are
exact.

*Coordinates.* With the Cholesky factor L of W, in ``y = Lᵀ x``, all these inverses are ordinary damped ones.

*Projectors.* The papers build a level's null space of its damped inverse. ``I − J† J`` then is no projector: what lower
levels do leaks into those above, and ``N Ĵ† = Ĵ†``, on which Algorithm 1 rests, does not hold. Exact ones are an
orthonormal basis of the null space.

*One-sided penalties.* A weight that blocks a motion towards a limit and leaves the motion away from it free depends on
the answer. `Penalties` say so: those that the answer contradicts join W, and the levels are solved again.
"""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import lapack

from solvers.nullspace import factorize_rows
from solvers.resolved_acceleration.inverse import damped_inverse, damped_least_squares
from solvers.resolved_acceleration.penalties import Penalties
from solvers.rows import Array, Level, LevelResult, Solution, Status

MAX_PASSES = 12
"""Bound of the solutions with other one-sided penalties; from half of it on, none that was active is left out."""


class ResolvedAcceleration:
    """Solver of equality levels by weighted damped inverses; no limits but what the weights make of them.

    Level 0's equalities are the first priority. It refuses inequalities, which it could not keep.

    Args:
        damping: λ of each level that has rows, in order; the last one counts for all that follow.
        exact_projectors: Whether a level's null space is exact, or built of its damped inverse, as in the papers.
        rank_tolerance: Directions in which a level's rows, in the weighted coordinates and relative to their largest,
            are shorter than this are left to the levels below.

    Attributes:
        weight: W, positive definite, shape (n, n); the identity if None.
        preferred: ζ, shape (n,); zero if None.
        penalties: One-sided ones, or None.
    """

    name = "crac"

    def __init__(
        self, damping: Sequence[float] = (0.1,), exact_projectors: bool = True, rank_tolerance: float = 1e-7
    ) -> None:
        self.damping, self.exact_projectors, self.rank_tolerance = tuple(damping), exact_projectors, rank_tolerance
        self.weight: Array | None = None
        self.preferred: Array | None = None
        self.penalties: Penalties | None = None
        self._last: Array | None = None

    def solve(self, levels: Sequence[Level]) -> Solution:
        """Solve the hierarchy.

        Raises:
            ValueError: A level has inequalities.
        """
        for level in levels:
            if len(level.lower):
                raise ValueError(
                    f"{level.name}: resolved acceleration knows no inequalities, weights stand in for them"
                )
        size, tasks = levels[0].size, [level for level in levels if len(level.b)]
        weight = np.eye(size) if self.weight is None else self.weight
        preferred = np.zeros(size) if self.preferred is None else self.preferred
        x = self._solve_one_sided(tasks, weight, preferred)
        return Solution(x, [LevelResult(level, x, False, 0.0, Status.SOLVED) for level in levels], Status.SOLVED)

    def _solve_one_sided(self, tasks: Sequence[Level], weight: Array, preferred: Array) -> Array:
        """The answer with the one-sided penalties that it exceeds; the last answer says which are tried first."""
        penalties = self.penalties
        if penalties is None or not len(penalties.weights):
            return self._solve_weighted(tasks, weight, preferred)
        guess = preferred if self._last is None or len(self._last) != len(preferred) else self._last
        active, pull = penalties.exceeded(guess), weight @ preferred
        for left in range(MAX_PASSES - 1, -1, -1):
            C, w = penalties.C[active], penalties.weights[active]
            penalised = weight + (C.T * w) @ C
            target = pull + C.T @ (w * penalties.targets[active])
            x = self._solve_weighted(
                tasks, penalised, np.linalg.solve(penalised, target) if target.any() else preferred
            )
            exceeded = penalties.exceeded(x)
            if left < MAX_PASSES // 2:
                exceeded |= active
            if (exceeded == active).all():
                break
            active = exceeded
        self._last = x
        return x

    def _solve_weighted(self, tasks: Sequence[Level], weight: Array, preferred: Array) -> Array:
        """The answer in the norm of one weight."""
        L = np.linalg.cholesky(weight)
        y, basis, lift = L.T @ preferred, None, None
        for k, task in enumerate(tasks):
            damping = self.damping[min(k, len(self.damping) - 1)]
            J = lapack.dtrtrs(L, task.A.T, lower=1)[0].T
            free = J if basis is None else J @ basis
            step = damped_least_squares(free, task.b - J @ y, damping)
            y = y + (step if lift is None else lift @ step)
            if k + 1 == len(tasks):
                break
            if self.exact_projectors:
                factors = factorize_rows(free, self.rank_tolerance * float(np.abs(J).max(initial=0.0)))
                basis = lift = factors.remaining_basis(np.eye(len(y), order="F") if basis is None else basis)
            else:
                projector = np.eye(len(y)) - damped_inverse(free, damping) @ free
                basis = projector if basis is None else basis @ projector
        return lapack.dtrtrs(L, y, lower=1, trans=1)[0]
