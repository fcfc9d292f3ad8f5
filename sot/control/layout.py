"""Where a tick's rows stand, for as long as the contacts, the tasks and their numbers of rows stay what they are.

Matrices are kept from tick to tick, and only what moves is written again.
"""

from collections.abc import Sequence

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Block, Equality, Level, Rows
from sot.control.contact import Contact
from sot.control.forms import Form
from sot.control.task import Task
from sot.control.tick import Tick

Array = np.ndarray

FRICTION_GIVES_WAY = 3
"""Place of the friction pyramids in the order in which level 0 is relaxed: the last."""
_ANY = slice(0)
_NO_VARIABLES = 0, 0.0
"""Where rows begin, and no unit: they are of torques in a form that has none among its variables."""


class Layout:
    """The levels of ticks that are alike.

    Args:
        form: The variables.
        contacts: Contacts, those that are off included.
        levels: Names and tasks of all levels, level 0 first.
        rows: What the tasks ask for, one after the other, at such a tick.

    Attributes:
        levels: As they were written last.
        maps: From the forces φ of all contacts [N] to the wrench of the floor on their bearers' points, world axes,
            shape (6, forces).
        bearer: Whose each of these forces is, shape (forces,).
        places: Where the points of the contacts are that are not off, shape (contacts, 3) [m].
    """

    def __init__(
        self,
        form: Form,
        contacts: Sequence[Contact],
        levels: Sequence[tuple[str, Sequence[Task]]],
        rows: Sequence[Rows],
    ) -> None:
        self.form = form
        self.levels: list[Level] = []
        self.maps, self.places = np.zeros((6, form.forces)), np.zeros((len(contacts), 3))
        self.bearer = np.repeat(np.arange(len(contacts)), [contact.force_count for contact in contacts])
        self._footings: list[Footing] = []
        self._equalities: list[tuple[int, float, Equality]] = []
        self._bounds: list[tuple[int, float, Task, _Bounds]] = []
        asked = iter(enumerate(rows))
        for name, tasks in levels:
            pile = _Pile()
            if not self.levels:
                self._stand(contacts, pile)
                self._dynamics = pile.equality(form.block(), Equality(*form.equation(), form.share))
            for task in tasks:
                k, own = next(asked)
                block = Block(task.name, task.unit, task.weight, task.equality, _ANY, task.gives_way, task.labels)
                start, unit = form.variables.get(task.on, _NO_VARIABLES)
                if task.equality:
                    equality = Equality(own.A, own.lower, start=start, selects=own.selects if unit else None)
                    self._equalities.append((k, unit, pile.equality(block, equality)))
                else:
                    width = own.A.shape[1] if unit else form.nv + form.forces
                    bounds = _Bounds(block, slice(start, start + width), len(own.lower), own.selects is not None)
                    self._bounds.append((k, unit, task, pile.inequality(bounds)))
            self.levels.append(pile.level(name, form.size))
        self.levels[0].structure_key = self

    def write(self, tick: Tick, rows: Sequence[Rows]) -> list[Level]:
        """The levels of a tick; its mass matrix and bias are in the form already."""
        form, dynamics = self.form, self._dynamics
        for footing in self._footings:
            footing.write(tick)
        dynamics.A, dynamics.b = form.equation()
        for k, unit, equality in self._equalities:
            own = rows[k]
            weight, wanted = own.weight, own.lower
            if unit:
                equality.A, equality.scale = own.A, weight * unit
            else:
                equality.A, offset = form.joints(own)
                equality.scale, wanted = weight, wanted - offset
            equality.b = wanted if weight == 1.0 else weight * wanted
        for k, unit, task, bounds in self._bounds:
            own = rows[k]
            if unit:
                bounds.write(own.A, own.weight * unit, own.lower, own.upper, own.weight)
            else:
                bounds.joints(*form.joints(own), own.lower, own.upper, own.weight)
            bounds.block.labels = task.labels
        for level in self.levels:
            level.clear_cache()
        return self.levels

    def _stand(self, contacts: Sequence[Contact], pile: "_Pile") -> None:
        """What contacts ask of level 0."""
        end = 0
        for k, contact in enumerate(contacts):
            own = slice(end, end := end + contact.force_count)
            if contact.mode != "off":
                self._footings.append(Footing(contact, self.form, own, self.maps[:, own], self.places[k], pile))


class Footing:
    """A contact's part of level 0, and of the equation of motion.

    Args:
        contact: One that is not off.
        form: The variables.
        own: Its forces φ among those of all contacts.
        map, place: Where to write its part of `Layout.maps` and `Layout.places`.
        pile: Level 0.
    """

    def __init__(self, contact: Contact, form: Form, own: slice, map: Array, place: Array, pile: "_Pile") -> None:
        self._contact, self._units, self._map, self._place = contact, form.units, map, place
        self._axes = list(contact.held)
        columns = slice(form.nv + own.start, form.nv + own.stop)
        self._on_motion = form.motion[:, columns]
        block = Block(f"Contact {contact.point}", "m/s²", 1.0, True, _ANY, labels=contact.axes)
        self._held = pile.equality(block, Equality(np.empty((len(self._axes), form.nv)), np.empty(len(self._axes))))
        self._pressure: Equality | None = None
        self._friction: _Bounds | None = None
        if own.start == own.stop:
            return
        share = 1.0 / form.units.force
        if links := contact.link_count:
            E = np.empty((links, contact.force_count))
            block = Block(f"Pressure {contact.point}", "N", share, True, _ANY)
            self._pressure = pile.equality(block, Equality(E, np.zeros(links), start=columns.start))
        count = len(contact.force_inequalities(1.0)[1])
        labels = contact.force_labels(count)
        block = Block(f"Friction {contact.point}", "N", share, False, _ANY, FRICTION_GIVES_WAY, labels)
        self._friction = pile.inequality(_Bounds(block, columns, count, constant=True))

    def write(self, tick: Tick) -> None:
        """Its rows at a tick."""
        contact, held = self._contact, self._held
        frame = tick.frame(contact.point)
        held.A, held.b = frame.jacobian, contact.acceleration(tick) - frame.drift
        if len(self._axes) < 6:
            held.A, held.b = held.A[self._axes], held.b[self._axes]
        self._place[:] = frame.position
        if self._friction is None:
            return
        _press(frame.jacobian, contact.wrench_map(tick), -self._units.force, self._map, self._on_motion)
        if self._pressure is not None:
            self._pressure.A = contact.force_equalities(tick)
        F, lower, upper = contact.force_inequalities(self._units.weight)
        self._friction.write(F, 1.0, lower, upper, 1.0 / self._units.force)


class _Bounds:
    """One owner's inequalities, in their place among those of a level.

    Args:
        block: Whose they are.
        columns: The variables that they involve.
        count: Of rows.
        constant: Whether their matrix stays what it is, but for its scale.
    """

    def __init__(self, block: Block, columns: slice, count: int, constant: bool) -> None:
        self.block, self.count, self._columns, self._constant = block, count, columns, constant
        self._none = np.zeros(count)
        self._scale: float | None = None  # at which the matrix was written
        self._seen: tuple[Array | None, ...] = None, None, None  # whose numbers the matrix and the bounds are

    def place(self, C: Array, lower: Array, upper: Array) -> None:
        """Where to write."""
        self._C, self._lower, self._upper = C[:, self._columns], lower, upper

    def write(self, A: Array, scale: float, lower: Array, upper: Array, share: float) -> None:
        """Write ``lower <= A y <= upper``, times a share that is in the scale of A already.

        Arrays that nobody can write to are the same as last time.
        """
        same, (matrix, least, most) = scale == self._scale, self._seen
        if not (same and (self._constant or (A is matrix and not A.flags.writeable))):
            np.multiply(A, scale, out=self._C)
        if not (same and lower is least and upper is most and not lower.flags.writeable):
            _scaled(lower, upper, self._none, share, self._lower, self._upper)
        self._scale, self._seen = scale, (A, lower, upper)

    def joints(self, B: Array, offset: Array, lower: Array, upper: Array, share: float) -> None:
        """Write ``lower <= B x + offset <= upper``, times a share."""
        np.multiply(B, share, out=self._C)
        _scaled(lower, upper, offset, share, self._lower, self._upper)


@compiled
def _scaled(lower: Array, upper: Array, offset: Array, share: float, to_lower: Array, to_upper: Array) -> None:
    for k in range(len(lower)):
        to_lower[k], to_upper[k] = share * (lower[k] - offset[k]), share * (upper[k] - offset[k])


@compiled
def _press(jacobian: Array, G: Array, scale: float, to_map: Array, to_motion: Array) -> None:
    """Write a map G to wrenches, and ``scale Jᵀ G``."""
    to_map[:] = G
    for i in range(to_motion.shape[0]):
        for j in range(to_motion.shape[1]):
            total = 0.0
            for k in range(6):
                total += jacobian[k, i] * G[k, j]
            to_motion[i, j] = scale * total


class _Pile:
    """A level that is being put together."""

    def __init__(self) -> None:
        self._equalities: list[Equality] = []
        self._blocks: list[Block] = []
        self._bounds: list[_Bounds] = []

    def equality(self, block: Block, equality: Equality) -> Equality:
        """Add rows that hold with equality."""
        start = self._blocks[-1].rows.stop if self._blocks else 0
        block.rows = slice(start, start + len(equality.b))
        self._blocks.append(block)
        self._equalities.append(equality)
        return equality

    def inequality(self, bounds: _Bounds) -> _Bounds:
        """Add others."""
        start = self._bounds[-1].block.rows.stop if self._bounds else 0
        bounds.block.rows = slice(start, start + bounds.count)
        self._bounds.append(bounds)
        return bounds

    def level(self, name: str, size: int) -> Level:
        """The level, with room for what will be written."""
        count = sum(bounds.count for bounds in self._bounds)
        C, lower, upper = np.zeros((count, size)), np.empty(count), np.empty(count)
        for bounds in self._bounds:
            rows = bounds.block.rows
            bounds.place(C[rows], lower[rows], upper[rows])
        blocks = self._blocks + [bounds.block for bounds in self._bounds]
        return Level(name, size, self._equalities, C, lower, upper, blocks)
