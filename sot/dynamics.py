"""A tick's levels in the variables of one form, and the answer in the robot's words."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Level
from sot.contact import Contact
from sot.forms import Condensed, Form, Full, Units
from sot.layout import Layout
from sot.robot import Robot
from sot.task import Task
from sot.tick import Tick

Array = np.ndarray
FormName = Literal["condensed", "full"]

LEAST_LOAD = 1.0
"""Without more than this on all contacts there is no zero-moment point [N]."""
_FORMS: dict[FormName, type[Form]] = {"condensed": Condensed, "full": Full}


@dataclass(slots=True)
class Decoded:
    """A solution in the robot's words.

    Args:
        acceleration: v̇, shape (nv,).
        torque: τ, shape (na,) [N m].
        forces: φ of each contact [N].
        wrenches: Wrench of the floor on each contact's point, world axes, shape (contacts, 6) [N, N m].
        zmp: Point of the floor about which these have no horizontal moment, shape (2,) [m]; nan without load. With all
            vertices on the floor it is the mean of them weighted by their normal forces, Ramos (11).
    """

    acceleration: Array
    torque: Array
    forces: list[Array]
    wrenches: Array
    zmp: Array


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
        moments = np.zeros(3)
        for k, footing in layout.footings:
            forces[k] = x[footing.columns] * self.units.force
            _add_up(footing.map, forces[k], footing.place, wrenches[k], moments)
        load = moments[2]
        zmp = moments[:2] / load if load > LEAST_LOAD else np.full(2, np.nan)
        return Decoded(x[: form.nv], form.torque(x), forces, wrenches, zmp)


@compiled
def _add_up(G: Array, forces: Array, place: Array, wrench: Array, moments: Array) -> None:
    """A contact's wrench, and what it adds to ``(−m_y, m_x, f_z)`` about the world's origin."""
    for i in range(6):
        for k in range(len(forces)):
            wrench[i] += G[i, k] * forces[k]
    moments[0] += place[0] * wrench[2] - place[2] * wrench[0] - wrench[4]
    moments[1] += place[1] * wrench[2] - place[2] * wrench[1] + wrench[3]
    moments[2] += wrench[2]


_NO_FORCE = np.zeros(0)
