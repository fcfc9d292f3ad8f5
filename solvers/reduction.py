"""A change of variables that eliminates the equalities of level 0.

Rows of a controller's level 0 come as ``[J 0; P R]``: the leading variables x_1 (accelerations) have rows of their own,
and the trailing ones x_2 (contact forces) can answer whatever the coupled rows ask for, R being of full row rank. Then

    x_1 = N u + s,    x_2 = Φ u + K w + φ,

with N and K orthonormal bases of the null spaces of J and R, satisfies them for every z = (u, w), and nothing else
does.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.nullspace import factorize_rows
from solvers.rows import Array, Equality, Level


def leading_count(levels: Sequence[Level]) -> int:
    """Number of leading variables: the fewest columns that the rows of any level use."""
    first = levels[0]
    return min((e.A.shape[1] for level in levels for e in level.equalities if not e.start), default=first.size)


def stacked_equalities(equalities: Sequence[Equality], start: int, size: int) -> Array:
    """The equalities as one matrix on the variables from `start` on, shape (rows, size - start)."""
    out = np.zeros((sum(len(e.b) for e in equalities), size - start))
    row = 0
    for e in equalities:
        end, skipped = e.start + e.A.shape[1], max(start - e.start, 0)
        if end > start:
            out[row : row + len(e.b), max(e.start - start, 0) : end - start] = e.scale * e.A[:, skipped:]
        row += len(e.b)
    return out


@dataclass(slots=True)
class Reduction:
    """The change of variables ``x = T z + origin``.

    Args:
        T: Shape (n, nz).
        origin: Shape (n,).
        leading: Number of leading variables x_1.
        free: Number of variables u that are left of them.
    """

    T: Array
    origin: Array
    leading: int
    free: int

    @classmethod
    def of(cls, hard: Level, leading: int, tolerance: float) -> "Reduction | None":
        """Solve the equalities of `hard`; None if they contradict each other or are not of that structure."""
        own = [e for e in hard.equalities if e.start + e.A.shape[1] <= leading]
        coupled = [e for e in hard.equalities if e.start + e.A.shape[1] > leading]
        J, wanted = stacked_equalities(own, 0, leading), np.concatenate([np.zeros(0), *(e.b for e in own)])
        contact = factorize_rows(J, tolerance * max(1.0, float(np.abs(J).max(initial=0.0))))
        start = contact.least_squares(wanted)
        if contact.rank < len(wanted) and np.abs(J @ start - wanted).max() > tolerance * (1.0 + np.abs(wanted).max()):
            return None
        N = contact.remaining_basis(np.eye(leading, order="F"))
        rows = stacked_equalities(coupled, 0, hard.size)
        P, R = rows[:, :leading], rows[:, leading:]
        bearing = factorize_rows(R, tolerance)
        if bearing.rank < len(rows):
            return None
        free, others = N.shape[1], hard.size - leading
        K = bearing.remaining_basis(np.eye(others, order="F"))
        T = np.zeros((hard.size, free + K.shape[1]))
        origin = np.zeros(hard.size)
        T[:leading, :free], T[leading:, free:], origin[:leading] = N, K, start
        if len(rows):
            needed = np.empty((len(rows), free + 1))
            needed[:, :free] = -P @ N
            needed[:, free] = np.concatenate([e.b for e in coupled]) - P @ start
            borne = bearing.least_norm(needed)
            T[leading:, :free], origin[leading:] = borne[:, :free], borne[:, free]
        return cls(T, origin, leading, free)

    def reduced_levels(self, levels: Sequence[Level]) -> list[Level]:
        """The same levels in z; level 0 has no equalities any more."""
        return [self._level(level, hard=not k) for k, level in enumerate(levels)]

    def full_solution(self, z: Array) -> Array:
        """The solution x in the original variables, ``T z + origin``."""
        return self.T @ z + self.origin

    def _level(self, level: Level, hard: bool) -> Level:
        equalities = [] if hard else [self._equality(e) for e in level.equalities]
        if not len(level.lower):
            C, shift = np.zeros((0, self.T.shape[1])), np.zeros(0)
        else:
            C, shift = level.C @ self.T, level.C @ self.origin
        blocks = [block for block in level.blocks if not (hard and block.equality)]
        return Level(level.name, self.T.shape[1], equalities, C, level.lower - shift, level.upper - shift, blocks)

    def _equality(self, e: Equality) -> Equality:
        end = e.start + e.A.shape[1]
        columns = self.free if end <= self.leading else self.T.shape[1]
        return Equality(e.product(self.T[e.start : end, :columns]), e.b - e.product(self.origin[e.start : end]))
