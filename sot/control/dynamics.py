"""The levels of a tick in the variables of one form, and the solution as accelerations, torques and contact forces."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Level, Rows
from sot.control.contact import Contact
from sot.control.forms import Condensed, Form, Full, Units, variable_counts
from sot.control.layout import Layout
from sot.control.row_check import check_rows
from sot.control.task import Task
from sot.control.tick import Tick
from sot.errors import InputError
from sot.robots.robot import Robot
from sot.robots.system import System

Array = np.ndarray
FormName = Literal["condensed", "full"]

MIN_LOAD_FOR_ZMP = 1.0
"""Smallest total normal force for which a zero-moment point is defined [N]."""
_FORMS: dict[FormName, type[Form]] = {"condensed": Condensed, "full": Full}


@dataclass(slots=True)
class Decoded:
    """A solution as the robot's quantities.

    Args:
        acceleration: v̇, shape (nv,).
        torque: τ, shape (na,) [N m].
        forces: φ of all contacts, one after the other, shape (forces,) [N].
        wrenches: Wrench on each contact's first surface, about its origin, world axes, shape (contacts, 6) [N, N m].
        zmp: Centres of pressure of the feet, each at the height of its contact, in their mean by load, shape (2,) [m];
            nan without load. On level soles it is the mean of the vertices weighted by their normal forces, Ramos (11).
    """

    acceleration: Array
    torque: Array
    forces: Array
    wrenches: Array
    zmp: Array


class Dynamics:
    """Builds the levels that a solver solves: level 0, then the stack's.

    The matrices of level 0 are kept from tick to tick, and only values that change are written: levels are valid until
    the next `assemble`.

    Args:
        robot: The robot, or the system of it and things.
        form: "condensed", the one that runs, or "full", the paper's; both give the same answer.
    """

    def __init__(self, robot: Robot | System, form: FormName = "condensed") -> None:
        self.system, self.name = System.of(robot), form
        self.units = Units.of(self.system.robot)
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

        Raises:
            InvalidRowsError: If a task's rows have a wrong shape or type, or a value that is not finite.
            InputError: If a task raises anything.
        """
        all_levels = [("hard", hard), *levels]
        tasks = [task for _, tasks in all_levels for task in tasks]
        rows: list[Rows] = []
        try:
            for task in tasks:
                rows.append(task.rows(tick))
        except InputError:
            raise
        except Exception as error:
            raise InputError(f"task '{task.name}': {type(error).__name__}: {error}") from error
        try:
            key: list[object] = [*contacts, *[contact.mode for contact in contacts]]
            key += [contact.force_count for contact in contacts]
            key += [own.A.shape for own in rows]
            key += [len(own.lower) for own in rows]
        except (AttributeError, TypeError):
            counts = variable_counts(self.system, sum(contact.force_count for contact in contacts))
            for task, own in zip(tasks, rows, strict=True):
                check_rows(task, own, counts[task.variable])
            raise
        for name, own_tasks in all_levels:
            key += [name, *own_tasks]
        if self._layout is None or key != self._key:
            self._layout, self._key = None, key
            forces = sum(contact.force_count for contact in contacts)
            form = _FORMS[self.name](self.system, self.units, forces, _untouched_velocities(self.system, contacts))
            self._layout = Layout(form, contacts, all_levels, rows, self.system.robot.feet)
        form = self._layout.form
        form.motion[:, : form.nv], form.bias = tick.M.T, tick.h  # M is symmetric, and so it lies in memory like motion
        return self._layout.write(tick, rows)

    def decode(self, x: Array) -> Decoded:
        """Read a solution of the levels that were assembled last."""
        assert self._layout is not None
        layout, form = self._layout, self._layout.form
        forces = self.units.force * x[form.nv : form.nv + form.forces]
        wrenches, zmp = _wrenches_and_zmp(
            layout.wrench_maps, layout.contact_of_force, layout.contact_positions, layout.is_foot, forces
        )
        return Decoded(x[: form.nv], form.torque(x), forces, wrenches, zmp)


def _untouched_velocities(system: System, contacts: Sequence[Contact]) -> list[int]:
    """Velocities without motors of the things that no contact exerts a force on."""
    touched = {part for contact in contacts if contact.force_count for part in (contact.point, contact.on.point)}
    owners = {point.split("/", 1)[0] for point in touched if point is not None}
    motorless = set(system.undriven.tolist())
    loose = [of for name, of in system.velocities.items() if name not in owners]
    return [k for of in loose for k in range(of.start, of.stop) if k in motorless]


@compiled
def _wrenches_and_zmp(
    wrench_maps: Array, contact_of_force: Array, contact_positions: Array, is_foot: Array, forces: Array
) -> tuple[Array, Array]:
    """Wrenches of the contact forces and their zero-moment point; for the arguments see `Layout`, `Decoded`."""
    wrenches = np.zeros((len(contact_positions), 6))
    for k in range(len(forces)):
        for i in range(6):
            wrenches[contact_of_force[k], i] += wrench_maps[i, k] * forces[k]
    x = y = load = 0.0
    for k in range(len(contact_positions)):
        if not is_foot[k]:
            continue
        _, _, fz, mx, my, _ = wrenches[k]
        x += contact_positions[k, 0] * fz - my
        y += contact_positions[k, 1] * fz + mx
        load += fz
    return wrenches, np.array((x / load, y / load)) if load > MIN_LOAD_FOR_ZMP else np.full(2, np.nan)
