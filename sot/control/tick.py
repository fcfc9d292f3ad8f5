"""Model quantities of the robot's state at one control tick, each computed at most once."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.control.pose import PoseReference
from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.robots.robot import Robot

Array = np.ndarray
Mode = Literal["fixed", "sliding", "off"]

COULOMB_SPEED = 0.1
"""Least joint speed [rad/s] over which the Coulomb friction that is compensated changes sign: a step would chatter."""
COMPENSATION_RATE_LIMIT = 100.0
"""Bound of the rate [1/s] at which compensated friction speeds a joint up that has none: where the joint is light, the
compensation changes sign over a larger speed."""


@dataclass(slots=True)
class FrameState:
    """State of a frame of the robot, in world axes.

    Args:
        position: Origin, shape (3,) [m].
        rotation: Axes in the world, shape (3, 3).
        velocity: Linear velocity of the origin and angular velocity, world axes, shape (6,) [m/s, rad/s].
        jacobian: ``velocity = J v``, shape (6, nv).
        drift: J̇ v, the classical acceleration of the frame when v̇ is zero, shape (6,) [m/s², rad/s²].
    """

    position: Array
    rotation: Array
    velocity: Array
    jacobian: Array
    drift: Array

    def floor_projection(self, points: Array) -> Array:
        """Horizontal positions (n, 2) in the world of points (n, 3) of the frame [m]."""
        places: Array = self.position[:2] + (points @ self.rotation.T)[:, :2]
        return places


class TickContact(Protocol):
    """Attributes of a contact that tasks may use: see `sot.control.contact.Contact`."""

    point: str
    mode: Mode
    load: float
    vertices: Array
    path: PoseReference | None

    @property
    def force_count(self) -> int: ...

    def wrench_map(self, tick: "Tick") -> Array: ...

    def max_normal_force(self, weight: float) -> float: ...

    def acceleration(self, tick: "Tick") -> Array: ...


class Tick:
    """Model quantities of one state (q, v); `update` moves it to the next one, in place: copy an array to keep it.

    Attributes:
        t: Time [s].
        period: Control period, from this tick to the next [s].
        contacts: The contacts of this tick, those that are off included.
        mass: Of the robot [kg].
        acceleration: What the controller commanded a tick ago, v̇ (nv,); none at first.
        q, v: State, Pinocchio's conventions, shapes (nq,), (nv,).
        M: Mass matrix with the rotors' inertia, shape (nv, nv).
        h: Coriolis, centrifugal and gravity forces, and what the joints' damping and friction take, so that
            ``M v̇ + h = Sᵀ τ + Jᵀ φ``; shape (nv,).
        finite: Whether all of the state is; nothing else here means anything if not.
        com, com_velocity, com_drift: Centre of mass, its velocity, and J̇ v, shape (3,).
    """

    def __init__(self, robot: Robot, period: float = 0.001) -> None:
        self.robot = robot
        self.t = 0.0
        self.period = period
        self.contacts: Sequence[TickContact] = ()
        self.acceleration = np.zeros(robot.nv)
        self.data = data = robot.model.createData()
        # Live views of where Pinocchio writes: to ask it for them anew takes longer than to compute what is in them.
        self.M, self.com = data.M, data.com[0]
        self._forces, self._base, self._A_g = data.nle, data.oMi[1].rotation, data.Ag
        self._coulomb_speeds = coulomb_speeds(robot)
        self._J, self.mass = data.J, robot.mass
        self.h, self.com_jacobian = np.empty(robot.nv), np.empty((3, robot.nv))
        self.com_velocity, self.com_drift = np.empty(3), np.empty(3)
        self._points: dict[str, tuple[FrameState, Array]] = {}
        self._frames: dict[str, FrameState] = {}
        self._centroidal: tuple[Array, Array, Array] | None = None
        self.finite = True
        self.update(0.0, robot.rest, np.zeros(robot.nv))

    def update(self, t: float, q: Array, v: Array) -> "Tick":
        """Move to a new state; returns the tick itself."""
        model, data, robot = self.robot.model, self.data, self.robot
        self.t, self.q, self.v = t, q, v
        # In world axes it leaves the joints' places and Jacobians, the centre of mass and A_g as well.
        pin.crba(model, data, q, pin.Convention.WORLD)
        pin.nonLinearEffects(model, data, q, v)
        pin.updateFramePlacements(model, data)
        self.finite = _write_bias_and_com(
            *(self._forces, self._base, self._A_g, self.mass, v, robot.damping, robot.friction, self._coulomb_speeds),
            *(self.h, self.com_jacobian, self.com_velocity, self.com_drift),
        )
        self._frames.clear()
        self._centroidal = None
        return self

    def frame(self, point: str) -> FrameState:
        """State of an operational point.

        Raises:
            InputError: If the robot has no such point.
        """
        state = self._frames.get(point)
        if state is None:
            if point not in self._points:
                self._points[point] = self._make_point(point)
            state, moving_velocities = self._points[point]
            _write_point_motion(
                self._J, self.v, moving_velocities, state.position, state.velocity, state.jacobian, state.drift
            )
            self._frames[point] = state
        return state

    @property
    def force_count(self) -> int:
        """Number of force variables φ of all contacts in their present modes."""
        count = 0
        for contact in self.contacts:
            count += contact.force_count
        return count

    def force_columns(self, point: str) -> slice:
        """Where the forces of the contact at a point are in φ: the columns of rows with ``variable = "force"``.

        φ has the force variables of all contacts, one after the other in the order of the stack, in N. What they are
        depends on the contact's form and mode, see `sot.control.Contact`; `contact.wrench_map(tick)` says what they
        amount to in any of them. None while the contact is off.

        Raises:
            InputError: If there is no contact at that point.
        """
        start = 0
        for contact in self.contacts:
            if contact.point == point:
                return slice(start, start + contact.force_count)
            start += contact.force_count
        raise InputError(f"there is no contact '{point}': there are {', '.join(c.point for c in self.contacts)}")

    def contact(self, point: str) -> TickContact:
        """The contact at a point.

        Raises:
            InputError: If there is none.
        """
        for contact in self.contacts:
            if contact.point == point:
                return contact
        raise InputError(f"there is no contact '{point}': there are {', '.join(c.point for c in self.contacts)}")

    @property
    def momentum(self) -> Array:
        """Momentum about the CoM, linear over angular, world axes, shape (6,) [N s, N m s]."""
        return self._A_g @ self.v

    def momentum_excess_per_weight(self, planned: Array) -> Array:
        """(ΔL_y, −ΔL_x) / (m g), with ΔL the angular momentum beyond a planned one (3,): shape (2,) [m s]."""
        excess: Array = _momentum_excess_per_weight(self.momentum, planned, self.mass * GRAVITY)
        return excess

    def centroidal(self) -> tuple[Array, Array, Array]:
        """Momentum about the CoM, its matrix A_g with ``h = A_g v``, and Ȧ_g v: shapes (6,), (6, nv), (6,).

        Linear part first, world axes.
        """
        if self._centroidal is None:
            # Ȧ_g v is what has to act on the base from outside when v̇ is zero, seen from the CoM, less the weight.
            force, moment = self._base @ self._forces[:3], self._base @ self._forces[3:6]
            moment += np.cross(self.data.oMi[1].translation - self.com, force)
            force[2] -= self.mass * GRAVITY
            self._centroidal = self.momentum, self._A_g, np.concatenate([force, moment])
        return self._centroidal

    def _make_point(self, name: str) -> tuple[FrameState, Array]:
        """Arrays for a point's state, and the indices of the velocities that move it, from the base outwards."""
        robot, model = self.robot, self.robot.model
        frame = robot.point(name)
        place = self.data.oMf[frame]
        moving_velocities = [
            model.idx_vs[joint] + k
            for joint in model.supports[model.frames[frame].parentJoint]
            for k in range(model.nvs[joint])
        ]
        state = FrameState(place.translation, place.rotation, np.empty(6), np.zeros((6, robot.nv)), np.empty(6))
        return state, np.array(moving_velocities)


@compiled
def _momentum_excess_per_weight(momentum: Array, planned: Array, weight: float) -> Array:
    return np.array(((momentum[4] - planned[1]) / weight, (planned[0] - momentum[3]) / weight))


def coulomb_speeds(robot: Robot) -> Array:
    """Speeds over which each joint's compensated Coulomb friction changes sign, shape (na,) [rad/s].

    The compensation f tanh(v / s) adds at most f / s to a speed's rate over its inertia, f / (s I). Were the joint's
    friction less than the model's, that would be positive feedback: s bounds it. I is the least inertia that the joint
    can feel, 1 / (M⁻¹)ᵢᵢ, all others left free, at rest.
    """
    M = pin.crba(robot.model, robot.model.createData(), robot.rest)
    M = np.triu(M) + np.triu(M, 1).T
    inertias = 1.0 / np.diag(np.linalg.inv(M))[6:]
    return np.maximum(COULOMB_SPEED, robot.friction / (COMPENSATION_RATE_LIMIT * inertias))


@compiled
def _write_bias_and_com(
    forces: Array,
    base: Array,
    A_g: Array,
    mass: float,
    v: Array,
    damping: Array,
    friction: Array,
    coulomb_speeds: Array,
    h: Array,
    com_jacobian: Array,
    com_velocity: Array,
    com_drift: Array,
) -> bool:
    """Write h with joint losses, and the CoM's Jacobian, velocity and drift, from Pinocchio's forces and A_g.

    Returns:
        Whether the state that these come from is finite: one value of it that is not makes a sum of them so.
    """
    h[:] = forces
    total = 0.0
    for k in range(len(damping)):
        h[6 + k] += damping[k] * v[6 + k] + friction[k] * np.tanh(v[6 + k] / coulomb_speeds[k])
    for i in range(3):
        com_velocity[i] = 0.0
        for k in range(len(v)):
            com_jacobian[i, k] = A_g[i, k] / mass
            com_velocity[i] += com_jacobian[i, k] * v[k]
        # The force on the base that lets nothing accelerate but by J̇ v.
        com_drift[i] = (base[i, 0] * forces[0] + base[i, 1] * forces[1] + base[i, 2] * forces[2]) / mass
        total += com_velocity[i] + com_drift[i]
    com_drift[2] -= GRAVITY
    for k in range(len(h)):
        total += h[k]
    return bool(np.isfinite(total))


@compiled
def _write_point_motion(
    J: Array, v: Array, moving_velocities: Array, position: Array, velocity: Array, jacobian: Array, drift: Array
) -> None:
    """Write a point's velocity, Jacobian and drift, from the joints' Jacobian J with twists about the world's origin.

    A joint's axis is carried by what it turns: ``J̇_k = V × J_k`` with the twist V (linear, angular) of the body before
    it; the base's six together carry themselves, ``V × V = 0``.
    """
    px, py, pz = position[0], position[1], position[2]
    twist, change = np.zeros(6), np.zeros(6)
    for n in range(len(moving_velocities)):
        k = moving_velocities[n]
        x, y, z, a, b, c = J[0, k], J[1, k], J[2, k], J[3, k], J[4, k], J[5, k]
        jacobian[0, k], jacobian[1, k], jacobian[2, k] = x + b * pz - c * py, y + c * px - a * pz, z + a * py - b * px
        jacobian[3, k], jacobian[4, k], jacobian[5, k] = a, b, c
        x, y, z, a, b, c = x * v[k], y * v[k], z * v[k], a * v[k], b * v[k], c * v[k]
        if n >= 6:
            u, w = twist[:3], twist[3:]
            change[0] += w[1] * z - w[2] * y + u[1] * c - u[2] * b
            change[1] += w[2] * x - w[0] * z + u[2] * a - u[0] * c
            change[2] += w[0] * y - w[1] * x + u[0] * b - u[1] * a
            change[3] += w[1] * c - w[2] * b
            change[4] += w[2] * a - w[0] * c
            change[5] += w[0] * b - w[1] * a
        twist[0] += x
        twist[1] += y
        twist[2] += z
        twist[3] += a
        twist[4] += b
        twist[5] += c
    _write_shifted_twist(twist, position, velocity)
    _write_shifted_twist(change, position, drift)
    # What turns and moves on leaves its place on a curve.
    drift[0] += twist[4] * velocity[2] - twist[5] * velocity[1]
    drift[1] += twist[5] * velocity[0] - twist[3] * velocity[2]
    drift[2] += twist[3] * velocity[1] - twist[4] * velocity[0]


@compiled
def _write_shifted_twist(twist: Array, to: Array, out: Array) -> None:
    """Write a twist about the world's origin as one about the point `to`."""
    out[:] = twist
    out[0] += twist[4] * to[2] - twist[5] * to[1]
    out[1] += twist[5] * to[0] - twist[3] * to[2]
    out[2] += twist[3] * to[1] - twist[4] * to[0]
