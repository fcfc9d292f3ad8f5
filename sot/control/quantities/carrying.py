"""Centre of mass and momentum of the robot and of the things that it carries, Otani (33), in a system of many trees."""

from collections.abc import Collection

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.robots.system import System

Array = np.ndarray
ROBOT_BASE = 1


class Carrying:
    """Counts the robot and what it carries, and leaves out all else that is in the system.

    Args:
        system: Of the robot and of things that move.
        data: Pinocchio's, with what `crba` in world axes and the nonlinear effects leave.

    Attributes:
        com: Centre of mass (3,) [m].
        A_g: Matrix of the momentum about it, linear over angular, world axes, (6, nv).
        rate: Ȧ_g v (6,).
    """

    def __init__(self, system: System, data: pin.Data) -> None:
        self._system, self._data = system, data
        self.com, self.A_g, self.rate = np.empty(3), np.zeros((6, system.nv)), np.empty(6)
        self._roots = {thing.name: system.model.getJointId(thing.model.names[1]) for thing in system.moving_things}
        self.choose(())

    def choose(self, carried: Collection[str]) -> None:
        """Say which things are carried.

        Raises:
            InputError: If there is no such thing, or it is not free.
        """
        system = self._system
        for name in carried:
            if not system.thing(name).is_free:
                raise InputError(f"'{name}' is fixed to the world and cannot be carried")
        self._joints = [ROBOT_BASE, *(self._roots[name] for name in carried)]
        self._starts = np.array([system.model.idx_vs[joint] for joint in self._joints])
        self._counted = np.zeros(system.nv, dtype=bool)
        self._counted[: system.robot.nv] = True
        for name in carried:
            self._counted[system.velocities[name]] = True
        self.thing_mass = float(sum(system.thing(name).mass for name in carried))

    def update(self) -> None:
        """Compute all anew from Pinocchio's data."""
        data = self._data
        inertias = [data.oYcrb[joint] for joint in self._joints]
        masses, coms = np.array([own.mass for own in inertias]), np.array([own.lever for own in inertias])
        places = [data.oMi[joint] for joint in self._joints]
        rotations, origins = np.array([p.rotation for p in places]), np.array([p.translation for p in places])
        _write_combined(
            *(masses, coms, rotations, origins, self._starts, data.nle, data.Ag, data.com[0], self._counted),
            *(self.com, self.A_g, self.rate),
        )


@compiled
def _write_combined(
    masses: Array,
    coms: Array,
    rotations: Array,
    origins: Array,
    starts: Array,
    forces: Array,
    A_all: Array,
    com_all: Array,
    counted: Array,
    com: Array,
    A_g: Array,
    rate: Array,
) -> None:
    """Write the centre of mass of several free trees, their momentum matrix about it and Ȧ_g v.

    Ȧ_g v is what has to act on the trees' roots from outside when v̇ is zero, seen from there, less the weight.
    """
    total = masses.sum()
    for i in range(3):
        com[i] = 0.0
        for n in range(len(masses)):
            com[i] += masses[n] * coms[n, i] / total
    x, y, z = com_all[0] - com[0], com_all[1] - com[1], com_all[2] - com[2]
    for k in range(A_g.shape[1]):
        if counted[k]:
            a, b, c = A_all[0, k], A_all[1, k], A_all[2, k]
            A_g[0, k], A_g[1, k], A_g[2, k] = a, b, c
            A_g[3, k] = A_all[3, k] + y * c - z * b
            A_g[4, k] = A_all[4, k] + z * a - x * c
            A_g[5, k] = A_all[5, k] + x * b - y * a
        else:
            A_g[:, k] = 0.0
    rate[:] = 0.0
    for n in range(len(masses)):
        R, own = rotations[n], forces[starts[n] : starts[n] + 6]
        fx, fy, fz = R[0] @ own[:3], R[1] @ own[:3], R[2] @ own[:3]
        mx, my, mz = R[0] @ own[3:], R[1] @ own[3:], R[2] @ own[3:]
        px, py, pz = origins[n, 0] - com[0], origins[n, 1] - com[1], origins[n, 2] - com[2]
        rate[0] += fx
        rate[1] += fy
        rate[2] += fz
        rate[3] += mx + py * fz - pz * fy
        rate[4] += my + pz * fx - px * fz
        rate[5] += mz + px * fy - py * fx
    rate[2] -= total * GRAVITY
