"""How a robot with servos sways on its bushes, from what is built in: the linear model of the whole body."""

from collections.abc import Mapping, Sequence
from math import inf
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.hardware.compliance import FootCompliance, bush_position
from sot.hardware.servo import Servo
from sot.robots.robot import Robot

Array = np.ndarray

DIFFERENCE = 1e-5
"""Step of finite differences [rad, m]."""
RIGID_RATIO = 3e4
"""Stiffness of what is rigid, in weights a metre, or weights times metres a radian."""
IMAGINARY_SHARE = 0.05
"""Share of |λ| from which an eigenvalue counts as one of an oscillation."""


class SwayMode(NamedTuple):
    """An oscillation: its undamped natural frequency [Hz] and its damping ratio."""

    frequency: float
    damping_ratio: float


class FloorContact(NamedTuple):
    """How the floor under a sole gives way.

    Attributes:
        stiffness: about x, y [N m/rad] and along z [N/m], (3,).
        relaxation_time: damping over stiffness [s].
    """

    stiffness: Array
    relaxation_time: float


RIGID_FLOOR = FloorContact(np.full(3, inf), 0.0)


def sway_modes(
    robot: Robot,
    q: Array,
    feet: Sequence[str],
    servo: Servo,
    compliance: FootCompliance,
    floor: Mapping[str, FloorContact] | None = None,
) -> tuple[SwayMode, SwayMode]:
    """The slowest oscillations in which the centre of mass moves along x and along y.

    All bodies move. The servos hold a posture, soles lie on the floor, and the static forces are linearised by
    finite differences, gravity and the load on the feet among them.

    Args:
        robot: the robot.
        q: posture (nq,), the centre of mass over the middle of the bushes.
        feet: that stand and share the weight evenly.
        servo: of the joints.
        compliance: of the feet.
        floor: under each foot, in series with its bush; rigid unless given.

    Raises:
        InputError: the robot falls over, its bushes are too soft.
    """
    model, data = robot.model, robot.model.createData()
    floor = floor or dict.fromkeys(feet, RIGID_FLOOR)
    stands = [_Stand(robot, data, q, foot, compliance, floor[foot], len(feet)) for foot in feet]
    balancing = np.zeros(robot.nv)

    def static_force(step: Array) -> Array:
        moved = pin.integrate(model, q, step)
        force = pin.computeGeneralizedGravity(model, data, moved).copy()
        pin.computeJointJacobians(model, data, moved)
        pin.updateFramePlacements(model, data)
        for stand in stands:
            force -= stand.force(data)
        force[6:] += servo.stiffness * step[6:]
        return force - balancing

    balancing = static_force(np.zeros(robot.nv))
    steps = DIFFERENCE * np.eye(robot.nv)
    stiffness = np.array([static_force(step) - static_force(-step) for step in steps]).T / (2.0 * DIFFERENCE)
    mass = pin.crba(model, data, q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    mass[6:, 6:] += np.diag(servo.rotor - robot.armature)
    damping = np.diag(np.concatenate([np.zeros(6), servo.damping + robot.damping]))
    com = pin.jacobianCenterOfMass(model, data, q).copy()
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    for stand in stands:
        damping += stand.damping(data)
    inverse = np.linalg.inv(mass)
    n = robot.nv
    values, vectors = np.linalg.eig(
        np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
    )
    if values.real.max() > 1e-6:
        raise InputError(f"{robot.label} cannot stand on these bushes: they are too soft")
    swaying = values.imag > IMAGINARY_SHARE * np.abs(values)
    moves = np.abs(com[:2] @ vectors[:n])
    found = []
    for axis in range(2):
        ours = np.flatnonzero(swaying & (moves[axis] > moves[1 - axis]))
        slowest = values[min(ours, key=lambda k: abs(values[k]))]
        found.append(SwayMode(float(abs(slowest) / (2.0 * np.pi)), float(-slowest.real / abs(slowest))))
    return found[0], found[1]


def inertia_about_com(robot: Robot, q: Array) -> Array:
    """Moments of inertia of the whole robot about its centre of mass, along x and y (2,) [kg m²]."""
    data = robot.model.createData()
    pin.ccrba(robot.model, data, q, np.zeros(robot.nv))
    inertia: Array = np.diag(data.Ig.inertia)[:2].copy()
    return inertia


class _Stand:
    """A foot on its bush on the floor."""

    def __init__(
        self,
        robot: Robot,
        data: pin.Data,
        q: Array,
        foot: str,
        compliance: FootCompliance,
        floor: FloorContact,
        count: int,
    ) -> None:
        pin.framesForwardKinematics(robot.model, data, q)
        self._model, self._frame = robot.model, robot.point(foot)
        self._bush = bush_position(robot, foot)
        self._start = data.oMf[self._frame] * pin.SE3(np.eye(3), self._bush)
        weight = robot.mass * GRAVITY
        self._load = np.array([0.0, 0.0, weight / count])
        rigid = RIGID_RATIO * weight
        bush = np.minimum([compliance.roll, compliance.pitch, compliance.vertical], rigid)
        relaxation = np.where(bush < rigid, compliance.relaxation_time(robot), 0.0)
        # K (1 + t s) of bush and floor in series is K_e (1 + (t_b K_e / K_b + t_f K_e / K_f) s), but for higher powers.
        both = 1.0 / (1.0 / bush + 1.0 / floor.stiffness)
        relaxation = relaxation * both / bush + floor.relaxation_time * both / floor.stiffness
        self._stiffness, self._damping = np.full(6, rigid), np.zeros(6)
        self._stiffness[[3, 4, 2]], self._damping[[3, 4, 2]] = both, relaxation * both

    def _jacobian(self, data: pin.Data) -> Array:
        """Of the bush's place and turn (6, nv), in the axes of the foot at rest."""
        jacobian = pin.getFrameJacobian(self._model, data, self._frame, pin.LOCAL_WORLD_ALIGNED)
        arm = data.oMf[self._frame].rotation @ self._bush
        jacobian[:3] -= pin.skew(arm) @ jacobian[3:]
        turned: Array = np.vstack([self._start.rotation.T @ part for part in (jacobian[:3], jacobian[3:])])
        return turned

    def force(self, data: pin.Data) -> Array:
        """Generalised force of floor and bush on the robot (nv,)."""
        at = data.oMf[self._frame] * pin.SE3(np.eye(3), self._bush)
        place = self._start.rotation.T @ (at.translation - self._start.translation)
        turn = pin.log3(self._start.rotation.T @ at.rotation)
        wrench = -self._stiffness * np.concatenate([place, turn])
        wrench[:3] += self._start.rotation.T @ self._load
        force: Array = self._jacobian(data).T @ wrench
        return force

    def damping(self, data: pin.Data) -> Array:
        """Damping of the bush (nv, nv)."""
        jacobian = self._jacobian(data)
        return (jacobian.T * self._damping) @ jacobian
