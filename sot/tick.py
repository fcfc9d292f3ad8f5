"""What one control tick knows of the robot's state, each quantity computed at most once."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.robot import Robot

if TYPE_CHECKING:
    from sot.contact import Contact

Array = np.ndarray

GRAVITY = 9.81
COULOMB_SPEED = 0.1
"""Joint speed [rad/s] over which the Coulomb friction that is compensated changes sign: a step would chatter."""


@dataclass(slots=True)
class FrameState:
    """A frame of the robot, seen from the world.

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


class Tick:
    """Model quantities of one state (q, v); `update` moves it to the next one, in place: copy an array to keep it.

    Attributes:
        t: Time [s].
        period: Control period, from this tick to the next [s].
        contacts: The contacts of this tick, those that are off included.
        q, v: State, Pinocchio's conventions, shapes (nq,), (nv,).
        M: Mass matrix with the rotors' inertia, shape (nv, nv).
        h: Coriolis, centrifugal and gravity forces, and what the joints' damping and friction take, so that
            ``M v̇ + h = Sᵀ τ + Jᵀ φ``; shape (nv,).
        com, com_velocity, com_drift: Centre of mass, its velocity, and J̇ v, shape (3,).
    """

    def __init__(self, robot: Robot, period: float = 0.001) -> None:
        self.robot = robot
        self.t = 0.0
        self.period = period
        self.contacts: Sequence[Contact] = ()
        self.data = robot.model.createData()
        self._momentum_data = robot.model.createData()
        self._rest = np.zeros(robot.nv)
        self._frames: dict[str, FrameState] = {}
        # Live views of where Pinocchio writes: to ask it for them anew takes longer than to compute what is in them.
        self._places: dict[str, tuple[int, Array, Array]] = {}
        self._com = tuple(part[0] for part in (self.data.com, self.data.vcom, self.data.acom))
        self._com_jacobian: Array | None = None
        self._centroidal: tuple[Array, Array, Array] | None = None
        self.update(0.0, robot.rest, self._rest)

    def update(self, t: float, q: Array, v: Array) -> "Tick":
        """Take a new state, and return the tick itself."""
        model, data, robot = self.robot.model, self.data, self.robot
        self.t, self.q, self.v = t, q, v
        self.h = pin.nonLinearEffects(model, data, q, v).copy()
        _add_friction(self.h, v, robot.damping, robot.friction)
        self.M = pin.crba(model, data, q)
        # With v̇ = 0 accelerations are drifts; this also leaves data.v and data.a for the frames below.
        pin.centerOfMass(model, data, q, v, self._rest, False)
        self.com, self.com_velocity, self.com_drift = self._com
        pin.computeJointJacobians(model, data)
        pin.updateFramePlacements(model, data)
        self._frames.clear()
        self._com_jacobian = None
        self._centroidal = None
        return self

    @property
    def com_jacobian(self) -> Array:
        """``ċ = J v``, shape (3, nv)."""
        if self._com_jacobian is None:
            self._com_jacobian = pin.jacobianCenterOfMass(self.robot.model, self.data, False)
        return self._com_jacobian

    def frame(self, point: str) -> FrameState:
        """State of an operational point.

        Raises:
            InputError: If the robot has no such point.
        """
        state = self._frames.get(point)
        if state is None:
            model, data = self.robot.model, self.data
            if point not in self._places:
                frame = self.robot.point(point)
                place = data.oMf[frame]
                self._places[point] = frame, place.translation, place.rotation
            frame, position, rotation = self._places[point]
            jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
            drift = pin.getFrameClassicalAcceleration(model, data, frame, pin.LOCAL_WORLD_ALIGNED).vector
            state = FrameState(position, rotation, jacobian @ self.v, jacobian, drift)
            self._frames[point] = state
        return state

    def centroidal(self) -> tuple[Array, Array, Array]:
        """Momentum about the CoM, its matrix A_g with ``h = A_g v``, and Ȧ_g v: shapes (6,), (6, nv), (6,).

        Linear part first, world axes.
        """
        if self._centroidal is None:
            model = self.robot.model
            data = self._momentum_data  # its own: the frames' drifts in `data` must survive
            drift = pin.computeCentroidalMomentumTimeVariation(model, data, self.q, self.v, self._rest).vector.copy()
            matrix = pin.ccrba(model, data, self.q, self.v)
            self._centroidal = data.hg.vector.copy(), matrix, drift
        return self._centroidal


@compiled
def _add_friction(h: Array, v: Array, damping: Array, friction: Array) -> None:
    """Add what the joints' damping and friction take."""
    for k in range(len(damping)):
        h[6 + k] += damping[k] * v[6 + k] + friction[k] * np.tanh(v[6 + k] / COULOMB_SPEED)
