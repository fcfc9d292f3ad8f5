"""The variables x of a tick: accelerations, torques and contact forces as affine functions of them.

The *full* form is the paper's, x = (v̇, τ, φ): every quantity is a part of x, and the equation of motion
``M v̇ + h = Sᵀ τ + Jᵀ φ`` (Ramos (10) with forces on the robot) and the contacts ``J_c v̇ = a_c`` are equalities of
level 0.

The *condensed* form solves those equalities beforehand. With N a basis of the null space of J_c, the accelerations are
``v̇ = N u + v̇_0``; the base's six rows of the equation of motion give the forces up to those that cancel each other,
``φ = Φ u + K w + φ_0``; the other rows give the torques. What is left is x = (u, w): motions that the contacts allow
and internal forces, with nothing but inequalities in level 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from solvers.nullspace import project
from solvers.rows import Block
from sot.contact import Contact
from sot.robot import Robot
from sot.tick import GRAVITY, Tick

Array = np.ndarray

RANK_TOLERANCE = 1e-7


@dataclass(slots=True)
class Units:
    """What forces and torques are counted in, so that one tolerance fits all rows.

    Args:
        weight: Of the robot [N].
        force: A share of the weight [N].
        torque: The robot's median torque limit [N m].
    """

    weight: float
    force: float
    torque: float

    @classmethod
    def of(cls, robot: Robot) -> "Units":
        """Those that fit a robot."""
        weight = robot.mass * GRAVITY
        return cls(weight, weight / 8.0, float(np.median(robot.effort)))


@dataclass(slots=True)
class Equality:
    """Equalities ``A x = b`` that a form leaves to level 0, and whose they are."""

    block: Block
    A: Array
    b: Array


@dataclass(slots=True)
class Form:
    """Everything a tick's rows may be about, as an affine function of x.

    Args:
        size: Number of variables.
        motion: Number of leading variables that accelerations depend on.
        acceleration, acceleration_offset: v̇ = A x[:motion] + a, shapes (nv, motion), (nv,).
        torque, torque_offset: τ in N m, shapes (na, size), (na,).
        force, force_offset: φ of all contacts, in `Units.force`, shapes (nf, size), (nf,).
        equalities: What level 0 has to see to.
    """

    size: int
    motion: int
    acceleration: Array
    acceleration_offset: Array
    torque: Array
    torque_offset: Array
    force: Array
    force_offset: Array
    equalities: list[Equality] = field(default_factory=list)


@dataclass(slots=True)
class Touch:
    """The contacts of a tick, gathered.

    Args:
        parts: Where each contact's variables are in φ.
        wrench_maps: φ to wrench, one a contact.
        forces: ``Jᵀ`` for φ in `Units.force`, shape (nv, nf).
        pressure: Equalities E φ = 0 of the reduced contact form, shape (e, nf).
        jacobian, acceleration: Held axes ``J_c v̇ = a_c``, shapes (c, nv), (c,).
        held: How many rows of J_c belong to each contact.
    """

    parts: list[slice]
    wrench_maps: list[Array]
    forces: Array
    pressure: Array
    jacobian: Array
    acceleration: Array
    held: list[int]

    @classmethod
    def of(cls, tick: Tick, contacts: Sequence[Contact], units: Units) -> "Touch":
        """Gather the contacts of a tick."""
        nv = tick.robot.nv
        parts = [slice(a, b) for a, b in pairwise(np.cumsum([0, *(c.force_count for c in contacts)]).tolist())]
        forces = np.empty((nv, parts[-1].stop if parts else 0))
        maps, pressures, jacobians, accelerations, held = [], [], [np.empty((0, nv))], [np.empty(0)], []
        for contact, part in zip(contacts, parts, strict=True):
            frame = tick.frame(contact.point)
            G = np.zeros((6, 0))
            if part.stop > part.start:
                G = contact.wrench_map(tick)
                forces[:, part] = frame.jacobian.T @ (units.force * G)
                if contact.form == "unilateral":
                    E = contact.force_equalities(tick)
                    rows = np.zeros((len(E), forces.shape[1]))
                    rows[:, part] = E
                    pressures.append(rows)
            maps.append(G)
            of = list(contact.held)
            held.append(len(of))
            if of:
                wanted = contact.acceleration(tick) - frame.drift
                jacobians.append(frame.jacobian if len(of) == 6 else frame.jacobian[of])
                accelerations.append(wanted if len(of) == 6 else wanted[of])
        pressure = np.concatenate(pressures) if pressures else np.empty((0, forces.shape[1]))
        return cls(parts, maps, forces, pressure, np.concatenate(jacobians), np.concatenate(accelerations), held)


def condensed(tick: Tick, touch: Touch) -> Form | None:
    """The condensed form; None where the contacts cannot bear any wrench, or ask for the impossible."""
    nv = tick.robot.nv
    M, G = tick.M, touch.forces
    nf = G.shape[1]
    contact = project(touch.jacobian, RANK_TOLERANCE)
    start = contact.least_squares(touch.acceleration)
    if contact.rank < len(touch.acceleration):
        miss = np.abs(touch.jacobian @ start - touch.acceleration).max()
        if miss > RANK_TOLERANCE * (1.0 + np.abs(touch.acceleration).max()):
            return None
    N = contact.remaining(np.eye(nv, order="F"))
    bearing = np.concatenate([G[:6], touch.pressure]) if len(touch.pressure) else G[:6]
    base = project(bearing, RANK_TOLERANCE)
    if base.rank < len(bearing):
        return None
    nu = N.shape[1]
    K = base.remaining(np.eye(nf, order="F"))
    MN = M @ N
    fixed = M @ start + tick.h
    needed = np.zeros((len(bearing), nu + 1))
    needed[:6, :nu], needed[:6, nu] = MN[:6], fixed[:6]
    borne = base.right_inverse(needed)
    size = nu + K.shape[1]
    force = np.empty((nf, size))
    force[:, :nu], force[:, nu:] = borne[:, :nu], K
    offset = borne[:, nu]
    torque = G[6:] @ -force
    torque[:, :nu] += MN[6:]
    return Form(size, nu, N, start, torque, fixed[6:] - G[6:] @ offset, force, offset)


def full(tick: Tick, contacts: Sequence[Contact], touch: Touch, units: Units) -> Form:
    """The paper's form."""
    nv, na, nf = tick.robot.nv, tick.robot.na, touch.forces.shape[1]
    size = nv + na + nf
    torque, force = np.zeros((na, size)), np.zeros((nf, size))
    torque[:, nv : nv + na] = units.torque * np.eye(na)
    force[:, nv + na :] = np.eye(nf)
    form = Form(size, nv, np.eye(nv), np.zeros(nv), torque, np.zeros(na), force, np.zeros(nf))
    motion = np.concatenate([tick.M, np.zeros((nv, na)), -touch.forces], axis=1)
    motion[6:] -= torque
    share = 1.0 / units.weight
    form.equalities.append(Equality(Block("Dynamics", "N", share, True, slice(0)), share * motion, -share * tick.h))
    start = 0
    for contact, held in zip(contacts, touch.held, strict=True):
        if held:
            rows = np.zeros((held, size))
            rows[:, :nv] = touch.jacobian[start : start + held]
            block = Block(f"Contact {contact.point}", "m/s²", 1.0, True, slice(0))
            form.equalities.append(Equality(block, rows, touch.acceleration[start : start + held]))
            start += held
    if len(touch.pressure):
        block = Block("Pressure", "N", 1.0 / units.force, True, slice(0))
        form.equalities.append(Equality(block, touch.pressure @ force, np.zeros(len(touch.pressure))))
    return form
