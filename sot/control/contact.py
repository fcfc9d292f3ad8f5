"""A foot on the floor: the forces it can give and the motion it may not make."""

from typing import Literal

import numpy as np

from solvers.compiled import compiled
from sot.control.pose import AXIS_NAMES, PoseReference
from sot.control.tick import Mode, Tick

Array = np.ndarray
Form = Literal["pyramid", "unilateral"]

LARGEST_LOAD = 2.0
"""Normal force of a contact whose ramp is almost over, in weights of the robot."""
LEAST_LOAD = 0.02
"""Normal force of a contact in the second half of its ramp and beyond, at least, in weights of the robot: a foot that
does not press leaves the floor by fractions of a millimetre, tilts, and hits it again."""
SLIDING_LOAD = 0.05, 0.09
"""Least and greatest normal force of a sliding contact, in weights of the robot."""
SLIDING_SHARE = (SLIDING_LOAD[1] / LARGEST_LOAD) ** (1.0 / 3.0)
"""`Contact.load` at which a fixed contact may carry as much as a sliding one."""
LEAD = 5
"""Power of the rest of the ramp with which a contact still gives its point the acceleration with which it arrived: most
of it has gone after a quarter of the ramp, before it moves the foot."""
SIDES = 8
"""Of a friction pyramid: with four, a force along an axis has 71 % of the cone's friction, with eight 92 %."""
STILL = 0.002
"""Speed [m/s] below which a sliding vertex meets less than the whole friction."""


class Contact:
    """A flat surface of a body on level ground, with the forces at its vertices as variables.

    Forms of its force variables φ:

    - "pyramid": a force (x, y, z), in the point's axes, at each vertex, Ramos (3), in the friction pyramid of eight
      sides inscribed in the cone; a foot that stands presses a little, at every vertex.
    - "unilateral": the paper's reduced form, Ramos (7)-(9): the wrench at the frame and the vertices' normal forces,
      linked by three equalities; pressure must not be negative, friction is not limited.

    Modes:

    - "fixed" holds all six axes and gives forces.
    - "sliding" holds height, roll and pitch, Ramos IV-C, while a task moves the rest. The paper has no forces then, and
      the foot hovers. Here it bears a light load, bounded from both sides: the variables are the vertices' normal
      forces n, and with each goes the floor's friction ``-mu n u / |u|`` against the velocity u that `way` has there.
    - "off" does neither.

    Args:
        point: Operational point of the robot on the surface.
        vertices: Corners in the point's frame, shape (nc, 3) [m].
        friction: Coulomb coefficient that is relied upon.
        inset: Distance by which the vertices are drawn in: keeps the pressure off the very edge [m].
        form: See above.
        stiffness: Of the drive that lays the surface flat on the floor [1/s²].
        damping: Of any motion that the contact should not make [1/s].
        way: How the point is to move while it slides, or, if not as planned, while it is off.
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
        way: PoseReference | None = None,
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
        self.way, self.sliding_friction = way, sliding_friction
        self.sticks = False
        """Whether, while fixed, it gives any force that is needed: no floor does, but it tells what would be."""
        self.arrival: Array | None = None
        """Acceleration (6,) that the point was given before the contact was made, world axes [m/s², rad/s²]. What the
        contact asks for is led over from it within the ramp: no joint's torque steps."""
        self._bounded = -1.0, 0.0, np.empty(0), np.empty(0)  # at which load, and the bounds of the forces then
        self._normals = np.eye(len(vertices))
        sides = ("+x", "+x+y", "+y", "-x+y", "-x", "-x-y", "-y", "+x-y", "normal")
        self._labels: dict[int, list[str]] = {0: []} | {
            len(part) * len(vertices): [f"vertex {k} {side}" for k in range(len(vertices)) for side in part]
            for part in (sides, sides[-1:])
        }
        self._cone = (
            self._pyramids() if form == "pyramid" else np.hstack([np.zeros((len(vertices), 6)), np.eye(len(vertices))])
        )

    @property
    def force_count(self) -> int:
        """Number of force variables in the present mode."""
        count = len(self.vertices)
        if self.mode != "fixed":
            return count if self.mode == "sliding" else 0
        return 3 * count if self.form == "pyramid" else 6 + count

    @property
    def link_count(self) -> int:
        """Number of equalities between the force variables in the present mode."""
        return 3 if self.form == "unilateral" and self.mode == "fixed" else 0

    @property
    def held(self) -> tuple[int, ...]:
        """Axes (x, y, z, roll, pitch, yaw) that the present mode holds."""
        return {"fixed": (0, 1, 2, 3, 4, 5), "sliding": (2, 3, 4), "off": ()}[self.mode]

    @property
    def axes(self) -> list[str]:
        """Their names."""
        return [AXIS_NAMES[axis] for axis in self.held]

    def force_labels(self, rows: int) -> list[str]:
        """Names of the rows of `force_inequalities`, of which there are `rows`."""
        return self._labels[rows]

    def wrench_map(self, tick: Tick) -> Array:
        """Map from φ to the wrench (force, moment about the point) that the floor exerts, world axes, (6, k)."""
        if self.mode == "sliding":
            return self._sliding_map(tick)
        if self.form == "unilateral":
            return np.hstack([np.eye(6), np.zeros((6, len(self.vertices)))])
        return _wrenches(tick.frame(self.point).rotation, self.vertices)

    def force_equalities(self, tick: Tick) -> Array:
        """Rows E with ``E φ = 0``, shape (e, k): Ramos (7) for the unilateral form when fixed, else none."""
        if not self.link_count:
            return np.zeros((0, self.force_count))
        arms = self.vertices @ tick.frame(self.point).rotation.T
        E = np.zeros((3, self.force_count))
        # Normal force, and its moments about x and y, as sums over the vertices: Ramos (8), (9) with the frame on the
        # surface (c_z = 0).
        E[0, 2], E[0, 6:] = -1.0, 1.0
        E[1, 3], E[1, 6:] = -1.0, arms[:, 1]
        E[2, 4], E[2, 6:] = -1.0, -arms[:, 0]
        return E

    def largest(self, weight: float) -> float:
        """Normal force that the ramp admits now [N], for a robot of this weight [N]; no limit at full load."""
        return np.inf if self.load >= 1.0 else self.load**3 * LARGEST_LOAD * weight

    def force_inequalities(self, weight: float) -> tuple[Array, Array, Array]:
        """Rows ``lower <= C φ <= upper``; `weight` is the robot's [N]."""
        if self.sticks and self.mode == "fixed":
            return np.zeros((0, self.force_count)), np.zeros(0), np.zeros(0)
        if self.mode == "sliding":
            count = len(self.vertices)
            least, most = (share * weight / count for share in SLIDING_LOAD)
            return self._normals, np.full(count, least), np.full(count, most)
        if (self.load, weight) != self._bounded[:2]:
            count = len(self.vertices)
            top = self.largest(weight) / count
            if self.form == "unilateral":
                lower, upper = np.zeros(count), np.full(count, top)
            else:
                lower, upper = np.full((SIDES + 1) * count, -np.inf), np.zeros((SIDES + 1) * count)
                lower[SIDES :: SIDES + 1] = max(0.0, 2.0 * self.load - 1.0) * LEAST_LOAD * weight / count
                upper[SIDES :: SIDES + 1] = top
            lower.flags.writeable = upper.flags.writeable = False  # the same until the load changes, and known to be
            self._bounded = self.load, weight, lower, upper
        return self._cone, self._bounded[2], self._bounded[3]

    def acceleration(self, tick: Tick) -> Array:
        """Acceleration that the held surface is to have, shape (6,): none, but for laying it flat and at rest.

        Velocity damping alone would hold a foot in whatever tilt it has landed.
        """
        frame = tick.frame(self.point)
        wanted = _lying(frame.position, frame.rotation, frame.velocity, self.stiffness, self.damping)
        if self.arrival is not None:
            wanted += (1.0 - self.load) ** LEAD * (self.arrival - wanted)
            if self.load >= 1.0:
                self.arrival = None
        return wanted

    def _sliding_map(self, tick: Tick) -> Array:
        """Normal forces, and the friction that goes with them, as wrenches (6, nc)."""
        arms = self.vertices @ tick.frame(self.point).rotation.T
        twist = self.way(tick.t).velocity if self.way else tick.frame(self.point).velocity
        along = twist[:2] + twist[5] * np.column_stack([-arms[:, 1], arms[:, 0]])
        # At rest friction has no direction: it fades with the speed.
        along /= np.maximum(np.linalg.norm(along, axis=1), STILL)[:, None]
        forces = np.column_stack([-self.sliding_friction * along, np.ones(len(arms))])
        return np.vstack([forces.T, np.cross(arms, forces).T])

    def _pyramids(self) -> Array:
        """Friction pyramids of all vertices, with the normal force as the last row of each."""
        turn = 2.0 * np.pi / SIDES
        mu = self.friction * np.cos(turn / 2.0)  # inscribed: its edges lie in the cone, and nothing is beyond
        sides = [(np.cos(k * turn), np.sin(k * turn), -mu) for k in range(SIDES)]
        return np.kron(np.eye(len(self.vertices)), np.array([*sides, (0.0, 0.0, 1.0)]))


@compiled
def _lying(position: Array, rotation: Array, velocity: Array, stiffness: float, damping: float) -> Array:
    wanted = -damping * velocity
    wanted[2] -= stiffness * position[2]
    # The floor's normal seen from the sole's: n × e_z is the rotation that brings the sole flat.
    wanted[3] += stiffness * rotation[1, 2]
    wanted[4] -= stiffness * rotation[0, 2]
    return wanted


@compiled
def _wrenches(rotation: Array, vertices: Array) -> Array:
    """Forces at vertices, all in the point's axes, as wrenches at the point, world axes: shape (6, 3 n)."""
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
