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
from typing import NamedTuple

import numpy as np

from solvers.rows import Block, Rows
from sot.robot import Robot
from sot.task import On
from sot.tick import GRAVITY

Array = np.ndarray


@dataclass(frozen=True, slots=True)
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


class Linear(NamedTuple):
    """``y = (scale / weight) A x[start : start + k] + offset``, with the weight of the task's rows.

    Where `selects` is given, A is these rows of the identity; no offset is 0."""

    A: Array
    scale: float
    start: int = 0
    selects: slice | None = None
    offset: Array | None = None


class Form(ABC):
    """The variables of a tick.

    Args:
        robot: The robot.
        units: Of forces and torques in x.
        forces: Number of force variables φ.

    Attributes:
        size: Number of variables.
        share: Scale of the equation of motion's rows [1/N].
        motion: ``M v̇ − Jᵀ φ`` as a matrix on (v̇, φ), φ in `Units.force`, shape (nv, nv + forces); to be filled in.
        bias: h, shape (nv,) [N, N m].
    """

    def __init__(self, robot: Robot, units: Units, forces: int) -> None:
        self.units, self.nv, self.na, self.forces = units, robot.nv, robot.na, forces
        self.size, self.share = self._size(), 1.0 / units.weight
        self.motion = np.empty((robot.nv, robot.nv + forces))
        self.bias = np.empty(robot.nv)

    def seen(self, on: On, rows: Rows) -> Linear:
        """What a task's rows are about, ``A y`` with y accelerations, torques or forces, as a function of x."""
        if on == "acceleration":
            return Linear(rows.A, rows.weight, 0, rows.selects)
        if on == "force":
            return Linear(rows.A, rows.weight * self.units.force, self.nv, rows.selects)
        return self._torques(rows)

    def block(self) -> Block:
        """Whose the rows of `equation` are."""
        return Block("Dynamics", "N", self.share, True, slice(0), labels=_OF_BASE)

    @abstractmethod
    def equation(self) -> tuple[Array, Array]:
        """What the equation of motion leaves to level 0, ``share A x = b``: A and b."""

    @abstractmethod
    def torque(self, x: Array) -> Array:
        """τ of a solution, shape (na,) [N m]."""

    @abstractmethod
    def _size(self) -> int: ...

    @abstractmethod
    def _torques(self, rows: Rows) -> Linear: ...


class Condensed(Form):
    """x = (v̇, φ)."""

    def _size(self) -> int:
        return self.nv + self.forces

    def equation(self) -> tuple[Array, Array]:
        """The base's rows."""
        return self.motion[:6], -self.share * self.bias[:6]

    def torque(self, x: Array) -> Array:
        """From the joints' rows."""
        return self.motion[6:] @ x + self.bias[6:]

    def _torques(self, rows: Rows) -> Linear:
        if rows.selects is None:
            return Linear(rows.A @ self.motion[6:], rows.weight, offset=rows.A @ self.bias[6:])
        joints = slice(6 + rows.selects.start, 6 + rows.selects.stop)
        return Linear(self.motion[joints], rows.weight, offset=self.bias[joints])


class Full(Form):
    """x = (v̇, φ, τ), τ in `Units.torque`."""

    def _size(self) -> int:
        return self.nv + self.forces + self.na

    def equation(self) -> tuple[Array, Array]:
        """All rows."""
        driven = np.zeros((self.nv, self.na))
        driven[6:] = -self.units.torque * np.eye(self.na)
        return np.hstack([self.motion, driven]), -self.share * self.bias

    def torque(self, x: Array) -> Array:
        """As they stand there."""
        return self.units.torque * x[self.nv + self.forces :]

    def _torques(self, rows: Rows) -> Linear:
        return Linear(rows.A, rows.weight * self.units.torque, self.nv + self.forces, rows.selects)


_OF_BASE = ("force x", "force y", "force z", "moment x", "moment y", "moment z")
