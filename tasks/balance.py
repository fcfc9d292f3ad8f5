"""The centre of mass kept where the feet can hold it, by its divergent component."""

from collections.abc import Callable, Mapping
from typing import Literal

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Rows
from sot.polygon import ANYWHERE, Polygon, nearest
from sot.task import Task
from sot.tick import GRAVITY, Tick

Array = np.ndarray
PlaceReference = Callable[[float], Array]
BalanceReference = Callable[[float], tuple[Array, Array, Array, Array]]

LOOK = 0.01
"""Interval at which it is looked where the contacts are [s]; at once if one of them carries more or less."""


class Balance(Task):
    """Centre of mass on a plan (c, ċ, c̈, z): horizontally through its divergent component, vertically as a spring.

    Of an inverted pendulum only ``ξ = c + ċ/ω`` diverges, ``ξ̇ = ω (ξ − z)``. Commanding the zero-moment point

        z* = z_ref + (1 + k/ω) (ξ − ξ_ref),   brought back into the support polygon,
        c̈* = c̈_ref + ω² ((c − c_ref) − (z* − z_ref))

    lets ξ converge at the rate k, and asks for no pressure that the feet cannot give; ω² = g / c_z. What the plan
    knows of angular momentum is in c̈_ref and z_ref, and is given up where it leaves too little room to recover.

    Args:
        reference: ``t -> (c, ċ, c̈, z)``, shapes (3,), (3,), (3,), (2,), world.
        feet: Where the plan has the contacts, ``t -> place`` (3,). Feet creep and land beside their place, and a plan
            that did not follow them would lead over their edge: c and z are meant relative to the feet that stand.
        k: Rate at which the divergent component converges [1/s].
        kp: Stiffness of the height [1/s²], critically damped.
        margin: Distance kept from the edges of the support polygon [m].
        axes: "xyz", or "xy" to leave the height to what is below.
        weight: Scale within the level.
    """

    def __init__(
        self,
        reference: BalanceReference,
        feet: Mapping[str, PlaceReference] | None = None,
        k: float = 4.0,
        kp: float = 100.0,
        margin: float = 0.001,
        axes: Literal["xyz", "xy"] = "xyz",
        weight: float = 1.0,
    ) -> None:
        super().__init__("Balance", "m/s²", "m", weight)
        self.labels = axes
        self._of = slice(len(axes))
        self._reference = reference
        self._feet = dict(feet or {})
        self.k, self.kp, self.margin = k, kp, margin
        self._polygon, self._crept = ANYWHERE, (0.0, 0.0)
        self._loads, self._looked = [-1.0], -np.inf

    def rows(self, tick: Tick) -> Rows:
        """Rows ``J_c v̇ = c̈* − J̇_c v``."""
        self._look(tick)
        plan, state = self._reference(tick.t), (tick.com, tick.com_velocity, tick.com_drift)
        polygon, of = self._polygon, self._of
        error, wanted = _led_back(*plan, *state, self._crept, self.k, self.kp, polygon.normals, polygon.offsets)
        self.error = error[of]
        return self._rows(tick.com_jacobian[of], wanted[of], wanted[of])

    def _look(self, tick: Tick) -> None:
        """See where the contacts are: standing feet creep by fractions of a millimetre, which can wait a few ticks."""
        loads = [contact.load if contact.mode == "fixed" else 0.0 for contact in tick.contacts]
        if loads != self._loads or not 0.0 < tick.t - self._looked < LOOK:
            self._polygon, self._crept = self._carried(tick), self._moved(tick)
            self._loads, self._looked = loads, tick.t

    def _moved(self, tick: Tick) -> tuple[float, float]:
        """How far the contacts that stand are from where the plan has them [m], on average, by the load they may take:
        where a foot comes down beside its place, the plan is to move over as gradually as it takes its load."""
        x = y = weight = 0.0
        for contact in tick.contacts:
            if contact.mode == "fixed" and contact.point in self._feet:
                at_x, at_y, _ = tick.frame(contact.point).position.tolist()
                place_x, place_y, _ = self._feet[contact.point](tick.t).tolist()
                x, y = x + contact.load * (at_x - place_x), y + contact.load * (at_y - place_y)
                weight += contact.load
        return (x / weight, y / weight) if weight else (0.0, 0.0)

    def _carried(self, tick: Tick) -> Polygon:
        """Where the contacts let the zero-moment point be, drawn in by the margin; anywhere if nothing carries.

        A contact in a ramp widens the support of the others by as much as it may bear: no jump when the ramp ends.
        """
        standing = [contact for contact in tick.contacts if contact.mode == "fixed" and contact.load > 0.0]
        if not standing:
            return ANYWHERE
        frames = [tick.frame(contact.point) for contact in standing]
        soles = [
            frame.position[:2] + (contact.vertices @ frame.rotation.T)[:, :2]
            for contact, frame in zip(standing, frames, strict=True)
        ]
        most = max(contact.load for contact in standing)
        full = np.concatenate([sole for sole, contact in zip(soles, standing, strict=True) if contact.load == most])
        corners = [full]
        for sole, contact in zip(soles, standing, strict=True):
            if contact.load < most:
                share = min(contact.largest(1.0), 1.0)
                corners.append(((1.0 - share) * full[:, None] + share * sole).reshape(-1, 2))
        return Polygon.hull(np.concatenate(corners)).inset(self.margin)


@compiled
def _led_back(
    c: Array,
    velocity: Array,
    acceleration: Array,
    z: Array,
    com: Array,
    com_velocity: Array,
    com_drift: Array,
    crept: tuple[float, float],
    k: float,
    kp: float,
    normals: Array,
    offsets: Array,
) -> tuple[Array, Array]:
    """The error c − com of a plan that creeps with the feet, and the wanted acceleration less its drift, (3,) each."""
    error, rate, wanted = c - com, velocity - com_velocity, acceleration - com_drift
    z = z.copy()
    for i in range(2):
        error[i] += crept[i]
        z[i] += crept[i]
    omega = np.sqrt(GRAVITY / max(com[2], 0.1))
    # The deviation from the plan, and the zero-moment point's lag that leads the divergent component back.
    lag = -(1.0 + k / omega) * (error[:2] + rate[:2] / omega)
    pivot = c[:2] - acceleration[:2] * c[2] / (GRAVITY + acceleration[2])
    lag = _admitted(lag, z, pivot, normals, offsets)
    for i in range(2):
        wanted[i] -= omega**2 * (error[i] + lag[i])
    wanted[2] += kp * error[2] + 2.0 * np.sqrt(kp) * rate[2]
    return error, wanted


@compiled
def _admitted(lag: Array, z: Array, pivot: Array, normals: Array, offsets: Array) -> Array:
    """As much of a wanted lag of the zero-moment point (2,) [m] as the support polygon admits.

    The plan's zero-moment point z differs from its pivot, the point that the floor's force on the centre of mass comes
    from, by what its angular momentum changes. When that leaves too little room, the change is given up: then the
    pivot alone has to stay inside.
    """
    kept, given_up = nearest(normals, offsets, z + lag) - z - lag, nearest(normals, offsets, pivot + lag) - pivot - lag
    return lag + (kept if kept @ kept <= given_up @ given_up else given_up)
