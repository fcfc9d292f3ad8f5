"""A solver that merges all levels below level 0 into one weighted level, behind the same interface."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from solvers.cascade import Cascade
from solvers.rows import Level, Solution


class Weighted:
    """Keeps level 0 hard and solves all others as one least-squares problem; each counts `ratio` times the next.

    Args:
        ratio: Weight of a level's squared violation over that of the level below.
        damping: As for `Cascade`.
    """

    name = "weighted"

    def __init__(self, ratio: float = 10.0, damping: float = 0.0) -> None:
        self.ratio = ratio
        self._cascade = Cascade(damping=damping)

    def solve(self, levels: Sequence[Level]) -> Solution:
        """Solve the hierarchy; results are given per level, as by the cascade."""
        soft = levels[1:]
        weights = [np.sqrt(self.ratio) ** (len(soft) - 1 - k) for k in range(len(soft))]
        merged = Level(
            "weighted",
            levels[0].size,
            [
                replace(e, scale=w * e.scale, b=w * e.b)
                for w, level in zip(weights, soft, strict=True)
                for e in level.equalities
            ],
            np.vstack([w * level.C for w, level in zip(weights, soft, strict=True)]),
            np.concatenate([w * level.lower for w, level in zip(weights, soft, strict=True)]),
            np.concatenate([w * level.upper for w, level in zip(weights, soft, strict=True)]),
        )
        answer = self._cascade.solve([levels[0], merged])
        first, last = answer.levels
        shared = [replace(last, level=level) for level in soft]
        return Solution(answer.x, [first, *shared], answer.status, answer.relaxed)
