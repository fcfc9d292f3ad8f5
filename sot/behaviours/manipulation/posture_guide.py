"""The reference of the joints: a posture that some of them are kept in, while others go along with what holds them."""

import numpy as np

from sot.control.tick import Tick
from sot.smooth import minimum_jerk

Array = np.ndarray


class PostureGuide:
    """A posture; joints that yield have their present position for a reference, which leaves them to be damped.

    An arm whose hand stands on something is where hand and trunk have it. A posture of its own would press the hand
    along the surface, up to the friction's limit.

    Args:
        posture: Of all joints (na,) [rad].
    """

    def __init__(self, posture: Array) -> None:
        self._posture, self._shift = posture.copy(), np.zeros_like(posture)
        self._yields = np.zeros(len(posture), dtype=bool)
        self._now, self._start, self._fade = posture.copy(), 0.0, 1.0

    def let_yield(self, joints: Array) -> None:
        """Let joints of some numbers yield from now on."""
        self._yields[joints] = True

    def lead_back(self, joints: Array, t: float, fade: float) -> None:
        """Lead joints back into the posture within a time [s] from t on."""
        self._shift = self._remaining(t)
        self._shift[joints] = (self._now - self._posture)[joints]
        self._yields[joints], self._start, self._fade = False, t, fade

    def observe(self, tick: Tick) -> None:
        """Note where the joints are."""
        self._now = tick.q[7 : 7 + len(self._posture)].copy()

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations (na,) at a time [s]; it is led slowly, without feed-forward."""
        rest = np.zeros_like(self._posture)
        return np.where(self._yields, self._now, self._posture + self._remaining(t)), rest, rest

    def _remaining(self, t: float) -> Array:
        left: Array = self._shift * (1.0 - minimum_jerk(np.array((t - self._start) / self._fade)))
        return left
