"""The variables x of a tick, and the rows of tasks and limits in them.

The *full* form is the paper's, x = (v̇, φ, τ): the equation of motion ``M v̇ + h = Sᵀ τ + Jᵀ φ``, Ramos (10) with
forces on the robot, is level 0's business altogether.

The *condensed* form drops the torques, which the joints' rows of that equation give: x = (v̇, φ). The base's six rows
are left as equalities.

Either way they come after the contacts' ``J_c v̇ = a_c`` and can be answered by the variables that come after v̇: the
structure that `solvers.reduction` asks for.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Block, Rows
from sot.control.task import Variable
from sot.gravity import GRAVITY
from sot.robots.robot import Robot

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


def variable_counts(robot: Robot, forces: int) -> dict[Variable, int]:
    """Number of variables of each kind that tasks may be about, with so many force variables."""
    return {"acceleration": robot.nv, "torque": robot.na, "force": forces}


class Form(ABC):
    """The variables of a tick.

    Args:
        robot: The robot.
        units: Of forces and torques in x.
        forces: Number of force variables φ.

    Attributes:
        size: Number of variables.
        counts: Number of variables of each kind that tasks may be about.
        variables: First index and unit of each kind of variable that tasks may be about.
        equation_scale: Scale of the rows of the equation of motion [1/N].
        motion: ``M v̇ − Jᵀ φ`` as a matrix on (v̇, φ), φ in `Units.force`, shape (nv, nv + forces); to be filled in.
        bias: h, shape (nv,) [N, N m].
    """

    def __init__(self, robot: Robot, units: Units, forces: int) -> None:
        self.units, self.nv, self.na, self.forces = units, robot.nv, robot.na, forces
        self.counts = variable_counts(robot, forces)
        self.size, self.equation_scale = self._size(), 1.0 / units.weight
        self.variables: dict[Variable, tuple[int, float]] = {"acceleration": (0, 1.0), "force": (robot.nv, units.force)}
        self.motion = np.empty((robot.nv, robot.nv + forces))
        self.bias = np.empty(robot.nv)

    def torque_rows(self, rows: Rows) -> tuple[Array, Array]:
        """Matrix B and offset c that express a task's ``A τ`` as ``B (v̇, φ) + c``, by the equation of motion."""
        if rows.selects is None:
            return rows.A @ self.motion[6:], rows.A @ self.bias[6:]
        joints = slice(6 + rows.selects.start, 6 + rows.selects.stop)
        return self.motion[joints], self.bias[joints]

    def equation_block(self) -> Block:
        """Block that names the rows of `equation`."""
        return Block("Dynamics", "N", self.equation_scale, True, slice(0), labels=_BASE_ROW_LABELS)

    @abstractmethod
    def equation(self) -> tuple[Array, Array]:
        """Matrix A and vector b of the rows of the equation of motion in level 0, ``equation_scale A x = b``."""

    @abstractmethod
    def torque(self, x: Array) -> Array:
        """τ of a solution, shape (na,) [N m]."""

    @abstractmethod
    def _size(self) -> int: ...


class Condensed(Form):
    """x = (v̇, φ)."""

    def _size(self) -> int:
        return self.nv + self.forces

    def equation(self) -> tuple[Array, Array]:
        """The six rows of the base."""
        return self.motion[:6], -self.equation_scale * self.bias[:6]

    def torque(self, x: Array) -> Array:
        """Torques by the joints' rows of the equation of motion."""
        return _joint_torques(self.motion, self.bias, x)


class Full(Form):
    """x = (v̇, φ, τ), τ in `Units.torque`."""

    def __init__(self, robot: Robot, units: Units, forces: int) -> None:
        super().__init__(robot, units, forces)
        self.variables["torque"] = (self.nv + forces, units.torque)

    def _size(self) -> int:
        return self.nv + self.forces + self.na

    def equation(self) -> tuple[Array, Array]:
        """All rows."""
        driven = np.zeros((self.nv, self.na))
        driven[6:] = -self.units.torque * np.eye(self.na)
        return np.hstack([self.motion, driven]), -self.equation_scale * self.bias

    def torque(self, x: Array) -> Array:
        """Torques as they are among the variables."""
        return self.units.torque * x[self.nv + self.forces :]


@compiled
def _joint_torques(motion: Array, bias: Array, x: Array) -> Array:
    torque = bias[6:].copy()
    for k in range(len(torque)):
        for i in range(len(x)):
            torque[k] += motion[6 + k, i] * x[i]
    return torque


_BASE_ROW_LABELS = ("force x", "force y", "force z", "moment x", "moment y", "moment z")
