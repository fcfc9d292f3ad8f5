"""A contact between two surfaces: the forces that they exert on each other and the motion that it excludes."""

from typing import Any, Literal

import numpy as np

from sot.control.pose import AXES, AXIS_NAMES, PoseReference
from sot.control.quantities.contact_rows import (
    closing_acceleration,
    rolling_acceleration,
    vertex_wrench_map,
    write_held_pyramids,
    write_wrench_map_and_motion_columns,
)
from sot.control.quantities.frames import FrameState
from sot.control.tick import Mode, Tick
from sot.errors import InputError
from sot.robots.soles import front
from sot.robots.surface import FLOOR, INWARD, Surface

Array = np.ndarray
Form = Literal["pyramid", "unilateral"]

MAX_RAMPED_LOAD_WEIGHTS = 2.0
"""Largest normal force of a contact at the end of its load ramp, in weights of the robot; none after it."""
MIN_STANDING_LOAD_WEIGHTS = 0.02
"""Smallest normal force of a contact from the second half of its load ramp on, in weights of the robot. A foot that
does not press leaves the floor by fractions of a millimetre, tilts, and hits it again."""
SLIDING_LOAD_RANGE_WEIGHTS = 0.05, 0.09
"""Smallest and largest normal force of a sliding contact, in weights of the robot."""
SLIDING_LOAD_RAMP = (SLIDING_LOAD_RANGE_WEIGHTS[1] / MAX_RAMPED_LOAD_WEIGHTS) ** (1.0 / 3.0)
"""Value of `Contact.load` at which a fixed contact may carry as much as a sliding one."""
ARRIVAL_ACCELERATION_FADE_POWER = 5
"""Exponent with which the acceleration that a point had when its contact was made fades over the load ramp: most of it
is gone after a quarter of the ramp, before it moves the foot."""
ROLLING_FADE_TIME = 0.02
"""Time in which the acceleration of a surface that begins to roll fades in [s]."""
PYRAMID_SIDES = 8
"""Number of sides of a friction pyramid: with four it has 71 % of the cone's friction on an axis, with eight 92 %."""
FULL_FRICTION_SPEED = 0.002
"""Speed [m/s] of a sliding vertex from which on it meets the whole friction."""
_NO_ACCELERATION = np.zeros(6)


class Contact:
    """Two surfaces that touch: equal and opposite forces on both, Otani (13), variables at the first one's vertices.

    What is excluded is motion of the first surface relative to the second at the same material points, Otani (4), (15)
    and (16). The second may be the floor, a surface of the world, of a thing or of another part of the robot.

    Forms of its force variables φ [N], whose place among those of all contacts `Tick.force_columns` says:

    - "pyramid": a force (x, y, z) on the first surface at each vertex, Ramos (3), vertex after vertex, in axes of the
      first surface whose z points into its body (of a sole, the foot's), in the friction pyramid of eight sides
      inscribed in the cone; a foot that stands presses a little, at every vertex.
    - "unilateral": the paper's reduced form, Ramos (7)-(9), of soles on the floor: the wrench at the frame, force over
      moment in world axes, and after it the vertices' normal forces, linked by three equalities; pressure must not be
      negative, friction is not limited.

    Modes:

    - "fixed" holds all six axes, or those of `axes`, and gives forces. While it rolls (`roll`), the first surface turns
      about its front edge instead of lying flat, and the forces are those of that edge.
    - "sliding" holds height, roll and pitch over the second surface, Ramos IV-C, while a task moves the rest. The paper
      has no forces then, and the foot hovers. Here it bears a light load, bounded from both sides: the variables are
      the vertices' normal forces n, and with each goes the friction ``-mu n u / |u|`` against the velocity u that
      `path` has there.
    - "off" does neither.

    Args:
        surface: Of the robot or of a thing.
        on: What it touches; its z axis is what the first surface is laid flat against.
        friction: Coulomb coefficient that is relied upon; unless given, the lesser of the two surfaces'.
        inset: Distance by which the vertices are drawn in: keeps the pressure off the very edge [m].
        form: See above.
        axes: Which axes of the second surface it holds when fixed, any of "xyzRPY".
        stiffness: Gain that brings the surfaces together [1/s²].
        damping: Gain against any motion that the contact should not make [1/s].
        path: How the point is to move while it slides, or, if not as planned, while it is off.
        sliding_friction: Coulomb coefficient that is expected then.
        least, most: Bounds of the normal force in the second half of the load ramp and after it [N]. Unless given, a
            share of the robot's weight and no bound.
        wish: Normal force that `tasks.LeastForces` asks for [N]: what hands squeeze with.
        reserve: How much dearer its forces are to `tasks.LeastForces` than others': leaned on where need be only.
        name: Unless given, the first surface's if it is on the floor, else "surface on other surface".

    Attributes:
        point: Operational point that the first surface is fixed to.
        vertices: Where its forces act, in the frame of that point, shape (n, 3) [m].

    Raises:
        InputError: If both surfaces are of one body, the first is the world's, or the axes are others.
    """

    def __init__(
        self,
        surface: Surface,
        on: Surface = FLOOR,
        friction: float | None = None,
        inset: float = 0.004,
        form: Form = "pyramid",
        axes: str = AXES,
        stiffness: float = 100.0,
        damping: float = 20.0,
        path: PoseReference | None = None,
        sliding_friction: float = 0.7,
        least: float | None = None,
        most: float = np.inf,
        wish: float = 0.0,
        reserve: float = 1.0,
        name: str | None = None,
    ) -> None:
        self.surface, self.on, self.form = surface, on, form
        self.name = name or (surface.name if on is FLOOR else f"{surface.name} on {on.name}")
        if surface.point is None:
            raise InputError(f"contact '{self.name}': name the surface of the robot or thing first, then the world's")
        if surface.point == on.point or surface is on:
            raise InputError(f"contact '{self.name}': both surfaces are of one body, '{surface.owner}'")
        if not axes or set(axes) - set(AXES) or len(set(axes)) < len(axes):
            raise InputError(f"contact '{self.name}': axes '{axes}': choose some of {AXES}, each once")
        if form == "unilateral" and (on is not FLOOR or len(axes) < 6):
            raise InputError(f"contact '{self.name}': the unilateral form is for soles on the floor")
        self.point: str = surface.point
        self.mode: Mode = "fixed"
        self.load = 1.0
        """Ramp on the normal force: 1 carries whatever is needed, 0 nothing. The limit in between goes with the cube:
        a foot that carries little is unloaded as gradually as one that carries much."""
        corners = surface.corners @ INWARD
        drawn_in = inset * np.sign(corners - corners.mean(axis=0)) * [1.0, 1.0, 0.0]
        self._all_corners = corners - drawn_in  # from the surface's origin, in the axes of the forces
        self.heel_load = 1.0
        """Ramp on the normal forces behind the front edge, before it rolls: 1 bears whatever is needed, 0 nothing."""
        self._edge, self._is_behind = np.array([corners[:, 0].max(), 0.0, 0.0]), ~front(corners)
        self.roll(None)
        self._friction_given = friction
        self.friction = min(surface.friction, on.friction) if friction is None else friction
        self.stiffness, self.damping = stiffness, damping
        self.path, self.sliding_friction = path, sliding_friction
        self.least, self.most, self.wish, self.reserve = least, most, wish, reserve
        self.is_catching = False
        """Whether, while it is off, its path is that of an unplanned step: balance then has nothing else to do."""
        self.foothold: Array | None = None
        """Place (3,) at which the plan has it stand, where that is not the nearest in time: it was made early [m]."""
        self.unlimited_force = False
        """Whether the fixed contact exerts any force that is needed: no floor does, but a rehearsal may ask for it."""
        self.arrival_acceleration: Array | None = None
        """Relative acceleration (6,) that the surfaces had when the contact was made, world axes [m/s², rad/s²]. The
        contact's own demand fades in from it within the load ramp, so that no joint's torque steps."""
        self._fixed_axes = tuple(k for k, axis in enumerate(AXES) if axis in axes)
        self._bounds_at: tuple[float, float, float | None, float, int, float] = -1.0, 0.0, None, 0.0, 0, 1.0
        # at which load, weight, least, most, number of vertices and load of those behind
        self._bounds = np.empty(0), np.empty(0)  # and the bounds of the forces then
        self._normal_selector = np.eye(len(corners))
        sides = ("+x", "+x+y", "+y", "-x+y", "-x", "-x-y", "-y", "+x-y", "normal")
        self._force_labels: dict[int, list[str]] = {0: []} | {
            len(part) * count: [f"vertex {k} {side}" for k in range(count) for side in part]
            for part in (sides, sides[-1:])
            for count in (int(front(corners).sum()), len(corners))
        }
        self._force_rows = (
            self._friction_pyramids(self.friction)
            if form == "pyramid"
            else np.hstack([np.zeros((len(corners), 6)), np.eye(len(corners))])
        )

    def roll(self, path: PoseReference | None, t: float = -np.inf) -> None:
        """Let the first surface turn about its front edge from a time on [s], as the point does along a path.

        Its demand fades in: the path may have begun before. None lays it flat.
        """
        self._rolling_path, self._rolls_since, self.heel_load = path, t, 1.0
        self._corners = self._all_corners if path is None else self._all_corners[~self._is_behind]
        self.vertices = self._in_point(self._corners)

    @property
    def is_rolling(self) -> bool:
        """Whether it turns about its front edge."""
        return self.mode == "fixed" and self._rolling_path is not None

    @property
    def bearing_vertices(self) -> Array:
        """Vertices of the support that it gives, in the frame of `point`, shape (n, 3) [m]: those behind the front edge
        come nearer to it as they give up their load."""
        if self.heel_load >= 1.0 or self.is_rolling:
            return self.vertices
        corners, behind = self._all_corners.copy(), self._is_behind
        edge = corners[:, 0].max()
        corners[behind, 0] = edge + self.heel_load * (corners[behind, 0] - edge)
        return self._in_point(corners)

    def _in_point(self, corners: Array) -> Array:
        """Corners (n, 3) from the surface's origin, in the axes of the forces, in the frame of `point`."""
        placement = self.surface.placement
        return corners @ (placement.rotation @ INWARD).T + placement.translation

    def move_to(self, on: Surface) -> None:
        """Let the first surface touch another one of the world from now on; the contact has to be off.

        Raises:
            InputError: If the contact is not off, or is no contact with the world.
        """
        if on is self.on:
            return
        if self.mode != "off" or not self.is_footing or on.point is not None:
            raise InputError(f"contact '{self.name}' cannot move to {on.name}: lift a foot first, and onto the world")
        self.on = on
        if self._friction_given is None:
            self.rely_on(min(self.surface.friction, on.friction))

    def rely_on(self, friction: float) -> None:
        """Rely on another Coulomb coefficient from now on, as where a hand has slipped."""
        if friction != self.friction and self.form == "pyramid":
            self.friction, self._force_rows = friction, self._friction_pyramids(friction)

    @property
    def force_count(self) -> int:
        """Number of force variables in the present mode."""
        count = len(self.vertices)
        if self.mode != "fixed":
            return count if self.mode == "sliding" else 0
        return 3 * count if self.form == "pyramid" else 6 + count

    @property
    def force_equality_count(self) -> int:
        """Number of equalities between the force variables in the present mode."""
        return 3 if self.form == "unilateral" and self.mode == "fixed" else 0

    @property
    def held_axes(self) -> tuple[int, ...]:
        """Axes (x, y, z, roll, pitch, yaw) of the second surface that the present mode holds."""
        return {"fixed": self._fixed_axes, "sliding": (2, 3, 4), "off": ()}[self.mode]

    @property
    def held_axis_names(self) -> list[str]:
        """Names of the held axes."""
        return [AXIS_NAMES[axis] for axis in self.held_axes]

    @property
    def is_footing(self) -> bool:
        """Whether it is a surface of the world that is touched, of any height and slope."""
        return self.on.point is None

    def force_labels(self, rows: int) -> list[str]:
        """Names of the rows of `force_inequalities`, of which there are `rows`."""
        return self._force_labels[rows]

    def motion(self, tick: Tick) -> FrameState:
        """Place and axes (see "pyramid") of the first surface's origin, and its motion relative to the second surface.

        Velocity, Jacobian and drift are those of the first body less those of the second one's material point there.
        """
        return tick.relative_frame(self.surface, self.on)

    def wrench_map(self, tick: Tick) -> Array:
        """Map from φ to the wrench that the first surface feels, about its origin, world axes, (6, k)."""
        if self.mode == "sliding":
            return self._sliding_wrench_map(tick)
        if self.form == "unilateral":
            return np.hstack([np.eye(6), np.zeros((6, len(self.vertices)))])
        return vertex_wrench_map(self.motion(tick).rotation, self._corners)

    def normal_map(self) -> Array:
        """Map from φ to the normal force, shape (k,)."""
        if self.mode == "sliding" or self.form == "unilateral":
            row = np.ones(self.force_count)
            row[: self.force_count - len(self.vertices)] = 0.0
            return row
        return np.tile([0.0, 0.0, 1.0], self.force_count // 3)

    def wishes(self) -> Array:
        """What `tasks.LeastForces` asks of φ: the wish shared by the vertices' normal forces, shape (k,)."""
        return (self.load * self.wish / max(len(self.vertices), 1)) * self.normal_map()

    def force_equalities(self, tick: Tick) -> Array:
        """Rows E with ``E φ = 0``, shape (e, k): Ramos (7) for the unilateral form when fixed, else none."""
        if not self.force_equality_count:
            return np.zeros((0, self.force_count))
        arms = self._corners @ self.motion(tick).rotation.T
        E = np.zeros((3, self.force_count))
        # Normal force, and its moments about x and y, as sums over the vertices: Ramos (8), (9) with the frame on the
        # surface (c_z = 0).
        E[0, 2], E[0, 6:] = -1.0, 1.0
        E[1, 3], E[1, 6:] = -1.0, arms[:, 1]
        E[2, 4], E[2, 6:] = -1.0, -arms[:, 0]
        return E

    def max_normal_force(self, weight: float) -> float:
        """Normal force that the ramp admits now [N], for a robot of this weight [N]; `most` at full load."""
        if self.load >= 1.0:
            return self.most
        return self.load**3 * (self.most if np.isfinite(self.most) else MAX_RAMPED_LOAD_WEIGHTS * weight)

    def force_inequalities(self, weight: float) -> tuple[Array, Array, Array]:
        """Rows ``lower <= C φ <= upper``; `weight` is the robot's [N]."""
        if self.unlimited_force and self.mode == "fixed":
            return np.zeros((0, self.force_count)), np.zeros(0), np.zeros(0)
        if self.mode == "sliding":
            count = len(self.vertices)
            least, most = (share * weight / count for share in SLIDING_LOAD_RANGE_WEIGHTS)
            return self._normal_selector, np.full(count, least), np.full(count, most)
        count = len(self.vertices)
        if (self.load, weight, self.least, self.most, count, self.heel_load) != self._bounds_at:
            top = self.max_normal_force(weight) / count
            if self.form == "unilateral":
                lower, upper = np.zeros(count), np.full(count, top)
            else:
                least = MIN_STANDING_LOAD_WEIGHTS * weight if self.least is None else self.least
                lower, upper = np.full((PYRAMID_SIDES + 1) * count, -np.inf), np.zeros((PYRAMID_SIDES + 1) * count)
                lower[PYRAMID_SIDES :: PYRAMID_SIDES + 1] = min(max(0.0, 2.0 * self.load - 1.0) * least / count, top)
                upper[PYRAMID_SIDES :: PYRAMID_SIDES + 1] = top
                if self.heel_load < 1.0:
                    behind = PYRAMID_SIDES + (PYRAMID_SIDES + 1) * np.flatnonzero(self._is_behind)
                    ramped = self.heel_load**3 * MAX_RAMPED_LOAD_WEIGHTS * weight / count
                    lower[behind], upper[behind] = 0.0, min(top, ramped)
            lower.flags.writeable = upper.flags.writeable = False  # the same until the load changes, and known to be
            self._bounds_at, self._bounds = (
                (self.load, weight, self.least, self.most, count, self.heel_load),
                (lower, upper),
            )
        rows = self._force_rows
        return (rows[: len(self._bounds[0]), : self.force_count] if self.is_rolling else rows), *self._bounds

    def acceleration(self, tick: Tick) -> Array:
        """Relative acceleration that is to be, shape (6,): what lays the surfaces flat on each other and to rest.

        Velocity damping alone would keep a foot in the tilt in which it has landed.
        """
        at, axes = self.motion(tick), tick.surface_axes(self.on)
        state: tuple[Any, ...] = at.position, at.rotation, at.velocity
        held: tuple[Any, ...] = axes.translation, axes.rotation, self.stiffness, self.damping
        wanted: Array
        if self._rolling_path is None:
            wanted = closing_acceleration(*(*state, *held, *self._arrival_to_fade()))
        else:
            pose = self._rolling_path(tick.t)
            turn = pose.rotation, pose.velocity, pose.acceleration
            wanted = rolling_acceleration(*(*state, *held, self._edge, *turn))
            wanted *= min((tick.t - self._rolls_since) / ROLLING_FADE_TIME, 1.0)
        return wanted

    def _arrival_to_fade(self) -> tuple[Array, float]:
        """The acceleration that the surfaces arrived with, shape (6,), and what share of it is left."""
        if self.arrival_acceleration is None:
            return _NO_ACCELERATION, 0.0
        arrival, left = self.arrival_acceleration, (1.0 - self.load) ** ARRIVAL_ACCELERATION_FADE_POWER
        if self.load >= 1.0:
            self.arrival_acceleration = None
        return arrival, left

    def write_rows(
        self, tick: Tick, at: FrameState, wanted: Array, place: Array, map: Array, motion: Array, scale: float
    ) -> bool:
        """Write what the contact asks for at a tick.

        Args:
            tick: The state.
            at: `motion` at it.
            wanted: `acceleration` less the drift of `motion`, shape (6,).
            place: The first surface's origin, shape (3,).
            map: `wrench_map`, shape (6, k).
            motion: ``scale Jᵀ G`` of that map, shape (nv, k).
            scale: Factor of these columns.

        Returns:
            Whether the wrench map is finite.
        """
        axes = tick.surface_axes(self.on)
        arrival, left = self._arrival_to_fade()
        valid: bool
        if self.mode == "fixed" and self.form == "pyramid" and self._rolling_path is None:
            # In one compiled call, since this is what nearly all ticks are made of.
            held: tuple[Any, ...] = at.position, at.rotation, at.velocity, at.jacobian, at.drift
            gains = self.stiffness, self.damping, arrival, left
            valid = write_held_pyramids(
                *(*held, axes.translation, axes.rotation, *gains, self._corners, scale, wanted, place, map, motion)
            )
            return valid
        wanted[:], place[:] = self.acceleration(tick) - at.drift, at.position
        valid = write_wrench_map_and_motion_columns(at.jacobian, self.wrench_map(tick), scale, map, motion)
        return valid

    def _sliding_wrench_map(self, tick: Tick) -> Array:
        """Map from the normal forces, with the friction that goes with them, to the wrench at the point, (6, nc)."""
        motion, axes = self.motion(tick), tick.surface_axes(self.on).rotation
        arms = self._corners @ (axes.T @ motion.rotation).T
        twist = self.path(tick.t).velocity if self.path else motion.velocity
        along = (twist[:3] @ axes)[:2] + (twist[3:] @ axes)[2] * np.column_stack([-arms[:, 1], arms[:, 0]])
        # At rest friction has no direction: it fades with the speed.
        along /= np.maximum(np.linalg.norm(along, axis=1), FULL_FRICTION_SPEED)[:, None]
        forces = np.column_stack([-self.sliding_friction * along, np.ones(len(arms))])
        return np.vstack([axes @ forces.T, axes @ np.cross(arms, forces).T])

    def _friction_pyramids(self, friction: float) -> Array:
        """Rows of the friction pyramids of all vertices; the last row of each is the normal force."""
        turn = 2.0 * np.pi / PYRAMID_SIDES
        mu = friction * np.cos(turn / 2.0)  # inscribed: its edges lie in the cone, and nothing is beyond
        sides = [(np.cos(k * turn), np.sin(k * turn), -mu) for k in range(PYRAMID_SIDES)]
        return np.kron(np.eye(len(self.vertices)), np.array([*sides, (0.0, 0.0, 1.0)]))
