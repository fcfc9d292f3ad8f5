"""A tick's levels in the variables of one form, and the answer in the robot's words."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from solvers.rows import Block, Level
from sot.contact import Contact
from sot.forms import Form, Touch, Units, condensed, full
from sot.robot import Robot
from sot.task import Task
from sot.tick import Tick

Array = np.ndarray
FormName = Literal["condensed", "full"]

FRICTION_GIVES_WAY = 3
"""Place of the friction pyramids in the order in which level 0 is relaxed: the last."""


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
    """Builds the levels that a solver solves: level 0, then the stack's.

    Args:
        robot: The robot.
        form: "condensed", the one that runs, or "full", the paper's; both give the same answer. Where the contacts
            cannot bear any wrench (in flight, say) the condensed form does not exist and the full one stands in.
    """

    def __init__(self, robot: Robot, form: FormName = "condensed") -> None:
        self.robot, self.name = robot, form
        self.units = Units.of(robot)

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
        self._touch = Touch.of(tick, contacts, self.units)
        form = condensed(tick, self._touch) if self.name == "condensed" else None
        self._form = form or full(tick, contacts, self._touch, self.units)
        first = _Rows("hard", self._form)
        for equality in self._form.equalities:
            first.equal(equality.block, equality.A, equality.b, self._form.size)
        for contact, part in zip(contacts, self._touch.parts, strict=True):
            if part.stop > part.start:
                self._friction(contact, part, first)
        for task in hard:
            first.task(task, tick, self.units)
        out = [first.level()]
        for name, tasks in levels:
            rows = _Rows(name, self._form)
            for task in tasks:
                rows.task(task, tick, self.units)
            out.append(rows.level())
        return out

    def decode(self, x: Array) -> Decoded:
        """Read a solution of the levels that were assembled last."""
        form, touch = self._form, self._touch
        phi = (form.force @ x + form.force_offset) * self.units.force
        forces = [phi[part] for part in touch.parts]
        return Decoded(
            form.acceleration @ x[: form.motion] + form.acceleration_offset,
            form.torque @ x + form.torque_offset,
            forces,
            [G @ f for G, f in zip(touch.wrench_maps, forces, strict=True)],
        )

    def _friction(self, contact: Contact, part: slice, rows: "_Rows") -> None:
        F, low, high = contact.force_inequalities(self.units.weight)
        share = 1.0 / self.units.force
        shift = F @ self._form.force_offset[part]
        block = Block(f"Friction {contact.point}", "N", share, False, slice(0), FRICTION_GIVES_WAY)
        rows.bounded(block, F @ self._form.force[part], share * low - shift, share * high - shift)


class _Rows:
    """Rows of one level, gathered in the variables of a form."""

    __slots__ = ("A", "C", "b", "blocks", "columns", "form", "high", "low", "m", "name", "p")

    def __init__(self, name: str, form: Form) -> None:
        self.name, self.form = name, form
        self.A: list[tuple[float, Array]] = []
        self.b: list[Array] = []
        self.C: list[tuple[float, Array]] = []
        self.low: list[Array] = []
        self.high: list[Array] = []
        self.blocks: list[Block] = []
        self.m = self.p = 0
        self.columns = form.motion

    def task(self, task: Task, tick: Tick, units: Units) -> None:
        """Add a task's rows, weighted."""
        rows, form = task.rows(tick), self.form
        weight, scale, columns = rows.weight, rows.weight, form.size
        if task.on == "acceleration":
            maps, offset, columns = form.acceleration, form.acceleration_offset, form.motion
        elif task.on == "torque":
            maps, offset = form.torque, form.torque_offset
        else:
            maps, offset, scale = form.force, form.force_offset, weight * units.force
        if rows.selects is None:
            matrix, shift = rows.A @ maps, rows.A @ offset
        else:
            matrix, shift = maps[rows.selects], offset[rows.selects]
        shift = scale * shift
        low = weight * rows.lower - shift
        block = Block(task.name, task.unit, weight, task.equality, slice(0), task.gives_way)
        if task.equality:
            self.equal(block, matrix, low, columns, scale)
        else:
            self.bounded(block, matrix, low, weight * rows.upper - shift, scale)

    def equal(self, block: Block, A: Array, b: Array, columns: int, scale: float = 1.0) -> None:
        """Add equalities ``scale A x = b`` that involve the leading `columns` variables."""
        block.rows = slice(self.m, self.m + len(b))
        self.m += len(b)
        self.columns = max(self.columns, columns)
        self.blocks.append(block)
        self.A.append((scale, A))
        self.b.append(b)

    def bounded(self, block: Block, C: Array, low: Array, high: Array, scale: float = 1.0) -> None:
        """Add inequalities ``low <= scale C x <= high``."""
        block.rows = slice(self.p, self.p + len(low))
        self.p += len(low)
        self.blocks.append(block)
        self.C.append((scale, C))
        self.low.append(low)
        self.high.append(high)

    def level(self) -> Level:
        """The level."""
        size = self.form.size
        return Level(
            self.name,
            _stacked(self.A, self.m, size),
            _joined(self.b),
            _stacked(self.C, self.p, size),
            _joined(self.low),
            _joined(self.high),
            self.blocks,
            self.columns,
        )


def _stacked(parts: list[tuple[float, Array]], count: int, size: int) -> Array:
    """Scaled matrices on top of each other, filled up with zero columns."""
    out = np.zeros((count, size))
    start = 0
    for scale, part in parts:
        end = start + len(part)
        np.multiply(part, scale, out=out[start:end, : part.shape[1]])
        start = end
    return out


def _joined(parts: list[Array]) -> Array:
    if len(parts) == 1:
        return parts[0]
    return np.concatenate(parts) if parts else np.empty(0)
