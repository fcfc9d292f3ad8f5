"""A contact with the floor: the forces that it can exert and the motion that it excludes."""

from typing import Literal

import numpy as np

from solvers.compiled import compiled
from sot.control.pose import AXIS_NAMES, PoseReference
from sot.control.tick import Mode, Tick

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
PYRAMID_SIDES = 8
"""Number of sides of a friction pyramid: with four it has 71 % of the cone's friction on an axis, with eight 92 %."""
FULL_FRICTION_SPEED = 0.002
"""Speed [m/s] of a sliding vertex from which on it meets the whole friction."""


class Contact:
    """A flat surface of a body on level ground, with the forces at its vertices as variables.

    Forms of its force variables φ [N], whose place among those of all contacts `Tick.force_columns` says:

    - "pyramid": a force (x, y, z), in the point's axes, at each vertex, Ramos (3), vertex after vertex, in the friction
      pyramid of eight sides inscribed in the cone; a foot that stands presses a little, at every vertex.
    - "unilateral": the paper's reduced form, Ramos (7)-(9): the wrench at the frame, force over moment in world axes,
      and after it the vertices' normal forces, linked by three equalities; pressure must not be negative, friction is
      not limited.

    Modes:

    - "fixed" holds all six axes and gives forces.
    - "sliding" holds height, roll and pitch, Ramos IV-C, while a task moves the rest. The paper has no forces then, and
      the foot hovers. Here it bears a light load, bounded from both sides: the variables are the vertices' normal
      forces n, and with each goes the floor's friction ``-mu n u / |u|`` against the velocity u that `path` has there.
    - "off" does neither.

    Args:
        point: Operational point of the robot on the surface.
        vertices: Corners in the point's frame, shape (nc, 3) [m].
        friction: Coulomb coefficient that is relied upon.
        inset: Distance by which the vertices are drawn in: keeps the pressure off the very edge [m].
        form: See above.
        stiffness: Gain that brings the surface flat onto the floor [1/s²].
        damping: Gain against any motion that the contact should not make [1/s].
        path: How the point is to move while it slides, or, if not as planned, while it is off.
        sliding_friction: Coulomb coefficient that is expected of the floor then.
    """

    def __init__(
        self,
        point: str,
        vertices: Array,
        friction: float = 0.5,
        inset: float = 0.004,
        form: Form = "pyramid",
        stiffness: float = 100.0,
        damping: float = 20.0,
        path: PoseReference | None = None,
        sliding_friction: float = 0.7,
    ) -> None:
        self.point, self.form = point, form
        self.mode: Mode = "fixed"
        self.load = 1.0
        """Ramp on the normal force: 1 carries whatever is needed, 0 nothing. The limit in between goes with the cube:
        a foot that carries little is unloaded as gradually as one that carries much."""
        centre = vertices.mean(axis=0)
        self.vertices = vertices - inset * np.sign(vertices - centre) * [1.0, 1.0, 0.0]
        self.friction, self.stiffness, self.damping = friction, stiffness, damping
        self.path, self.sliding_friction = path, sliding_friction
        self.unlimited_force = False
        """Whether the fixed contact exerts any force that is needed: no floor does, but a rehearsal may ask for it."""
        self.arrival_acceleration: Array | None = None
        """Acceleration (6,) that the point had when the contact was made, world axes [m/s², rad/s²]. The contact's own
        demand fades in from it within the load ramp, so that no joint's torque steps."""
        self._bounds_at_load = -1.0, 0.0, np.empty(0), np.empty(0)  # at which load, and the bounds of the forces then
        self._normal_selector = np.eye(len(vertices))
        sides = ("+x", "+x+y", "+y", "-x+y", "-x", "-x-y", "-y", "+x-y", "normal")
        self._force_labels: dict[int, list[str]] = {0: []} | {
            len(part) * len(vertices): [f"vertex {k} {side}" for k in range(len(vertices)) for side in part]
            for part in (sides, sides[-1:])
        }
        self._force_rows = (
            self._friction_pyramids()
            if form == "pyramid"
            else np.hstack([np.zeros((len(vertices), 6)), np.eye(len(vertices))])
        )

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
        """Axes (x, y, z, roll, pitch, yaw) that the present mode holds."""
        return {"fixed": (0, 1, 2, 3, 4, 5), "sliding": (2, 3, 4), "off": ()}[self.mode]

    @property
    def held_axis_names(self) -> list[str]:
        """Names of the held axes."""
        return [AXIS_NAMES[axis] for axis in self.held_axes]

    def force_labels(self, rows: int) -> list[str]:
        """Names of the rows of `force_inequalities`, of which there are `rows`."""
        return self._force_labels[rows]

    def wrench_map(self, tick: Tick) -> Array:
        """Map from φ to the wrench (force, moment about the point) that the floor exerts, world axes, (6, k)."""
        if self.mode == "sliding":
            return self._sliding_wrench_map(tick)
        if self.form == "unilateral":
            return np.hstack([np.eye(6), np.zeros((6, len(self.vertices)))])
        return _vertex_wrench_map(tick.frame(self.point).rotation, self.vertices)

    def force_equalities(self, tick: Tick) -> Array:
        """Rows E with ``E φ = 0``, shape (e, k): Ramos (7) for the unilateral form when fixed, else none."""
        if not self.force_equality_count:
            return np.zeros((0, self.force_count))
        arms = self.vertices @ tick.frame(self.point).rotation.T
        E = np.zeros((3, self.force_count))
        # Normal force, and its moments about x and y, as sums over the vertices: Ramos (8), (9) with the frame on the
        # surface (c_z = 0).
        E[0, 2], E[0, 6:] = -1.0, 1.0
        E[1, 3], E[1, 6:] = -1.0, arms[:, 1]
        E[2, 4], E[2, 6:] = -1.0, -arms[:, 0]
        return E

    def max_normal_force(self, weight: float) -> float:
        """Normal force that the ramp admits now [N], for a robot of this weight [N]; no limit at full load."""
        return np.inf if self.load >= 1.0 else self.load**3 * MAX_RAMPED_LOAD_WEIGHTS * weight

    def force_inequalities(self, weight: float) -> tuple[Array, Array, Array]:
        """Rows ``lower <= C φ <= upper``; `weight` is the robot's [N]."""
        if self.unlimited_force and self.mode == "fixed":
            return np.zeros((0, self.force_count)), np.zeros(0), np.zeros(0)
        if self.mode == "sliding":
            count = len(self.vertices)
            least, most = (share * weight / count for share in SLIDING_LOAD_RANGE_WEIGHTS)
            return self._normal_selector, np.full(count, least), np.full(count, most)
        if (self.load, weight) != self._bounds_at_load[:2]:
            count = len(self.vertices)
            top = self.max_normal_force(weight) / count
            if self.form == "unilateral":
                lower, upper = np.zeros(count), np.full(count, top)
            else:
                lower, upper = np.full((PYRAMID_SIDES + 1) * count, -np.inf), np.zeros((PYRAMID_SIDES + 1) * count)
                lower[PYRAMID_SIDES :: PYRAMID_SIDES + 1] = (
                    max(0.0, 2.0 * self.load - 1.0) * MIN_STANDING_LOAD_WEIGHTS * weight / count
                )
                upper[PYRAMID_SIDES :: PYRAMID_SIDES + 1] = top
            lower.flags.writeable = upper.flags.writeable = False  # the same until the load changes, and known to be
            self._bounds_at_load = self.load, weight, lower, upper
        return self._force_rows, self._bounds_at_load[2], self._bounds_at_load[3]

    def acceleration(self, tick: Tick) -> Array:
        """Acceleration that the point is to have, shape (6,): what brings the surface flat onto the floor and to rest.

        Velocity damping alone would keep a foot in the tilt in which it has landed.
        """
        frame = tick.frame(self.point)
        wanted = _flattening_acceleration(frame.position, frame.rotation, frame.velocity, self.stiffness, self.damping)
        if self.arrival_acceleration is not None:
            wanted += (1.0 - self.load) ** ARRIVAL_ACCELERATION_FADE_POWER * (self.arrival_acceleration - wanted)
            if self.load >= 1.0:
                self.arrival_acceleration = None
        return wanted

    def _sliding_wrench_map(self, tick: Tick) -> Array:
        """Map from the normal forces, with the friction that goes with them, to the wrench at the point, (6, nc)."""
        arms = self.vertices @ tick.frame(self.point).rotation.T
        twist = self.path(tick.t).velocity if self.path else tick.frame(self.point).velocity
        along = twist[:2] + twist[5] * np.column_stack([-arms[:, 1], arms[:, 0]])
        # At rest friction has no direction: it fades with the speed.
        along /= np.maximum(np.linalg.norm(along, axis=1), FULL_FRICTION_SPEED)[:, None]
        forces = np.column_stack([-self.sliding_friction * along, np.ones(len(arms))])
        return np.vstack([forces.T, np.cross(arms, forces).T])

    def _friction_pyramids(self) -> Array:
        """Rows of the friction pyramids of all vertices; the last row of each is the normal force."""
        turn = 2.0 * np.pi / PYRAMID_SIDES
        mu = self.friction * np.cos(turn / 2.0)  # inscribed: its edges lie in the cone, and nothing is beyond
        sides = [(np.cos(k * turn), np.sin(k * turn), -mu) for k in range(PYRAMID_SIDES)]
        return np.kron(np.eye(len(self.vertices)), np.array([*sides, (0.0, 0.0, 1.0)]))


@compiled
def _flattening_acceleration(
    position: Array, rotation: Array, velocity: Array, stiffness: float, damping: float
) -> Array:
    wanted = -damping * velocity
    wanted[2] -= stiffness * position[2]
    # The floor's normal seen from the sole's: n × e_z is the rotation that brings the sole flat.
    wanted[3] += stiffness * rotation[1, 2]
    wanted[4] -= stiffness * rotation[0, 2]
    return wanted


@compiled
def _vertex_wrench_map(rotation: Array, vertices: Array) -> Array:
    """Map from forces at the vertices, point's axes, to the wrench at the point, world axes: shape (6, 3 n)."""
    out = np.empty((6, 3 * len(vertices)))
    for k in range(len(vertices)):
        x, y, z = vertices[k]
        for i in range(3):
            a, b, c = rotation[i, 0], rotation[i, 1], rotation[i, 2]
            out[i, 3 * k], out[i, 3 * k + 1], out[i, 3 * k + 2] = a, b, c
            # The rows of R [p]×.
            out[3 + i, 3 * k], out[3 + i, 3 * k + 1], out[3 + i, 3 * k + 2] = (
                b * z - c * y,
                c * x - a * z,
                a * y - b * x,
            )
    return out
