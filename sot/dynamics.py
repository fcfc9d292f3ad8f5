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
        nv, na, n = self.robot.nv, self.robot.na, self._size
        if self.form == "condensed":
            motion = np.concatenate([tick.M[:6], -self._jt[:6]], axis=1) / self.weight
            offset = -tick.h[:6] / self.weight
        else:
            motion = np.zeros((nv, n))
            motion[:, :nv] = tick.M
            motion[6:, nv : nv + na] = -self.torque_unit * np.eye(na)
            motion[:, self._force] = -self._jt
            motion /= self.weight
            offset = -tick.h / self.weight
        A, b = [motion], [offset]
        blocks = [Block("Dynamics", "N", 1.0 / self.weight, True, slice(0, len(offset)))]
        C, lower, upper = [], [], []
        top = 0
        for contact, part in zip(contacts, self._parts, strict=True):
            held = list(contact.held)
            if held:
                rows = np.zeros((len(held), n))
                frame = tick.frame(contact.point)
                rows[:, :nv] = frame.jacobian[held]
                A.append(rows)
                b.append((contact.acceleration(tick) - frame.drift)[held])
                start = blocks[-1].rows.stop
                blocks.append(Block(f"Contact {contact.point}", "m/s²", 1.0, True, slice(start, start + len(held))))
            if part.stop > part.start:
                columns = slice(self._force.start + part.start, self._force.start + part.stop)
                E = contact.force_equalities(tick)
                if len(E):
                    rows = np.zeros((len(E), n))
                    rows[:, columns] = E
                    A.append(rows)
                    b.append(np.zeros(len(E)))
                    start = blocks[-1].rows.stop
                    blocks.append(Block(f"Pressure {contact.point}", "N", 1.0, True, slice(start, start + len(E))))
                F, low, high = contact.force_inequalities(2.0 * self.weight)
                rows = np.zeros((len(F), n))
                rows[:, columns] = F
                C.append(rows)
                lower.append(low / self.force_unit)
                upper.append(high / self.force_unit)
                where = slice(top, top + len(F))
                blocks.append(Block(f"Friction {contact.point}", "N", 1.0 / self.force_unit, False, where, 3))
                top = where.stop
        equalities = sum(len(part) for part in b)
        for task in hard:
            rows = task.rows(tick)
            matrix, low, high = self._columns(task, rows)
            if task.equality:
                A.append(matrix)
                b.append(low)
                where = slice(equalities, equalities + len(low))
                equalities = where.stop
            else:
                C.append(matrix)
                lower.append(low)
                upper.append(high)
                where = slice(top, top + len(low))
                top = where.stop
            blocks.append(Block(task.name, task.unit, rows.weight, task.equality, where, task.gives_way))
        return Level(
            "hard",
            np.concatenate(A),
            np.concatenate(b),
            np.concatenate([np.zeros((0, n)), *C]),
            np.concatenate([np.zeros(0), *lower]),
            np.concatenate([np.zeros(0), *upper]),
            blocks,
        )

    def _level(self, name: str, tasks: Sequence[Task], tick: Tick) -> Level:
        equal, bounded = [], []
        blocks = []
        m = p = 0
        for task in tasks:
            rows = task.rows(tick)
            matrix, low, high = self._columns(task, rows)
            if task.equality:
                equal.append((matrix, low))
                where = slice(m, m := m + len(low))
            else:
                bounded.append((matrix, low, high))
                where = slice(p, p := p + len(low))
            blocks.append(Block(task.name, task.unit, rows.weight, task.equality, where))
        none = np.zeros((0, self._size))
        return Level(
            name,
            np.concatenate([none, *(A for A, _ in equal)]),
            np.concatenate([none[:, 0], *(b for _, b in equal)]),
            np.concatenate([none, *(C for C, _, _ in bounded)]),
            np.concatenate([none[:, 0], *(low for _, low, _ in bounded)]),
            np.concatenate([none[:, 0], *(high for _, _, high in bounded)]),
            blocks,
        )

    def _columns(self, task: Task, rows: Rows) -> tuple[Array, Array, Array]:
        """A task's rows, weighted, in the columns of x."""
        nv, w = self.robot.nv, rows.weight
        low, high = w * rows.lower, w * rows.upper
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
