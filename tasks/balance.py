"""The centre of mass kept where the feet can hold it, by its divergent component."""

from collections.abc import Callable

import numpy as np

from solvers.rows import Rows
from sot.polygon import Polygon
from sot.task import Task
from sot.tick import GRAVITY, Tick

Array = np.ndarray
BalanceReference = Callable[[float], tuple[Array, Array, Array, Array]]


class Balance(Task):
    """Centre of mass on a plan (c, ċ, c̈, z): horizontally through its divergent component, vertically as a spring.

    Of an inverted pendulum only ``ξ = c + ċ/ω`` diverges, ``ξ̇ = ω (ξ − z)``. Commanding the zero-moment point

        z* = z_ref + (1 + k/ω) (ξ − ξ_ref),   brought back into the support polygon,
        c̈* = c̈_ref + ω² ((c − c_ref) − (z* − z_ref))

    lets ξ converge at the rate k, and asks for no pressure that the feet cannot give; ω² = g / c_z. What the plan
    knows of angular momentum is in c̈_ref and z_ref.

    Args:
        reference: ``t -> (c, ċ, c̈, z)``, shapes (3,), (3,), (3,), (2,), world.
        k: Rate at which the divergent component converges [1/s].
        kp: Stiffness of the height [1/s²], critically damped.
        margin: Distance kept from the edges of the support polygon [m].
        weight: Scale within the level.
    """

    def __init__(
        self, reference: BalanceReference, k: float = 4.0, kp: float = 100.0, margin: float = 0.002, weight: float = 1.0
    ) -> None:
        super().__init__("Balance", "m/s²", "m", weight)
        self._reference = reference
        self.k, self.kp, self.margin = k, kp, margin
        self._polygon: Polygon | None = None
        self._corners = np.zeros((0, 2))

    def rows(self, tick: Tick) -> Rows:
        """Rows ``J_c v̇ = c̈* − J̇_c v``."""
        c, velocity, acceleration, z = self._reference(tick.t)
        self.error = c - tick.com
        rate = velocity - tick.com_velocity
        omega = float(np.sqrt(GRAVITY / max(tick.com[2], 0.1)))
        wanted = acceleration + self.kp * self.error + 2.0 * np.sqrt(self.kp) * rate
        offset, offset_rate = -self.error[:2], -rate[:2]
        pressure = z + (1.0 + self.k / omega) * (offset + offset_rate / omega)
        polygon = self._support(tick)
        if polygon is not None:
            pressure = polygon.nearest(pressure)
        wanted[:2] = acceleration[:2] + omega**2 * (offset - (pressure - z))
        target = wanted - tick.com_drift
        return self._rows(tick.com_jacobian, target, target)

    def _support(self, tick: Tick) -> Polygon | None:
        """Support polygon of the contacts that carry, drawn in by the margin; none if nothing does."""
        corners = [
            (frame := tick.frame(contact.point)).position[:2] + (contact.vertices @ frame.rotation.T)[:, :2]
            for contact in tick.contacts
            if contact.mode == "fixed" and contact.load >= 1.0
        ]
        if not corners:
            return None
        points = np.concatenate(corners)
        # Standing feet creep by fractions of a millimetre: no reason for another hull.
        if points.shape != self._corners.shape or np.abs(points - self._corners).max() > 5e-4:
            self._corners = points
            self._polygon = Polygon.hull(points).shrunk(self.margin, self.margin)
        return self._polygon
