"""Which surfaces touch, and the events that change it: Otani (1) and (30), and the sets that follow from them."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from sot.errors import InputError

ROBOT, WORLD = "robot", "world"
"""Names of the two entities that are always there; every other one is a thing."""
Change = Literal["make", "break"]
CHANGES: tuple[Change, ...] = ("make", "break")
Kind = Literal["robot-world", "robot-thing", "thing-world"]


class SurfaceName(NamedTuple):
    """A surface of an entity; reads "box/left" in files and messages."""

    entity: str
    surface: str

    def __str__(self) -> str:
        return f"{self.entity}/{self.surface}"

    @classmethod
    def parse(cls, text: str) -> "SurfaceName":
        """The surface that a text "entity/surface" names.

        Raises:
            InputError: The text is not of that form.
        """
        entity, slash, surface = text.partition("/")
        if not (entity and slash and surface) or "/" in surface:
            raise InputError(f"'{text}' names no surface: write entity/surface, as {ROBOT}/left_foot or box/left")
        return cls(entity, surface)


class SurfacePair(NamedTuple):
    """Two surfaces of different entities: the robot's first, then a thing's, then the world's."""

    first: SurfaceName
    second: SurfaceName

    def __str__(self) -> str:
        return f"{self.first} on {self.second}"

    @classmethod
    def of(cls, first: SurfaceName, second: SurfaceName) -> "SurfacePair":
        """The pair of two surfaces, in whichever order they are given.

        Raises:
            InputError: Both belong to one entity, or to two things.
        """
        if first.entity == second.entity:
            raise InputError(f"{first} and {second} belong to one body: a contact needs two")
        ordered = sorted((first, second), key=lambda name: (name.entity == WORLD, name.entity != ROBOT))
        if WORLD not in (first.entity, second.entity) and ROBOT not in (first.entity, second.entity):
            raise InputError(f"{first} and {second}: contacts between two things are not supported")
        return cls(*ordered)

    @property
    def kind(self) -> Kind:
        """γ of Otani (30)."""
        if self.first.entity == ROBOT:
            return "robot-world" if self.second.entity == WORLD else "robot-thing"
        return "thing-world"


@dataclass(frozen=True, slots=True)
class ContactEvent:
    """A contact that is made or broken, η of Otani (1).

    Attributes:
        time: When, on the demonstration's clock [s].
        change: Whether the contact is made or broken.
        pair: The surfaces.
    """

    time: float
    change: Change
    pair: SurfacePair

    def __str__(self) -> str:
        return f"{self.change} {self.pair} at {self.time:.2f} s"


class ContactSets(NamedTuple):
    """Which surfaces of the robot support it (E1), are free (E2) or hold a thing (E3), and all pairs that touch."""

    supports: frozenset[str]
    free: frozenset[str]
    holding: frozenset[str]
    pairs: frozenset[SurfacePair]

    def __str__(self) -> str:
        return "  ".join(
            f"E{k} {', '.join(sorted(names)) or '-'}"
            for k, names in enumerate((self.supports, self.free, self.holding), 1)
        )


@dataclass(frozen=True)
class ContactPlan:
    """The contacts at the start of a demonstration, and the events that change them, in order of time.

    Attributes:
        initial: Pairs that touch at the start.
        events: The list L of Otani (1).
    """

    initial: tuple[SurfacePair, ...]
    events: tuple[ContactEvent, ...]

    def __post_init__(self) -> None:
        touching = set(self.initial)
        time = 0.0
        for event in self.events:
            if not event.time >= time:
                raise InputError(f"{event}: events must be in order of time, and the one before is at {time:.2f} s")
            time = event.time
            if event.change == "make" and event.pair in touching:
                raise InputError(f"{event}: this contact is there already")
            if event.change == "break" and event.pair not in touching:
                raise InputError(f"{event}: this contact was never made, or is broken already")
            touching.symmetric_difference_update({event.pair})

    def pairs(self) -> tuple[SurfacePair, ...]:
        """All pairs that touch at some time, each once."""
        return tuple(dict.fromkeys([*self.initial, *(event.pair for event in self.events)]))

    def sets_after(self, count: int, tracked: Collection[str]) -> ContactSets:
        """The sets after the first `count` events; `tracked` are the robot's surfaces that are led when free, E2⁰."""
        touching = set(self.initial)
        for event in self.events[:count]:
            touching.symmetric_difference_update({event.pair})
        return contact_sets(touching, tracked)

    def sets_at(self, time: float, tracked: Collection[str]) -> ContactSets:
        """The sets at a time of the demonstration [s], events at that very time included."""
        return self.sets_after(sum(event.time <= time for event in self.events), tracked)

    def check_surfaces(self, known: Iterable[SurfaceName]) -> None:
        """Check that every surface that is named exists.

        Raises:
            InputError: One does not; the message lists those of its entity.
        """
        known = set(known)
        for pair in self.pairs():
            for name in pair:
                if name not in known:
                    own = sorted(other.surface for other in known if other.entity == name.entity)
                    entities = sorted({other.entity for other in known})
                    hint = f"'{name.entity}' has {', '.join(own)}" if own else f"there are {', '.join(entities)}"
                    raise InputError(f"{pair}: there is no surface '{name}'; {hint}")


def contact_sets(touching: Collection[SurfacePair], tracked: Collection[str]) -> ContactSets:
    """The sets E1, E2, E3 of pairs that touch; a surface that holds a thing and the world at once supports."""
    supports = frozenset(pair.first.surface for pair in touching if pair.kind == "robot-world")
    holding = frozenset(pair.first.surface for pair in touching if pair.kind == "robot-thing") - supports
    return ContactSets(supports, frozenset(tracked) - supports - holding, holding, frozenset(touching))


def simultaneous(events: Sequence[ContactEvent], window: float) -> list[list[ContactEvent]]:
    """Events in groups: those of one kind and change that follow the group's first within a window [s]."""
    groups: list[list[ContactEvent]] = []
    for event in events:
        first = groups[-1][0] if groups else None
        if (
            first is not None
            and event.time - first.time <= window
            and (event.change, event.pair.kind) == (first.change, first.pair.kind)
        ):
            groups[-1].append(event)
        else:
            groups.append([event])
    return groups
