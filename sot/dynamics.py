"""A tick's levels in the variables of one form, and the answer in the robot's words."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from solvers.rows import Block, Equality, Level, Rows
from sot.contact import Contact
from sot.forms import Condensed, Form, Full, Units
from sot.robot import Robot
from sot.task import Task
from sot.tick import Tick

Array = np.ndarray
FormName = Literal["condensed", "full"]

FRICTION_GIVES_WAY = 3
"""Place of the friction pyramids in the order in which level 0 is relaxed: the last."""

_FORMS: dict[FormName, type[Form]] = {"condensed": Condensed, "full": Full}


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

    Level 0's matrices are kept from tick to tick and only what moves is written again: levels are valid until the next
    `assemble`.

    Args:
        robot: The robot.
        form: "condensed", the one that runs, or "full", the paper's; both give the same answer.
    """

    def __init__(self, robot: Robot, form: FormName = "condensed") -> None:
        self.robot, self.name = robot, form
        self.units = Units.of(robot)
        self._form = _FORMS[form](robot, self.units, 0)
        self._limits = _Limits(0, [])
        self._parts: list[slice] = []
        self._maps: list[Array] = []

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
        self._parts = [slice(a, b) for a, b in pairwise(_ends([contact.force_count for contact in contacts]))]
        count = self._parts[-1].stop if self._parts else 0
        if count != self._form.forces:
            self._form = _FORMS[self.name](self.robot, self.units, count)
        form, nv = self._form, self.robot.nv
        form.motion[:, :nv], form.bias = tick.M, tick.h
        equalities: list[Equality] = []
        blocks: list[Block] = []
        limits: list[_Limit] = []
        self._maps = []
        for contact, part in zip(contacts, self._parts, strict=True):
            if contact.mode == "off":
                self._maps.append(_NO_FORCE)
                continue
            frame, axes = tick.frame(contact.point), contact.held
            wanted = contact.acceleration(tick) - frame.drift
            J = frame.jacobian
            if len(axes) < 6:
                J, wanted = J[list(axes)], wanted[list(axes)]
            block = Block(f"Contact {contact.point}", "m/s²", 1.0, True, _ANY, labels=contact.axes)
            _add(equalities, blocks, block, Equality(J, wanted))
            if part.stop == part.start:
                self._maps.append(_NO_FORCE)
                continue
            G = contact.wrench_map(tick)
            self._maps.append(G)
            np.matmul(frame.jacobian.T, -self.units.force * G, out=form.motion[:, nv + part.start : nv + part.stop])
            limits.append(self._friction(contact, nv + part.start))
            E = contact.force_equalities(tick)
            if len(E):
                block = Block(f"Pressure {contact.point}", "N", 1.0 / self.units.force, True, _ANY)
                _add(equalities, blocks, block, Equality(E, np.zeros(len(E)), start=nv + part.start))
        for block, equality in form.equalities():
            _add(equalities, blocks, block, equality)
        self._ask(tick, hard, equalities, blocks, limits)
        if not self._limits.fits(form.size, limits):
            self._limits = _Limits(form.size, limits)
        self._limits.write(limits)
        blocks += self._limits.blocks
        first = Level("hard", form.size, equalities, self._limits.C, self._limits.lower, self._limits.upper, blocks)
        return [first, *(self._level(tick, name, tasks) for name, tasks in levels)]

    def decode(self, x: Array) -> Decoded:
        """Read a solution of the levels that were assembled last."""
        form = self._form
        phi = x[form.nv : form.nv + form.forces] * self.units.force
        forces = [phi[part] for part in self._parts]
        wrenches = [G @ f for G, f in zip(self._maps, forces, strict=True)]
        return Decoded(x[: form.nv], form.torque(x), forces, wrenches)

    def _level(self, tick: Tick, name: str, tasks: Sequence[Task]) -> Level:
        equalities: list[Equality] = []
        blocks: list[Block] = []
        limits: list[_Limit] = []
        self._ask(tick, tasks, equalities, blocks, limits)
        if not limits:
            return Level(name, self._form.size, equalities, _no_rows(self._form.size), _NOTHING, _NOTHING, blocks)
        own = _Limits(self._form.size, limits)
        own.write(limits)
        return Level(name, self._form.size, equalities, own.C, own.lower, own.upper, blocks + own.blocks)

    def _ask(
        self,
        tick: Tick,
        tasks: Sequence[Task],
        equalities: list[Equality],
        blocks: list[Block],
        limits: list["_Limit"],
    ) -> None:
        """Add the rows of some tasks: equalities with their blocks, and limits."""
        for task in tasks:
            rows = task.rows(tick)
            if task.equality:
                _add(equalities, blocks, _block(task), self._equality(task, rows))
            else:
                limits.append(self._limit(task, rows))

    def _equality(self, task: Task, rows: Rows) -> Equality:
        seen = self._form.seen(task.on, rows)
        wanted = rows.lower if task.on != "torque" else rows.lower - seen.offset
        if rows.weight != 1.0:
            wanted = rows.weight * wanted
        return Equality(seen.A, wanted, seen.scale, seen.start, seen.selects)

    def _limit(self, task: Task, rows: Rows) -> "_Limit":
        seen, lower, upper = self._form.seen(task.on, rows), rows.lower, rows.upper
        constant = rows.selects is not None and seen.selects is not None
        if task.on == "torque":
            lower, upper = lower - seen.offset, upper - seen.offset
        return _Limit(_block(task), seen.A, seen.scale, seen.start, constant, lower, upper, rows.weight)

    def _friction(self, contact: Contact, start: int) -> "_Limit":
        F, lower, upper = contact.force_inequalities(self.units.weight)
        share = 1.0 / self.units.force
        block = Block(
            f"Friction {contact.point}", "N", share, False, _ANY, FRICTION_GIVES_WAY, contact.force_labels(len(F))
        )
        return _Limit(block, F, 1.0, start, True, lower, upper, share)


@dataclass(slots=True)
class _Limit:
    """Inequalities ``share lower <= scale A x[start : ...] <= share upper``; `constant` if A never changes."""

    block: Block
    A: Array
    scale: float
    start: int
    constant: bool
    lower: Array
    upper: Array
    share: float = 1.0


class _Limits:
    """The inequalities of a level, one below the other."""

    def __init__(self, size: int, limits: Sequence[_Limit]) -> None:
        self._size, self._layout = size, [_layout(limit) for limit in limits]
        self._constants = [limit.A for limit in limits]  # kept alive: the layout knows them by their identity
        self._rows = [slice(a, b) for a, b in pairwise(_ends([len(limit.lower) for limit in limits]))]
        count = self._rows[-1].stop if self._rows else 0
        self.C, self.lower, self.upper = np.zeros((count, size)), np.empty(count), np.empty(count)
        for limit, rows in zip(limits, self._rows, strict=True):
            if limit.constant:
                self._write(limit, rows)
        self.blocks: list[Block] = []
        self._bounds: list[Array | None] = [None] * len(limits)  # whose numbers stand there

    def fits(self, size: int, limits: Sequence[_Limit]) -> bool:
        """Whether these are the same rows as last time, with other numbers."""
        return size == self._size and self._layout == [_layout(limit) for limit in limits]

    def write(self, limits: Sequence[_Limit]) -> None:
        """Take over the numbers of a tick."""
        self.blocks = []
        for k, (limit, rows) in enumerate(zip(limits, self._rows, strict=True)):
            if not limit.constant:
                self._write(limit, rows)
            if limit.upper is not self._bounds[k] or limit.upper.flags.writeable:
                np.multiply(limit.lower, limit.share, out=self.lower[rows])
                np.multiply(limit.upper, limit.share, out=self.upper[rows])
                self._bounds[k] = limit.upper
            limit.block.rows = rows
            self.blocks.append(limit.block)

    def _write(self, limit: _Limit, rows: slice) -> None:
        np.multiply(limit.A, limit.scale, out=self.C[rows, limit.start : limit.start + limit.A.shape[1]])


def _layout(limit: _Limit) -> tuple[str, int, int, float, int]:
    return limit.block.name, len(limit.lower), limit.start, limit.scale, id(limit.A) if limit.constant else 0


def _block(task: Task) -> Block:
    return Block(task.name, task.unit, task.weight, task.equality, _ANY, task.gives_way, task.labels)


def _add(equalities: list[Equality], blocks: list[Block], block: Block, equality: Equality) -> None:
    start = blocks[-1].rows.stop if blocks else 0
    block.rows = slice(start, start + len(equality.b))
    blocks.append(block)
    equalities.append(equality)


def _ends(counts: Sequence[int]) -> list[int]:
    """Where runs of these lengths end, after a 0."""
    ends = [0]
    for count in counts:
        ends.append(ends[-1] + count)
    return ends


def _no_rows(size: int) -> Array:
    return np.empty((0, size))


_ANY = slice(0)
_NOTHING = np.empty(0)
_NO_FORCE = np.zeros((6, 0))
