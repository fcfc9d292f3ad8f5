"""Model quantities of the system's state at one control tick, each computed at most once."""

from collections.abc import Iterable, Sequence
from typing import Literal, Protocol, TypeVar

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.control.load import Carried, KnownWrench, Load
from sot.control.pose import PoseReference
from sot.control.quantities.bias import add_joint_forces, coulomb_speeds, write_bias_and_com
from sot.control.quantities.carrying import Carrying
from sot.control.quantities.frames import (
    FrameState,
    RelativeMotion,
    moving_velocities,
    write_placed_axes,
    write_point_motion,
)
from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.robots.surface import Surface, SurfaceAxes
from sot.robots.system import System
from sot.vector_view import owned_view

Array = np.ndarray
Mode = Literal["fixed", "sliding", "off"]

NamedContact = TypeVar("NamedContact", bound="TickContact")


class TickContact(Protocol):
    """Attributes of a contact that tasks may use: see `sot.control.contact.Contact`."""

    name: str
    point: str
    surface: Surface
    on: Surface
    mode: Mode
    load: float
    most: float
    friction: float
    wish: float
    reserve: float
    vertices: Array
    path: PoseReference | None
    foothold: Array | None
    is_catching: bool

    heel_load: float

    @property
    def bearing_vertices(self) -> Array: ...

    @property
    def is_rolling(self) -> bool: ...

    @property
    def force_count(self) -> int: ...

    @property
    def is_footing(self) -> bool: ...

    def wishes(self) -> Array: ...

    def wrench_map(self, tick: "Tick") -> Array: ...

    def max_normal_force(self, weight: float) -> float: ...

    def acceleration(self, tick: "Tick") -> Array: ...


class Tick:
    """Model quantities of one state (q, v); `update` moves it to the next one, in place: copy an array to keep it.

    Args:
        robot: The robot, or a system of it and things.
        period: Control period [s].

    Attributes:
        robot, system: The robot; and what the state is of, the robot alone or with things.
        model: Pinocchio's of the system, with the loads that are carried.
        t: Time [s].
        period: Control period, from this tick to the next [s].
        contacts: The contacts of this tick, those that are off included.
        loads: What is carried or acts from outside, beyond the model.
        mass: Of the robot and what it carries [kg].
        acceleration: What the controller commanded a tick ago, v̇ (nv,); none at first.
        torque: What it commanded a tick ago, τ (na,), the robot's first [N m]; None at first.
        q, v: State, Pinocchio's conventions, shapes (nq,), (nv,); the robot's first, then the things'.
        joint_positions, joint_velocities: Of the robot's joints (na,) [rad, rad/s].
        M: Mass matrix with the rotors' inertia, shape (nv, nv).
        h: Coriolis, centrifugal and gravity forces, what the joints' damping, friction and springs take, and known
            wrenches, so that ``M v̇ + h = Sᵀ τ + Jᵀ φ``; shape (nv,).
        finite: Whether all of the state is; nothing else here means anything if not.
        com, com_velocity, com_drift: Centre of mass of the robot and what it carries, Otani (33), its velocity, and
            J̇ v, shape (3,).
        momentum: Of these about it, linear over angular, world axes, shape (6,) [N s, N m s].
    """

    def __init__(self, robot: Robot | System, period: float = 0.001) -> None:
        self.system = system = System.of(robot)
        self.robot = system.robot
        self.model, self._model_is_own = system.model, False
        self.t = 0.0
        self.period = period
        self.contacts: Sequence[TickContact] = ()
        self.loads: Sequence[Load] = ()
        self._carried_shares: list[tuple[Carried, float]] = []
        self.acceleration = np.zeros(system.nv)
        self.torque: Array | None = None
        self.data = data = system.model.createData()
        # Live views of where Pinocchio writes: to ask it for them anew takes longer than to compute what is in them.
        self.M, self.com = owned_view(data.M, data), owned_view(data.com[0], data)
        self._forces, self._base, self._A_g = data.nle, data.oMi[1].rotation, data.Ag
        self._joint_losses = np.stack([self.robot.damping, self.robot.friction, coulomb_speeds(self.robot)])
        self._J, self.mass = data.J, self.robot.mass
        self.h, self.com_jacobian = np.empty(system.nv), np.empty((3, system.nv))
        self.com_velocity, self.com_drift, self.momentum = np.empty(3), np.empty(3), np.empty(6)
        self._points: dict[str, tuple[FrameState, Array, int]] = {}
        self._frames: dict[str, FrameState] = {}
        self._relative_frames: dict[tuple[Surface, Surface], FrameState] = {}
        self._placed_axes: dict[Surface, SurfaceAxes] = {}  # the last's arrays, of any tick
        self._surface_axes: dict[Surface, SurfaceAxes] = {}
        self._pairs: dict[tuple[Surface, Surface], RelativeMotion] = {}
        self._centroidal: tuple[Array, Array, Array] | None = None
        self._carrying: Carrying | None = None
        self._carried: tuple[str, ...] = ()
        if moving := system.moving_things:
            self._carrying = Carrying(system, data)
            self.com, self._A_g = self._carrying.com, self._carrying.A_g
            self._losses = np.array(
                [
                    np.concatenate([getattr(thing, kind) for thing in moving])
                    for kind in ("stiffness", "spring_reference", "damping", "friction")
                ]
            )
            self._has_losses = bool(self._losses.any())
            joints = [np.arange(system.nq)[system.coordinates[thing.name]] for thing in moving]
            # Free joints have no springs: any coordinate will do for them.
            self._spring_coordinates = np.concatenate(
                [own[-thing.nv :] for thing, own in zip(moving, joints, strict=True)]
            )
        self.finite = True
        self.update(0.0, system.rest, np.zeros(system.nv))

    @property
    def carried(self) -> tuple[str, ...]:
        """Names of the things that count as the robot's: in its mass, centre of mass and momentum.

        Raises:
            InputError: On setting it, if there is no such thing, or it is not free.
        """
        return self._carried

    @carried.setter
    def carried(self, names: Sequence[str]) -> None:
        if tuple(names) != self._carried:
            if self._carrying is None:
                self.system.thing(names[0])
                raise InputError(f"'{names[0]}' does not move and cannot be carried")
            self._carrying.choose(names)
            self._carried = tuple(names)
            self._update_mass()

    def update(self, t: float, q: Array, v: Array) -> "Tick":
        """Move to a new state; returns the tick itself."""
        data, robot = self.data, self.robot
        self.t, self.q, self.v = t, q, v
        self.joint_positions, self.joint_velocities = q[7 : robot.nq], v[6 : robot.nv]
        if self.loads or self._carried_shares:
            self._count_carried_loads()
        model = self.model
        # In world axes it leaves the joints' places and Jacobians, the centre of mass and A_g as well.
        pin.crba(model, data, q, pin.Convention.WORLD)
        pin.nonLinearEffects(model, data, q, v)
        pin.updateFramePlacements(model, data)
        if self._carrying is not None:
            self._carrying.update(self.mass - self._carrying.thing_mass)
        self.finite = write_bias_and_com(
            *(self._forces, self._base, self._A_g, self.mass, v, self._joint_losses),
            *(self.h, self.com_jacobian, self.com_velocity, self.com_drift, self.momentum),
        )
        if self._carrying is not None:
            self.com_drift[:] = self._carrying.rate[:3] / self.mass
            if self._has_losses:
                add_joint_forces(self.h, q[self._spring_coordinates], v, robot.nv, *self._losses)
        self._frames.clear()
        self._relative_frames.clear()
        self._surface_axes.clear()
        self._centroidal = None
        for load in self.loads:
            if isinstance(load, KnownWrench):
                self.h -= self.frame(load.point).jacobian.T @ load.wrench(t)
        return self

    def _count_carried_loads(self) -> None:
        """Let the model have the masses of the loads that are carried, as far as they act now."""
        shares = [(load, load.share) for load in self.loads if isinstance(load, Carried)]
        if shares == self._carried_shares:
            return
        if not self._model_is_own:
            self.model, self._model_is_own = pin.Model(self.model), True
        plain, model = self.system.model, self.model
        for load, _ in (*self._carried_shares, *shares):
            joint = plain.frames[self.system.point(load.point)].parentJoint
            model.inertias[joint] = plain.inertias[joint].copy()
        for load, _ in shares:
            frame = plain.frames[self.system.point(load.point)]
            model.inertias[frame.parentJoint] += load.present_inertia(frame.placement)
        self._carried_shares = shares
        self._update_mass()

    def _update_mass(self) -> None:
        things = self._carrying.thing_mass if self._carrying is not None else 0.0
        self.mass = self.robot.mass + things + sum(share * load.mass for load, share in self._carried_shares)

    def frame(self, point: str) -> FrameState:
        """State of an operational point.

        Raises:
            InputError: If there is no such point.
        """
        state = self._frames.get(point)
        if state is None:
            if point not in self._points:
                self._points[point] = self._make_point(point)
            state, moving, free = self._points[point]
            write_point_motion(
                self._J, self.v, moving, free, state.position, state.velocity, state.jacobian, state.drift
            )
            self._frames[point] = state
        return state

    def surface_axes(self, surface: Surface) -> SurfaceAxes:
        """Place of a surface in the world: its origin, and axes whose z points out of its body."""
        if surface.point is None:
            return surface.axes
        axes = self._surface_axes.get(surface)
        if axes is None:
            frame, own = self.frame(surface.point), surface.axes
            if surface not in self._placed_axes:
                self._placed_axes[surface] = SurfaceAxes(np.empty(3), np.empty((3, 3)))
            axes = self._surface_axes[surface] = self._placed_axes[surface]
            write_placed_axes(frame.position, frame.rotation, *own, *axes)
        return axes

    def relative_frame(self, surface: Surface, on: Surface) -> FrameState:
        """State of a surface's origin relative to the material point of another's body that is there, world axes.

        Its rotation is the one of the surface's axes turned so that z points into its body: a foot's axes for a sole.

        Raises:
            InputError: If one of them is on a point that does not exist, or both are of one body.
        """
        key = surface, on
        state = self._relative_frames.get(key)
        if state is None:
            if key not in self._pairs:
                self._refuse_one_body(surface, on)
                self._pairs[key] = RelativeMotion(surface, on, self.system.nv)
            assert surface.point is not None
            other = None if on.point is None else self.frame(on.point)
            state = self._relative_frames[key] = self._pairs[key].state(self.frame(surface.point), other)
        return state

    def _refuse_one_body(self, surface: Surface, on: Surface) -> None:
        """Check that two surfaces are of bodies that can move against each other."""
        frames = [self.model.frames[self.system.point(s.point)] for s in (surface, on) if s.point is not None]
        joints = [frame.parentJoint for frame in frames]
        if joints[0] == (joints[1] if len(joints) > 1 else 0):
            raise InputError(f"contact '{surface.name} on {on.name}': both surfaces are of one body")

    @property
    def force_count(self) -> int:
        """Number of force variables φ of all contacts in their present modes."""
        count = 0
        for contact in self.contacts:
            count += contact.force_count
        return count

    def force_columns(self, name: str) -> slice:
        """Where the forces of a contact are in φ: the columns of rows with ``variable = "force"``.

        φ has the force variables of all contacts, one after the other in the order of the stack, in N. What they are
        depends on the contact's form and mode, see `sot.control.Contact`; `contact.wrench_map(tick)` says what they
        amount to in any of them. None while the contact is off.

        Raises:
            InputError: If there is no such contact.
        """
        wanted, start = self.contact(name), 0
        for contact in self.contacts:
            if contact is wanted:
                break
            start += contact.force_count
        return slice(start, start + wanted.force_count)

    def contact(self, name: str) -> TickContact:
        """The contact of a name (see `contact_named`).

        Raises:
            InputError: If there is none.
        """
        return contact_named(self.contacts, name)

    def momentum_excess_per_weight(self, planned: Array) -> Array:
        """(ΔL_y, −ΔL_x) / (m g), with ΔL the angular momentum beyond a planned one (3,): shape (2,) [m s]."""
        excess: Array = momentum_excess_per_weight(self.momentum, planned, self.mass * GRAVITY)
        return excess

    def centroidal(self) -> tuple[Array, Array, Array]:
        """Momentum about the CoM, its matrix A_g with ``h = A_g v``, and Ȧ_g v: shapes (6,), (6, nv), (6,).

        Linear part first, world axes.
        """
        if self._centroidal is None and self._carrying is not None:
            self._centroidal = self.momentum, self._A_g, self._carrying.rate
        elif self._centroidal is None:
            # Ȧ_g v is what has to act on the base from outside when v̇ is zero, seen from the CoM, less the weight.
            force, moment = self._base @ self._forces[:3], self._base @ self._forces[3:6]
            moment += np.cross(self.data.oMi[1].translation - self.com, force)
            force[2] -= self.mass * GRAVITY
            self._centroidal = self.momentum, self._A_g, np.concatenate([force, moment])
        return self._centroidal

    def _make_point(self, name: str) -> tuple[FrameState, Array, int]:
        """Arrays for a point's state, the velocities that move it, and how many of them a free joint at the root has.

        Velocities are named by their indices, from the root outwards.
        """
        model = self.model
        frame = self.system.point(name)
        place = self.data.oMf[frame]
        moving, free = moving_velocities(model, frame)
        position, rotation = owned_view(place.translation, self.data), owned_view(place.rotation, self.data)
        state = FrameState(position, rotation, np.empty(6), np.zeros((6, self.system.nv)), np.empty(6))
        return state, moving, free


def contact_named(contacts: Iterable[NamedContact], name: str) -> NamedContact:
    """The contact of a name; or the one whose first surface or point has that name, where there is only one.

    Raises:
        InputError: If there is none, or more than one.
    """
    contacts = list(contacts)
    for contact in contacts:
        if contact.name == name:
            return contact
    of_surface = [contact for contact in contacts if name in (contact.surface.name, contact.point)]
    if len(of_surface) == 1:
        return of_surface[0]
    found = f"there are several contacts of '{name}'" if of_surface else f"there is no contact '{name}'"
    raise InputError(f"{found}: there are {', '.join(contact.name for contact in contacts)}")


@compiled
def momentum_excess_per_weight(momentum: Array, planned: Array, weight: float) -> Array:
    """`Tick.momentum_excess_per_weight` of a momentum (6,), for compiled code; `weight` is the robot's [N]."""
    return np.array(((momentum[4] - planned[1]) / weight, (planned[0] - momentum[3]) / weight))
