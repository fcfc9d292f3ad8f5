"""Places of a tick's rows in the levels, for as long as contacts, tasks and their numbers of rows do not change.

Matrices are kept from tick to tick, and only values that change are written.
"""

from collections.abc import Sequence

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Block, Equality, Level, Rows
from sot.control.contact import Contact
from sot.control.forms import Form
from sot.control.row_check import check_rows
from sot.control.task import Task
from sot.control.tick import Tick
from sot.errors import InvalidRowsError

Array = np.ndarray

FRICTION_RELAXATION_ORDER = 3
"""Place of the friction pyramids in the order in which rows of level 0 are relaxed: the last."""
_ROWS_NOT_PLACED = slice(0)
_NO_VARIABLE_START_AND_UNIT = 0, 0.0
"""First index and unit (none) of a kind of variable that the form does not have: torques in the condensed one."""


class Layout:
    """The levels of ticks with the same contacts, tasks and numbers of rows.

    Args:
        form: The variables.
        contacts: Contacts, those that are off included.
        levels: Names and tasks of all levels, level 0 first.
        rows: Rows of all tasks, in the order of the levels, at such a tick.
        feet: Points of the robot's feet.

    Attributes:
        levels: Levels as they were written last.
        wrench_maps: Each force of φ [N] as the wrench on the first surface of its contact, about that one's origin,
            world axes, shape (6, forces).
        contact_of_force: Number of the contact that each of these forces belongs to, shape (forces,).
        contact_positions: These origins, of the contacts that are not off, world, shape (contacts, 3) [m].
        is_foot: Whether each contact is one of a foot with the world, shape (contacts,).

    Raises:
        InvalidRowsError: If rows have a wrong shape or type, or a value that is not finite.
    """

    def __init__(
        self,
        form: Form,
        contacts: Sequence[Contact],
        levels: Sequence[tuple[str, Sequence[Task]]],
        rows: Sequence[Rows],
        feet: Sequence[str],
    ) -> None:
        self.form = form
        self.levels: list[Level] = []
        self.wrench_maps, self.contact_positions = np.zeros((6, form.forces)), np.zeros((len(contacts), 3))
        self.contact_of_force = np.repeat(np.arange(len(contacts)), [contact.force_count for contact in contacts])
        self.is_foot = np.array([contact.is_footing and contact.point in feet for contact in contacts], dtype=bool)
        self._contact_rows: list[ContactRows] = []
        self._untouched: Equality | None = None
        self._equalities: list[tuple[int, float, Task, Equality]] = []
        self._inequalities: list[tuple[int, float, Task, _InequalityRows]] = []
        asked = iter(enumerate(rows))
        for name, tasks in levels:
            builder = _LevelBuilder()
            if not self.levels:
                self._add_contacts(contacts, builder)
                self._dynamics = builder.add_equality(
                    form.equation_block(), Equality(*form.equation(), form.equation_scale)
                )
                if len(form.untouched_equation()[1]):
                    untouched = Equality(*form.untouched_equation(), form.equation_scale)
                    self._untouched = builder.add_equality(form.untouched_block(), untouched)
            for task in tasks:
                k, own = next(asked)
                check_rows(task, own, form.counts[task.variable])
                block = Block(
                    task.name,
                    task.unit,
                    task.weight,
                    task.equality,
                    _ROWS_NOT_PLACED,
                    task.gives_way,
                    task.labels,
                    task.optional,
                )
                start, unit = form.variables.get(task.variable, _NO_VARIABLE_START_AND_UNIT)
                if task.equality:
                    A = self._widened(own.A) if unit and task.variable == "acceleration" else own.A
                    equality = Equality(A, own.lower, start=start, selects=own.selects if unit else None)
                    self._equalities.append((k, unit, task, builder.add_equality(block, equality)))
                else:
                    width = own.A.shape[1] if unit else form.nv + form.forces
                    bounds = _InequalityRows(
                        block, slice(start, start + width), len(own.lower), own.selects is not None
                    )
                    self._inequalities.append((k, unit, task, builder.add_inequality(bounds)))
            self.levels.append(builder.build(name, form.size))
        self.levels[0].structure_key = self

    def write(self, tick: Tick, rows: Sequence[Rows]) -> list[Level]:
        """Write the rows of a tick and return its levels; the form has the mass matrix and the bias already.

        Raises:
            InvalidRowsError: If a value is not finite, or bounds have another length than before.
        """
        form, dynamics = self.form, self._dynamics
        for contact_rows in self._contact_rows:
            contact_rows.write(tick)
        dynamics.A, dynamics.b = form.equation()
        if self._untouched is not None:
            self._untouched.A, self._untouched.b = form.untouched_equation()
        for k, unit, task, equality in self._equalities:
            own = rows[k]
            weight, wanted = own.weight, own.lower
            if unit:
                columns = own.A.shape[1]
                if columns == equality.A.shape[1]:
                    equality.A = own.A
                elif own.selects is None:  # selected columns are what they were
                    equality.A = self._widened(own.A)
                equality.scale = weight * unit
            else:
                equality.A, offset = form.torque_rows(own)
                equality.scale, wanted = weight, wanted - offset
            equality.b = wanted if weight == 1.0 else weight * wanted
            if not _are_finite(equality.A, wanted, own.selects is not None):
                raise self._invalid(task, own)
        for k, unit, task, bounds in self._inequalities:
            own = rows[k]
            if unit:
                valid = bounds.write_rows(own.A, own.weight * unit, own.lower, own.upper, own.weight)
            else:
                valid = bounds.write_torques(*form.torque_rows(own), own.lower, own.upper, own.weight)
            if not valid:
                raise self._invalid(task, own)
            bounds.block.labels = task.labels
        for level in self.levels:
            level.clear_cache()
        return self.levels

    def _widened(self, A: Array) -> Array:
        """Rows on the robot's accelerations, or on all, as rows on all: solvers tell v̇ from φ by the columns."""
        if not isinstance(A, np.ndarray) or A.ndim != 2 or A.shape[1] == self.form.nv:
            return A
        out = np.zeros((len(A), self.form.nv))
        out[:, : A.shape[1]] = A
        return out

    def _invalid(self, task: Task, rows: Rows) -> InvalidRowsError:
        """Error that says what is wrong with rows."""
        try:
            check_rows(task, rows, self.form.counts[task.variable])
        except InvalidRowsError as error:
            return error
        return InvalidRowsError(f"task '{task.name}': its rows hold a value that is not finite")

    def _add_contacts(self, contacts: Sequence[Contact], builder: "_LevelBuilder") -> None:
        """Add the rows of the contacts to level 0."""
        end = 0
        for k, contact in enumerate(contacts):
            own = slice(end, end := end + contact.force_count)
            if contact.mode != "off":
                self._contact_rows.append(
                    ContactRows(contact, self.form, own, self.wrench_maps[:, own], self.contact_positions[k], builder)
                )


class ContactRows:
    """Rows of one contact in level 0, and its columns in the equation of motion.

    Args:
        contact: A contact that is not off.
        form: The variables.
        own: Slice of its forces in φ.
        map, place: Views of its parts of `Layout.wrench_maps` and `Layout.contact_positions`, to write to.
        builder: Builder of level 0.
    """

    def __init__(
        self, contact: Contact, form: Form, own: slice, map: Array, place: Array, builder: "_LevelBuilder"
    ) -> None:
        self._contact, self._units, self._map, self._place = contact, form.units, map, place
        self._axes, self._wanted = list(contact.held_axes), np.empty(6)
        self._turns_axes = len(self._axes) < 6 and not (
            contact.is_footing and np.array_equal(contact.on.placement.rotation, np.eye(3))
        )
        columns = slice(form.nv + own.start, form.nv + own.stop)
        self._on_motion, self._scale = form.motion[:, columns], -form.units.force
        block = Block(f"Contact {contact.name}", "m/s²", 1.0, True, _ROWS_NOT_PLACED, labels=contact.held_axis_names)
        self._held = builder.add_equality(
            block, Equality(np.empty((len(self._axes), form.nv)), np.empty(len(self._axes)))
        )
        self._pressure: Equality | None = None
        self._friction: _InequalityRows | None = None
        if own.start == own.stop:
            return
        share = 1.0 / form.units.force
        if links := contact.force_equality_count:
            E = np.empty((links, contact.force_count))
            block = Block(f"Pressure {contact.name}", "N", share, True, _ROWS_NOT_PLACED)
            self._pressure = builder.add_equality(block, Equality(E, np.zeros(links), start=columns.start))
        count = len(contact.force_inequalities(1.0)[1])
        labels = contact.force_labels(count)
        block = Block(
            f"Friction {contact.name}", "N", share, False, _ROWS_NOT_PLACED, FRICTION_RELAXATION_ORDER, labels
        )
        self._friction = builder.add_inequality(_InequalityRows(block, columns, count, constant=True))

    def write(self, tick: Tick) -> None:
        """Write its rows at a tick."""
        contact, held = self._contact, self._held
        at = contact.motion(tick)
        valid = contact.write_rows(tick, at, self._wanted, self._place, self._map, self._on_motion, self._scale)
        held.A, held.b = at.jacobian, self._wanted
        if self._turns_axes:
            axes = np.kron(np.eye(2), tick.surface_axes(contact.on).rotation.T)
            held.A, held.b = axes @ held.A, axes @ held.b
        if len(self._axes) < 6:
            held.A, held.b = held.A[self._axes], held.b[self._axes]
        if self._friction is None:
            return
        if not valid:
            raise InvalidRowsError(f"contact '{contact.name}': its path holds a value that is not finite")
        if self._pressure is not None:
            self._pressure.A = contact.force_equalities(tick)
        F, lower, upper = contact.force_inequalities(self._units.weight)
        self._friction.write_rows(F, 1.0, lower, upper, 1.0 / self._units.force)


class _InequalityRows:
    """Inequalities of one task or contact, in their place among those of a level.

    Args:
        block: Names the rows.
        columns: Variables that they involve.
        count: Number of rows.
        constant: Whether their matrix never changes, but for its scale.
    """

    def __init__(self, block: Block, columns: slice, count: int, constant: bool) -> None:
        self.block, self.count, self._columns, self._constant = block, count, columns, constant
        self._no_offset = np.zeros(count)
        self._last_scale: float | None = None  # at which the matrix was written
        self._last_arrays: tuple[Array | None, ...] = None, None, None  # whose numbers the matrix and the bounds are

    def attach(self, C: Array, lower: Array, upper: Array) -> None:
        """Take the views of the level's matrix and bounds to write to."""
        self._C, self._lower, self._upper = C[:, self._columns], lower, upper

    def write_rows(self, A: Array, matrix_scale: float, lower: Array, upper: Array, bound_scale: float) -> bool:
        """Write ``lower <= A y <= upper``, the bounds times a scale that A's has in it; returns whether it is valid.

        A read-only array that was written last time has not changed since.
        """
        same, (matrix, least, most) = matrix_scale == self._last_scale, self._last_arrays
        valid = True
        if not (same and (self._constant or (A is matrix and not A.flags.writeable))):
            valid = _write_matrix(A, matrix_scale, self._C)
        if valid and not (same and lower is least and upper is most and not lower.flags.writeable):
            valid = _write_bounds(lower, upper, self._no_offset, bound_scale, self._lower, self._upper)
        self._last_scale, self._last_arrays = matrix_scale if valid else None, (A, lower, upper)
        return valid

    def write_torques(self, B: Array, offset: Array, lower: Array, upper: Array, bound_scale: float) -> bool:
        """Write ``lower <= B x + offset <= upper``, times a scale; returns whether it is valid."""
        written: bool = _write_matrix(B, bound_scale, self._C)
        return written and _write_bounds(lower, upper, offset, bound_scale, self._lower, self._upper)


@compiled
def _are_finite(A: Array, wanted: Array, constant: bool) -> bool:
    """Whether all of what rows ``A x = wanted`` want is, and all of A, which is not looked at if it is constant."""
    total = 0.0  # nan as soon as a value is not finite
    for k in range(len(wanted)):
        total += 0.0 * wanted[k]
    if not constant:
        for i in range(A.shape[0]):
            for k in range(A.shape[1]):
                total += 0.0 * A[i, k]
    return total == 0.0


@compiled
def _write_matrix(A: Array, scale: float, to: Array) -> bool:
    """Write a matrix of the same shape, scaled; returns whether all its values are finite."""
    total = 0.0
    for i in range(A.shape[0]):
        for k in range(A.shape[1]):
            to[i, k] = scale * A[i, k]
            total += 0.0 * A[i, k]
    return total == 0.0


@compiled
def _write_bounds(
    lower: Array, upper: Array, offset: Array, bound_scale: float, to_lower: Array, to_upper: Array
) -> bool:
    """Write bounds less an offset, scaled; returns whether there are as many as before, none of them nan."""
    if len(lower) != len(to_lower) or len(upper) != len(to_upper):
        return False
    valid = True
    for k in range(len(lower)):
        to_lower[k], to_upper[k] = bound_scale * (lower[k] - offset[k]), bound_scale * (upper[k] - offset[k])
        valid &= to_lower[k] == to_lower[k] and to_upper[k] == to_upper[k]
    return valid


class _LevelBuilder:
    """Builder of one level: rows are added one after the other, then the level is made."""

    def __init__(self) -> None:
        self._equalities: list[Equality] = []
        self._blocks: list[Block] = []
        self._inequalities: list[_InequalityRows] = []

    def add_equality(self, block: Block, equality: Equality) -> Equality:
        """Add equalities after those that are there, and return them."""
        start = self._blocks[-1].rows.stop if self._blocks else 0
        block.rows = slice(start, start + len(equality.b))
        self._blocks.append(block)
        self._equalities.append(equality)
        return equality

    def add_inequality(self, bounds: _InequalityRows) -> _InequalityRows:
        """Add inequalities after those that are there, and return them."""
        start = self._inequalities[-1].block.rows.stop if self._inequalities else 0
        bounds.block.rows = slice(start, start + bounds.count)
        self._inequalities.append(bounds)
        return bounds

    def build(self, name: str, size: int) -> Level:
        """Make the level, with room for the values of its inequalities."""
        count = sum(bounds.count for bounds in self._inequalities)
        C, lower, upper = np.zeros((count, size)), np.empty(count), np.empty(count)
        for bounds in self._inequalities:
            rows = bounds.block.rows
            bounds.attach(C[rows], lower[rows], upper[rows])
        blocks = self._blocks + [bounds.block for bounds in self._inequalities]
        return Level(name, size, self._equalities, C, lower, upper, blocks)
