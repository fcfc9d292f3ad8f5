"""The centre of mass kept where the feet can hold it, by its divergent component."""

from collections.abc import Callable, Mapping
from typing import Literal

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Rows
from sot.behaviours.displacement import Displacement
from sot.behaviours.support_height import MIN_PENDULUM_HEIGHT, support_height
from sot.control.task import Task
from sot.control.tick import Tick, TickContact, momentum_excess_per_weight
from sot.gravity import GRAVITY
from sot.polygon import WHOLE_FLOOR, Polygon, nearest_point
from sot.static_region import Patch, static_region

Array = np.ndarray
PlaceReference = Callable[[float], Array]
MomentumReference = Callable[[float], Array]
BalanceReference = Callable[[float], tuple[Array, Array, Array, Array]]

CATCHING_MARGIN = 0.009
"""Increase of the support margin while one foot makes a step of recovery [m]: on its very edge, the other foot has no
friction left to turn with."""
REGION_CREEP = 0.005
"""Distance by which contacts may have moved since the static region was computed [m]."""
SUPPORT_UPDATE_INTERVAL = 0.01
"""Interval at which the support polygon is computed anew [s]; at once if the load ramp of a contact changes."""


class Balance(Task):
    """Centre of mass on a plan (c, ċ, c̈, z): horizontally through its divergent component, vertically as a spring.

    Of an inverted pendulum only ``ξ = c + ċ/ω`` diverges, ``ξ̇ = ω (ξ − z)``. Commanding the zero-moment point

        z* = z_ref + (1 + k/ω) (ξ − ξ_ref),   brought back into the support polygon,
        c̈* = c̈_ref + ω² ((c − c_ref) − (z* − z_ref))

    lets ξ converge at the rate k, and asks for no pressure that the feet cannot give; ω² = g / c_z, where heights count
    from what the feet stand on. What the plan knows of angular momentum is in c̈_ref and z_ref, and is given up where it
    leaves too little room to recover. What the body has beyond the plan, ΔL, has to go as well: at the rate ω + k that
    takes the zero-moment point (ω + k) / (m g) (ΔL_y, −ΔL_x) away from z*, and that, too, is to be inside.

    Where hands stand on the world as well, no polygon of soles says where the zero-moment point may be. The static
    region takes its place: where the centre of mass can rest by friction and bounds of all contacts that carry
    (`static_region`). Level 0 spreads the forces. It takes a tenth of a second, once for each set of contacts and their
    places.

    While a foot makes a step that was not planned (its contact is off and has a `path`), the other one alone does not
    lead ξ back, the step does. The zero-moment point itself is then commanded to z*, and the centre of mass is left to
    how the posture brings the body upright:

        c_z c̈ + (L̇_y, −L̇_x) / m = (g + c̈_z) (c − z*).

    Args:
        reference: ``t -> (c, ċ, c̈, z)``, shapes (3,), (3,), (3,), (2,), world.
        feet: Where the plan has the contacts, ``t -> place`` (3,). Feet creep and land beside their place, and a plan
            that did not follow them would lead over their edge: c and z are meant relative to the feet that stand.
        momentum: Angular momentum of the plan, ``t -> L`` (3,), world axes [N m s]; unless given, none is too much.
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
        momentum: MomentumReference | None = None,
        k: float = 4.0,
        kp: float = 100.0,
        margin: float = 0.001,
        axes: Literal["xyz", "xy"] = "xyz",
        weight: float = 1.0,
    ) -> None:
        super().__init__("Balance", "m/s²", "m", weight)
        self.labels = axes
        self._axes = slice(len(axes))
        self.reference = reference
        """Plan that the centre of mass follows; may be replaced, and acts at once."""
        self._feet = dict(feet or {})
        self._momentum = momentum
        self.k, self.kp, self.margin = k, kp, margin
        self._polygon, self._displacement = WHOLE_FLOOR, Displacement.of(())
        self._ramps, self._updated_at, self._ground = [-1.0], -np.inf, 0.0
        self._regions: dict[tuple[tuple[str, str], ...], tuple[Array, Polygon]] = {}
        """By the contacts that carry and what they are on: their places then (n, 3), and the static region."""

    def rows(self, tick: Tick) -> Rows:
        """Rows ``J_c v̇ = c̈* − J̇_c v``."""
        self._update_support(tick)
        plan, state = self.reference(tick.t), (tick.com, tick.com_velocity, tick.com_drift)
        polygon, of = self._polygon, self._axes
        momentum = tick.momentum
        planned_turn = momentum[3:] if self._momentum is None else self._momentum(tick.t)
        catching = any(c.mode == "off" and c.is_catching and _is_foot(tick, c) for c in tick.contacts)
        if catching:
            polygon = polygon.inset(CATCHING_MARGIN)
        error, wanted, z = _wanted_acceleration_and_zmp(
            *(*plan, *state, *self._displacement, momentum, planned_turn, tick.mass * GRAVITY),
            *(self._ground, self.k, self.kp, polygon.normals, polygon.offsets),
        )
        self.error, J = error[of], tick.com_jacobian
        if catching:
            J, wanted = _zmp_rows(tick, z, wanted, self._ground)
        wanted = wanted[of]
        return self.make_rows(J[of], wanted, wanted)

    def _update_support(self, tick: Tick) -> None:
        """Compute support polygon and displacement anew if due: standing feet creep by little."""
        footings = [contact for contact in tick.contacts if contact.is_footing]
        loads = [contact.load if contact.mode == "fixed" else 0.0 for contact in footings]
        loads += [contact.heel_load for contact in footings]
        if loads != self._ramps or not 0.0 < tick.t - self._updated_at < SUPPORT_UPDATE_INTERVAL:
            self._polygon, self._displacement = self._support_polygon(tick), self._plan_displacement(tick)
            self._ground = support_height(tick)
            self._ramps, self._updated_at = loads, tick.t

    def _plan_displacement(self, tick: Tick) -> Displacement:
        """Displacement of the standing feet from their planned places, weighted by the load that they may take: where a
        foot lands beside its place, the plan moves over as gradually as the foot takes its load."""
        standing = [contact for contact in _standing_feet(tick) if not contact.is_rolling]
        return Displacement.of(
            [
                (_planned_place(contact, self._feet, tick.t)[:2], tick.frame(contact.point).position[:2], contact.load)
                for contact in standing
                if contact.point in self._feet
            ]
        )

    def _support_polygon(self, tick: Tick) -> Polygon:
        """Support polygon of the contacts, inset by the margin; the whole plane if nothing carries.

        A contact in its load ramp widens the support of the others by as much as it may bear: no jump at its end.
        """
        standing = _standing_feet(tick)
        if not standing:
            return WHOLE_FLOOR
        others = [c for c in tick.contacts if c.mode == "fixed" and c.is_footing and not _is_foot(tick, c)]
        if any(contact.load >= 1.0 for contact in others):
            return self._static_region(tick).inset(self.margin)
        soles = [tick.frame(contact.point).floor_projection(contact.bearing_vertices) for contact in standing]
        most = max(contact.load for contact in standing)
        full = np.concatenate([sole for sole, contact in zip(soles, standing, strict=True) if contact.load == most])
        corners = [full]
        for sole, contact in zip(soles, standing, strict=True):
            if contact.load < most:
                share = min(contact.max_normal_force(1.0), 1.0)
                corners.append(((1.0 - share) * full[:, None] + share * sole).reshape(-1, 2))
        return Polygon.hull(np.concatenate(corners)).inset(self.margin)

    def _static_region(self, tick: Tick) -> Polygon:
        """Static region of the contacts with the world that have all their load, or of those that carry at all."""
        carrying = [contact for contact in tick.contacts if contact.mode == "fixed" and contact.is_footing]
        most = max(contact.load for contact in carrying)
        carrying = [contact for contact in carrying if contact.load == most]
        key = tuple((contact.name, contact.on.name) for contact in carrying)
        places = np.array([tick.relative_frame(contact.surface, contact.on).position for contact in carrying])
        if key not in self._regions or np.abs(places - self._regions[key][0]).max() > REGION_CREEP:
            patches = []
            for contact in carrying:
                at, frame = tick.relative_frame(contact.surface, contact.on), tick.frame(contact.point)
                points = frame.position + contact.vertices @ frame.rotation.T
                patches.append(Patch(points, at.rotation, contact.friction, contact.most))
            self._regions[key] = places, static_region(patches, tick.mass * GRAVITY)
        return self._regions[key][1]


def _planned_place(contact: TickContact, feet: Mapping[str, PlaceReference], t: float) -> Array:
    """Place (3,) at which the plan has a foot stand [m]."""
    return feet[contact.point](t) if contact.foothold is None else contact.foothold


def _is_foot(tick: Tick, contact: TickContact) -> bool:
    """Whether a contact is one of a foot with the world: others are no support of the zero-moment point."""
    return contact.is_footing and contact.point in tick.robot.feet


def _standing_feet(tick: Tick) -> list[TickContact]:
    """Contacts of feet that stand and may carry something."""
    return [c for c in tick.contacts if c.mode == "fixed" and c.load > 0.0 and _is_foot(tick, c)]


def _zmp_rows(tick: Tick, z: Array, wanted: Array, ground: float) -> tuple[Array, Array]:
    """Matrix (3, nv) and right-hand side (3,) that put the zero-moment point at z (2,); the height's row is kept."""
    _, A, drift = tick.centroidal()
    J, wanted = tick.com_jacobian.copy(), wanted.copy()
    height = tick.com[2] - ground
    lever, lean = 1.0 / (tick.mass * height), (tick.com[:2] - z) / height
    J[:2] += lever * np.stack((A[4], -A[3])) - np.outer(lean, J[2])
    rest = tick.com_drift[:2] + lever * np.array((drift[4], -drift[3])) - lean * tick.com_drift[2]
    wanted[:2] = GRAVITY * lean - rest
    return J, wanted


@compiled
def _wanted_acceleration_and_zmp(
    c: Array,
    velocity: Array,
    acceleration: Array,
    z: Array,
    com: Array,
    com_velocity: Array,
    com_drift: Array,
    shift: Array,
    tilt: Array,
    momentum: Array,
    planned_turn: Array,
    weight: float,
    ground: float,
    k: float,
    kp: float,
    normals: Array,
    offsets: Array,
) -> tuple[Array, Array, Array]:
    """Error c − com of the plan moved along with the feet (3,), wanted acceleration less its drift (3,), and commanded
    zero-moment point, with what the excess angular momentum takes (2,)."""
    omega = np.sqrt(GRAVITY / max(com[2] - ground, MIN_PENDULUM_HEIGHT))
    error, wanted = np.empty(3), np.empty(3)
    lag, centre, pivot = np.empty(2), np.empty(2), np.empty(2)
    turned = (omega + k) * momentum_excess_per_weight(momentum, planned_turn, weight)
    for i in range(2):
        place, forward = shift[i] + _tilted(tilt, c, i), _tilted(tilt, acceleration, i)
        centre[i] = shift[i] + _tilted(tilt, z, i)
        pivot[i] = place - forward * (c[2] - ground) / (GRAVITY + acceleration[2])
        error[i], wanted[i] = place - com[i], forward - com_drift[i]
        # The deviation from the plan, and the zero-moment point's lag that leads the divergent component back.
        lag[i] = -(1.0 + k / omega) * (error[i] + (_tilted(tilt, velocity, i) - com_velocity[i]) / omega)
    lag = _feasible_lag(lag, turned, centre, pivot, normals, offsets)
    for i in range(2):
        wanted[i] -= omega**2 * (error[i] + lag[i])
    error[2] = c[2] - com[2]
    wanted[2] = acceleration[2] - com_drift[2] + kp * error[2] + 2.0 * np.sqrt(kp) * (velocity[2] - com_velocity[2])
    return error, wanted, nearest_point(normals, offsets, centre + lag + turned)


@compiled
def _tilted(tilt: Array, x: Array, i: int) -> float:
    """Entry i of x, of which the first two are turned by a tilt (2, 2)."""
    entry: float = x[i] + tilt[i, 0] * x[0] + tilt[i, 1] * x[1]
    return entry


@compiled
def _feasible_lag(lag: Array, turned: Array, z: Array, pivot: Array, normals: Array, offsets: Array) -> Array:
    """Lag of the zero-moment point (2,) [m] closest to the wanted one for which the support polygon contains it.

    The plan's zero-moment point z differs from its pivot, the point that the floor's force on the centre of mass comes
    from, by what its angular momentum changes. When that leaves too little room, the change is given up: then the
    pivot alone has to stay inside.
    """
    whole, part = z + lag + turned, pivot + lag + turned
    kept, given_up = nearest_point(normals, offsets, whole) - whole, nearest_point(normals, offsets, part) - part
    return lag + (kept if kept @ kept <= given_up @ given_up else given_up)
