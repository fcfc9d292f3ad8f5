"""A tick's levels in the variables of one form, and the answer in the robot's words."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from solvers.rows import Level
from sot.contact import Contact
from sot.forms import Condensed, Form, Full, Units
from sot.layout import Layout
from sot.robot import Robot
from sot.task import Task
from sot.tick import Tick

Array = np.ndarray
FormName = Literal["condensed", "full"]

_FORMS: dict[FormName, type[Form]] = {"condensed": Condensed, "full": Full}


@dataclass(slots=True)
class Decoded:
    """A solution in the robot's words.

    Args:
        acceleration: v̇, shape (nv,).
        torque: τ, shape (na,) [N m].
        forces: φ of each contact [N].
        wrenches: Wrench of the floor on each contact's point, world axes, shape (contacts, 6) [N, N m].
    """

    acceleration: Array
    torque: Array
    forces: list[Array]
    wrenches: Array


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
        self._layout: Layout | None = None
        self._key: list[object] = []

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
        every = [("hard", hard), *levels]
        rows = [task.rows(tick) for _, tasks in every for task in tasks]
        key: list[object] = [*contacts, *[contact.mode for contact in contacts], *[len(own.lower) for own in rows]]
        for name, tasks in every:
            key += [name, *tasks]
        if self._layout is None or key != self._key:
            form = _FORMS[self.name](self.robot, self.units, sum(contact.force_count for contact in contacts))
            self._layout, self._key = Layout(form, contacts, every, rows), key
        form = self._layout.form
        form.motion[:, : form.nv], form.bias = tick.M.T, tick.h  # M is symmetric, and so it lies in memory like motion
        return self._layout.write(tick, rows)

    def decode(self, x: Array) -> Decoded:
        """Read a solution of the levels that were assembled last."""
        assert self._layout is not None
        layout, form = self._layout, self._layout.form
        forces, wrenches = [_NO_FORCE] * layout.contacts, np.zeros((layout.contacts, 6))
        for k, footing in layout.footings:
            forces[k] = x[footing.columns] * self.units.force
            np.matmul(footing.map, forces[k], out=wrenches[k])
        return Decoded(x[: form.nv], form.torque(x), forces, wrenches)


_NO_FORCE = np.zeros(0)
