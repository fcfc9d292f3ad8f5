"""Penalties that count on one side only."""

from dataclasses import dataclass

from solvers.rows import Array


@dataclass(frozen=True)
class Penalties:
    """One-sided quadratic penalties ``λ² w (c x − t)²`` where ``c x > t``.

    Args:
        C: Rows c, shape (k, n).
        targets: t, shape (k,).
        weights: w, not negative, shape (k,).
    """

    C: Array
    targets: Array
    weights: Array

    def exceeded(self, x: Array) -> Array:
        """Which of them count at x, shape (k,)."""
        flags: Array = self.C @ x > self.targets
        return flags
