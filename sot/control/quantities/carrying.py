"""Centre of mass and momentum of the robot and of the things that it carries, Otani (33), in a system of many trees."""

from collections.abc import Collection

import numpy as np
import pinocchio as pin

from solvers.compiled import compiled
from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.robots.system import System
from sot.vector_view import view_of_all

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
        self._system = system
        self._forces, self._A_all, self._com_all = data.nle, data.Ag, data.com[0]  # live views
        self._origins = view_of_all([place.translation for place in data.oMi], (3,))
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
        self._joints = np.array([ROBOT_BASE, *(self._roots[name] for name in carried)])
        self._starts = np.array([system.model.idx_vs[joint] for joint in self._joints.tolist()])
        self._counted = np.zeros(system.nv, dtype=bool)
        self._counted[: system.robot.nv] = True
        for name in carried:
            self._counted[system.velocities[name]] = True
        self._masses = np.array([0.0, *(system.thing(name).mass for name in carried)])
        self.thing_mass = float(self._masses.sum())

    def update(self, robot_mass: float) -> None:
        """Compute all anew from Pinocchio's data; the robot's mass [kg] is with the loads that are fixed to it."""
        self._masses[0] = robot_mass
        _write_combined(
            *(
                self._masses,
                self._joints,
                self._origins,
                self._starts,
                self._forces,
                self._A_all,
                self._com_all,
                self._counted,
            ),
            *(self.com, self.A_g, self.rate),
        )


@compiled
def _write_combined(
    masses: Array,
    joints: Array,
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

    A root's first three columns of A_g are m R over m [c − c_all]× R: they tell its axes R and its tree's centre of
    mass c. Ȧ_g v is what has to act on the roots from outside when v̇ is zero, seen from the common centre of mass,
    less the weight.
    """
    total, dx, dy, dz = 0.0, 0.0, 0.0, 0.0
    for n in range(len(masses)):
        m, s = masses[n], starts[n]
        total += m
        for k in range(s, s + 3):
            # m (c − c_all) from [m d]× R Rᵀ, entries (2, 1), (0, 2) and (1, 0).
            dx += A_all[5, k] * A_all[1, k] / m
            dy += A_all[3, k] * A_all[2, k] / m
            dz += A_all[4, k] * A_all[0, k] / m
    com[0], com[1], com[2] = com_all[0] + dx / total, com_all[1] + dy / total, com_all[2] + dz / total
    x, y, z = com_all[0] - com[0], com_all[1] - com[1], com_all[2] - com[2]
    for k in range(A_g.shape[1]):
        if counted[k]:
            a, b, c = A_all[0, k], A_all[1, k], A_all[2, k]
            A_g[0, k], A_g[1, k], A_g[2, k] = a, b, c
            A_g[3, k] = A_all[3, k] + y * c - z * b
            A_g[4, k] = A_all[4, k] + z * a - x * c
            A_g[5, k] = A_all[5, k] + x * b - y * a
        else:
            for i in range(6):
                A_g[i, k] = 0.0
    for i in range(6):
        rate[i] = 0.0
    for n in range(len(masses)):
        m, s = masses[n], starts[n]
        root = origins[joints[n]]
        px, py, pz = root[0] - com[0], root[1] - com[1], root[2] - com[2]
        fx = fy = fz = mx = my = mz = 0.0
        for k in range(3):
            f, t = forces[s + k] / m, forces[s + 3 + k] / m
            fx, fy, fz = fx + A_all[0, s + k] * f, fy + A_all[1, s + k] * f, fz + A_all[2, s + k] * f
            mx, my, mz = mx + A_all[0, s + k] * t, my + A_all[1, s + k] * t, mz + A_all[2, s + k] * t
        rate[0] += fx
        rate[1] += fy
        rate[2] += fz
        rate[3] += mx + py * fz - pz * fy
        rate[4] += my + pz * fx - px * fz
        rate[5] += mz + px * fy - py * fx
    rate[2] -= total * GRAVITY
