"""Level 0 and the variables: the equation of motion, contacts and their forces, in two equal forms.

The *full* form solves for x = (v̇, τ, φ) under ``M v̇ + h = Sᵀ τ + Jᵀ φ``, as in the paper (Ramos (10) with forces on
the robot). The *condensed* form removes τ and the rows that define it,

    τ = S (M v̇ + h − Jᵀ φ),        0 = (M v̇ + h − Jᵀ φ) of the base,

and solves for x = (v̇, φ). Rows on τ become rows on x. Both give the same answer; the condensed one is the faster.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from solvers.rows import Block, Level, Rows
from sot.contact import Contact
from sot.robot import Robot
from sot.task import Task
from sot.tick import GRAVITY, Tick

Array = np.ndarray
FormName = Literal["condensed", "full"]


@dataclass(slots=True)
class Decoded:
    """A solution in the robot's words.

    Args:
        acceleration: v̇, shape (nv,).
        torque: τ, shape (na,) [N m].
        forces: φ of each contact [N].
        wrenches: Wrench of the floor on each contact's point, world axes, shapes (6,) [N, N m].
    """

    acceleration: Array
    torque: Array
    forces: list[Array]
    wrenches: list[Array]


FRICTION_GIVES_WAY = 3
"""Place of the friction pyramids in the order in which level 0 is relaxed: the last."""


class Dynamics:
    """Builds a tick's levels in the variables of one form, and reads the answer back.

    Args:
        robot: The robot.
        form: "condensed" or "full".
    """

    def __init__(self, robot: Robot, form: FormName = "condensed") -> None:
        self.robot, self.form = robot, form
        self.weight = robot.mass * GRAVITY
        # Forces are counted in shares of the weight and torques against what the robot has, so that one tolerance
        # fits all rows.
        self.force_unit = self.weight / 8.0
        self.torque_unit = float(np.median(robot.effort))

    def assemble(
        self,
        tick: Tick,
        contacts: Sequence[Contact],
        hard: Sequence[Task],
        levels: Sequence[tuple[str, Sequence[Task]]],
    ) -> list[Level]:
        """Level 0 (equation of motion, contacts, `hard`) and the levels below it.

        Args:
            tick: The state.
            contacts: Contacts, those that are off included.
            hard: Limits of level 0.
            levels: Names and tasks of the levels below, in order.
        """
        self._prepare(tick, contacts)
        return [self._hard(tick, contacts, hard), *(self._level(name, tasks, tick) for name, tasks in levels)]

    def decode(self, x: Array) -> Decoded:
        """Read a solution of the levels that were assembled last."""
        nv = self.robot.nv
        acceleration = x[:nv].copy()
        phi = x[self._force] * self.force_unit
        if self.form == "full":
            torque = x[nv : nv + self.robot.na] * self.torque_unit
        else:
            torque = self._torque_map @ x + self._torque_offset
        forces = [phi[part] for part in self._parts]
        return Decoded(acceleration, torque, forces, [G @ f for G, f in zip(self._wrench_maps, forces, strict=True)])

    def _prepare(self, tick: Tick, contacts: Sequence[Contact]) -> None:
        """Force variables of this tick, and τ as a function of x in the condensed form."""
        nv, na = self.robot.nv, self.robot.na
        counts = [contact.force_count for contact in contacts]
        ends = np.cumsum([0, *counts])
        self._parts = [slice(a, b) for a, b in pairwise(ends)]
        first = nv if self.form == "condensed" else nv + na
        self._size = first + int(ends[-1])
        self._force = slice(first, self._size)
        self._jt = np.zeros((nv, int(ends[-1])))
        self._wrench_maps = []
        for contact, part in zip(contacts, self._parts, strict=True):
            G = contact.wrench_map(tick) if part.stop > part.start else np.zeros((6, 0))
            self._wrench_maps.append(G)
            if part.stop > part.start:
                self._jt[:, part] = tick.frame(contact.point).jacobian.T @ G
        self._jt *= self.force_unit
        if self.form == "condensed":
            self._torque_map = np.concatenate([tick.M[6:], -self._jt[6:]], axis=1)
            self._torque_offset = tick.h[6:]

    def _hard(self, tick: Tick, contacts: Sequence[Contact], hard: Sequence[Task]) -> Level:
        equal, bounded = _Stacked(self._size, True), _Stacked(self._size, False)
        nv, na = self.robot.nv, self.robot.na
        if self.form == "condensed":
            motion = np.concatenate([tick.M[:6], -self._jt[:6]], axis=1)
            offset = -tick.h[:6]
        else:
            motion = np.concatenate([tick.M, np.zeros((nv, na)), -self._jt], axis=1)
            motion[6:, nv : nv + na] = -self.torque_unit * np.eye(na)
            offset = -tick.h
        equal.add(motion / self.weight, offset / self.weight, Block("Dynamics", "N", 1.0 / self.weight, True, slice(0)))
        for contact, part in zip(contacts, self._parts, strict=True):
            if held := contact.held:
                of = list(held)
                rows = np.zeros((len(of), self._size))
                frame = tick.frame(contact.point)
                rows[:, :nv] = frame.jacobian[of]
                wanted = (contact.acceleration(tick) - frame.drift)[of]
                equal.add(rows, wanted, Block(f"Contact {contact.point}", "m/s²", 1.0, True, slice(0)))
            if part.stop > part.start:
                columns = slice(self._force.start + part.start, self._force.start + part.stop)
                unit = 1.0 / self.force_unit
                if len(E := contact.force_equalities(tick)):
                    rows = np.zeros((len(E), self._size))
                    rows[:, columns] = E
                    equal.add(rows, np.zeros(len(E)), Block(f"Pressure {contact.point}", "N", unit, True, slice(0)))
                F, low, high = contact.force_inequalities(2.0 * self.weight)
                rows = np.zeros((len(F), self._size))
                rows[:, columns] = F
                label = Block(f"Friction {contact.point}", "N", unit, False, slice(0), FRICTION_GIVES_WAY)
                bounded.add(rows, low * unit, label, high * unit)
        for task in hard:
            self._add(task, tick, equal, bounded)
        return _level("hard", equal, bounded)

    def _level(self, name: str, tasks: Sequence[Task], tick: Tick) -> Level:
        equal, bounded = _Stacked(self._size, True), _Stacked(self._size, False)
        for task in tasks:
            self._add(task, tick, equal, bounded)
        return _level(name, equal, bounded)

    def _add(self, task: Task, tick: Tick, equal: "_Stacked", bounded: "_Stacked") -> None:
        rows = task.rows(tick)
        matrix, low, high = self._columns(task, rows)
        block = Block(task.name, task.unit, rows.weight, task.equality, slice(0), task.gives_way)
        (equal if task.equality else bounded).add(matrix, low, block, high)

    def _columns(self, task: Task, rows: Rows) -> tuple[Array, Array, Array]:
        """A task's rows, weighted, in the columns of x."""
        nv, w = self.robot.nv, rows.weight
        low = w * rows.lower
        high = low if task.equality else w * rows.upper
        if task.on == "torque" and self.form == "condensed":
            shift = w * (rows.A @ self._torque_offset)
            return (w * rows.A) @ self._torque_map, low - shift, high - shift
        A = np.zeros((len(low), self._size))
        if task.on == "acceleration":
            A[:, :nv] = w * rows.A
        elif task.on == "torque":
            A[:, nv : nv + self.robot.na] = (w * self.torque_unit) * rows.A
        else:
            A[:, self._force] = (w * self.force_unit) * rows.A
        return A, low, high


class _Stacked:
    """Rows of one level and kind, gathered."""

    __slots__ = ("blocks", "equality", "high", "low", "matrices", "size")

    def __init__(self, size: int, equality: bool) -> None:
        self.size, self.equality = size, equality
        self.matrices: list[Array] = []
        self.low: list[Array] = []
        self.high: list[Array] = []
        self.blocks: list[Block] = []

    def add(self, matrix: Array, low: Array, block: Block, high: Array | None = None) -> None:
        start = self.blocks[-1].rows.stop if self.blocks else 0
        block.rows = slice(start, start + len(low))
        self.blocks.append(block)
        self.matrices.append(matrix)
        self.low.append(low)
        if high is not None:
            self.high.append(high)

    def matrix(self) -> Array:
        if len(self.matrices) == 1:
            return self.matrices[0]
        return np.concatenate(self.matrices) if self.matrices else np.empty((0, self.size))


def _joined(parts: list[Array]) -> Array:
    if len(parts) == 1:
        return parts[0]
    return np.concatenate(parts) if parts else np.empty(0)


def _level(name: str, equal: _Stacked, bounded: _Stacked) -> Level:
    return Level(
        name,
        equal.matrix(),
        _joined(equal.low),
        bounded.matrix(),
        _joined(bounded.low),
        _joined(bounded.high),
        equal.blocks + bounded.blocks,
    )
