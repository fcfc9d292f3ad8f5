"""Angular momentum about the centre of mass."""

from collections.abc import Callable

import numpy as np

from solvers.rows import Rows
from sot.control.task import Task
from sot.control.tick import Tick

Array = np.ndarray
MomentumReference = Callable[[float], tuple[Array, Array]]


class AngularMomentum(Task):
    """``L̇ = L̇_ref + k (L_ref − L)``: the whole body's spin follows a reference, or is damped where there is none.

    Args:
        reference: ``t -> (L, L̇)``, shapes (3,), world axes [N m s, N m].
        k: Gain [1/s].
        weight: Scale within the level.
    """

    def __init__(
        self,
        reference: MomentumReference | None = None,
        k: float = 5.0,
        weight: float = 1.0,
        name: str = "AngularMomentum",
    ) -> None:
        super().__init__(name, "N m", "N m s", weight)
        self.labels = "xyz"
        self.k = k
        self.reference = reference

    @property
    def reference(self) -> MomentumReference:
        """Momentum that is followed; may be replaced, None to damp it, and acts at once."""
        return self._reference

    @reference.setter
    def reference(self, reference: MomentumReference | None) -> None:
        still = np.zeros(3)
        self._reference = reference or (lambda t: (still, still))

    def rows(self, tick: Tick) -> Rows:
        """Rows ``A_L v̇ = L̇ − Ȧ_L v``."""
        momentum, matrix, drift = tick.centroidal()
        wanted, rate = self._reference(tick.t)
        self.error = wanted - momentum[3:]
        target = rate + self.k * self.error - drift[3:]
        return self.make_rows(matrix[3:], target, target)
