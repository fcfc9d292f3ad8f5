"""The variables x of a tick, and the rows of tasks and limits in them.

The *full* form is the paper's, x = (v̇, φ, τ): the equation of motion ``M v̇ + h = Sᵀ τ + Jᵀ φ``, Ramos (10) with
forces on the robot, is level 0's business altogether. Of a system of robot and things, M, h and J are those of Otani
(17)-(21): the things' rows come after the robot's, and where a joint has a motor, its torque is one of τ.

The *condensed* form drops the torques, which the driven joints' rows of that equation give: x = (v̇, φ). The rows of
the robot's base and of things without motors are left as equalities. Those of a thing that no contact touches hold no
force: they are rows on v̇ alone in either form.

Either way they come after the contacts' ``J_c v̇ = a_c`` and can be answered by the variables that come after v̇: the
structure that `solvers.reduction` asks for.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Block, Rows
from sot.control.task import Variable
from sot.gravity import GRAVITY
from sot.robots.robot import Robot
from sot.robots.system import System

Array = np.ndarray


@dataclass(frozen=True, slots=True)
class Units:
    """Units of forces and torques among the variables, so that one tolerance fits all rows.

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


def variable_counts(system: System, forces: int) -> dict[Variable, tuple[int, ...]]:
    """Numbers of columns that rows in each kind of variable may have, with so many force variables.

    Rows in accelerations or torques may leave out the things', which come last.
    """
    robot = system.robot
    return {"acceleration": (system.nv, robot.nv), "torque": (system.na, robot.na), "force": (forces,)}


class Form(ABC):
    """The variables of a tick.

    Args:
        system: The robot, with or without things.
        units: Of forces and torques in x.
        forces: Number of force variables φ.
        untouched: Velocities of things without motors that no contact touches.

    Attributes:
        size: Number of variables.
        counts: Numbers of columns that tasks' rows may have, by kind of variable.
        variables: First index and unit of each kind of variable that tasks may be about.
        equation_scale: Scale of the rows of the equation of motion [1/N].
        motion: ``M v̇ − Jᵀ φ`` as a matrix on (v̇, φ), φ in `Units.force`, shape (nv, nv + forces); to be filled in.
        bias: h, shape (nv,) [N, N m].
    """

    def __init__(self, system: System, units: Units, forces: int, untouched: Sequence[int] = ()) -> None:
        self.units, self.nv, self.na, self.forces = units, system.nv, system.na, forces
        self.counts = variable_counts(system, forces)
        self.size, self.equation_scale = self._size(), 1.0 / units.weight
        self.variables: dict[Variable, tuple[int, float]] = {"acceleration": (0, 1.0), "force": (self.nv, units.force)}
        self.motion = np.empty((self.nv, self.nv + forces))
        self.bias = np.empty(self.nv)
        self._driven, self._untouched = _as_slice(system.driven), _as_slice(np.array(untouched, dtype=int))
        self._rows = _as_slice(np.setdiff1d(self._coupled(system), untouched))
        self._labels = [_row_label(system, k) for k in np.arange(self.nv)[self._rows]]
        self._untouched_labels = [_row_label(system, int(k)) for k in untouched]

    def torque_rows(self, rows: Rows) -> tuple[Array, Array]:
        """Matrix B and offset c that express a task's ``A τ`` as ``B (v̇, φ) + c``, by the equation of motion."""
        motion, bias = self.motion[self._driven], self.bias[self._driven]
        if rows.selects is None:
            count = rows.A.shape[1]
            return rows.A @ motion[:count], rows.A @ bias[:count]
        return motion[rows.selects], bias[rows.selects]

    def equation_block(self) -> Block:
        """Block that names the rows of `equation`."""
        return Block("Dynamics", "N", self.equation_scale, True, slice(0), labels=self._labels)

    def untouched_block(self) -> Block:
        """Block that names the rows of `untouched_equation`."""
        return Block("Dynamics untouched", "N", self.equation_scale, True, slice(0), labels=self._untouched_labels)

    @abstractmethod
    def equation(self) -> tuple[Array, Array]:
        """Matrix A and vector b of the rows of the equation of motion in level 0, ``equation_scale A x = b``."""

    def untouched_equation(self) -> tuple[Array, Array]:
        """The same of things that nothing touches, on v̇ alone."""
        return self.motion[self._untouched, : self.nv], -self.equation_scale * self.bias[self._untouched]

    @abstractmethod
    def torque(self, x: Array) -> Array:
        """τ of a solution, shape (na,) [N m]."""

    @abstractmethod
    def _size(self) -> int: ...

    @abstractmethod
    def _coupled(self, system: System) -> Array:
        """Velocities whose rows of the equation of motion level 0 has."""


class Condensed(Form):
    """x = (v̇, φ)."""

    def _size(self) -> int:
        return self.nv + self.forces

    def _coupled(self, system: System) -> Array:
        return system.undriven

    def equation(self) -> tuple[Array, Array]:
        """The rows of the base and of things without motors."""
        return self.motion[self._rows], -self.equation_scale * self.bias[self._rows]

    def torque(self, x: Array) -> Array:
        """Torques by the driven joints' rows of the equation of motion."""
        return _joint_torques(self.motion[self._driven], self.bias[self._driven], x)


class Full(Form):
    """x = (v̇, φ, τ), τ in `Units.torque`."""

    def __init__(self, system: System, units: Units, forces: int, untouched: Sequence[int] = ()) -> None:
        super().__init__(system, units, forces, untouched)
        self.variables["torque"] = (self.nv + forces, units.torque)
        torques = np.zeros((self.nv, self.na))
        torques[system.driven, np.arange(self.na)] = -units.torque
        self._torques = torques[self._rows]

    def _size(self) -> int:
        return self.nv + self.forces + self.na

    def _coupled(self, system: System) -> Array:
        return np.arange(self.nv)

    def equation(self) -> tuple[Array, Array]:
        """All rows."""
        return np.hstack([self.motion[self._rows], self._torques]), -self.equation_scale * self.bias[self._rows]

    def torque(self, x: Array) -> Array:
        """Torques as they are among the variables."""
        return self.units.torque * x[self.nv + self.forces :]


@compiled
def _joint_torques(motion: Array, bias: Array, x: Array) -> Array:
    torque = bias.copy()
    for k in range(len(torque)):
        for i in range(len(x)):
            torque[k] += motion[k, i] * x[i]
    return torque


def _as_slice(indices: Array) -> slice | Array:
    """A run of indices as a slice, which makes views; others as they are."""
    if len(indices) and np.array_equal(indices, np.arange(indices[0], indices[-1] + 1)):
        return slice(int(indices[0]), int(indices[-1]) + 1)
    return indices


def _row_label(system: System, velocity: int) -> str:
    """Name of a velocity's row of the equation of motion."""
    if velocity < len(_BASE_ROW_LABELS):
        return _BASE_ROW_LABELS[velocity]
    joint = int(np.searchsorted(system.model.idx_vs, velocity, side="right")) - 1
    name, start = system.model.names[joint], system.model.idx_vs[joint]
    return name if system.model.nvs[joint] == 1 else f"{name} {_BASE_ROW_LABELS[velocity - start]}"


_BASE_ROW_LABELS = ("force x", "force y", "force z", "moment x", "moment y", "moment z")
