"""A tick's levels in the variables of one form, and the answer in the robot's words."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Level
from sot.control.contact import Contact
from sot.control.forms import Condensed, Form, Full, Units
from sot.control.layout import Layout
from sot.control.task import Task
from sot.control.tick import Tick
from sot.robots.robot import Robot

Array = np.ndarray
FormName = Literal["condensed", "full"]

BEARING = 1.0
"""Without more than this on all contacts there is no zero-moment point [N]."""
_FORMS: dict[FormName, type[Form]] = {"condensed": Condensed, "full": Full}


@dataclass(slots=True)
class Decoded:
    """A solution in the robot's words.

    Args:
        acceleration: v̇, shape (nv,).
        torque: τ, shape (na,) [N m].
        forces: φ of all contacts, one after the other, shape (forces,) [N].
        wrenches: Wrench of the floor on each contact's point, world axes, shape (contacts, 6) [N, N m].
        zmp: Point of the floor about which these have no horizontal moment, shape (2,) [m]; nan without load. With all
            vertices on the floor it is the mean of them weighted by their normal forces, Ramos (11).
    """

    acceleration: Array
    torque: Array
    forces: Array
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
        forces = self.units.force * x[form.nv : form.nv + form.forces]
        wrenches, zmp = _felt(layout.maps, layout.bearer, layout.places, forces)
        return Decoded(x[: form.nv], form.torque(x), forces, wrenches, zmp)


@compiled
def _felt(maps: Array, bearer: Array, places: Array, forces: Array) -> tuple[Array, Array]:
    """What forces amount to: the wrenches on the contacts, and their zero-moment point, see `Layout` and `Decoded`."""
    wrenches = np.zeros((len(places), 6))
    for k in range(len(forces)):
        for i in range(6):
            wrenches[bearer[k], i] += maps[i, k] * forces[k]
    x = y = load = 0.0
    for k in range(len(places)):
        fx, fy, fz, mx, my, _ = wrenches[k]
        x += places[k, 0] * fz - places[k, 2] * fx - my
        y += places[k, 1] * fz - places[k, 2] * fy + mx
        load += fz
    return wrenches, np.array((x / load, y / load)) if load > BEARING else np.full(2, np.nan)
