"""Changes of a stack over time."""

from bisect import insort
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from sot.contact import Mode
from sot.stack import Stack
from sot.task import Task


@dataclass(order=True, slots=True)
class Event:
    """Something that happens to the stack at time `t` [s]."""

    t: float
    what: str = field(compare=False)
    change: Callable[[Stack], object] = field(compare=False)


@dataclass(slots=True)
class Ramp:
    """A contact's load on its way from one value to another."""

    point: str
    start: float
    end: float
    before: float
    after: float

    def load(self, t: float) -> float:
        """The load at a time [s]."""
        share = (t - self.start) / (self.end - self.start) if self.end > self.start else 1.0
        return self.before + (self.after - self.before) * min(max(share, 0.0), 1.0)


class Schedule:
    """Events in time; each happens once, at the first tick that is not before it.

    Example:
        ``Schedule().add(2.0, hand, level="hands").mode(4.0, "right_foot", "sliding").remove(6.0, "hand")``
    """

    def __init__(self) -> None:
        self.events: list[Event] = []
        self._next = 0
        self._ramps: list[Ramp] = []

    def at(self, t: float, what: str, change: Callable[[Stack], object]) -> "Schedule":
        """Do anything to the stack at time `t`, or at once if that has passed; `what` says so to a reader."""
        insort(self.events, Event(t, what, change), lo=self._next)
        return self

    def add(self, t: float, task: Task, level: str, before: str | None = None) -> "Schedule":
        """Add a task to a level."""
        return self.at(t, f"add {task.name} to {level}", lambda stack: stack.add(task, level, before))

    def remove(self, t: float, name: str) -> "Schedule":
        """Remove a task."""
        return self.at(t, f"remove {name}", lambda stack: stack.remove(name))

    def move(self, t: float, name: str, level: str, before: str | None = None) -> "Schedule":
        """Move a task to another level."""
        return self.at(t, f"move {name} to {level}", lambda stack: stack.move(name, level, before))

    def mode(self, t: float, point: str, mode: Mode, ramp: float = 0.04) -> "Schedule":
        """Change a contact's mode; one that is made takes `ramp` [s] to carry its full load, one that is broken too.

        The ramp leads up to `t` when the contact gives its load away and follows it when it takes it.
        """
        start, before, after = (t, 0.0, 1.0) if mode == "fixed" else (t - ramp, 1.0, 0.0)
        load = Ramp(point, start, start + ramp, before, after)
        self.at(start, f"{point} load {before:.0f} to {after:.0f}", lambda stack: self._ramps.append(load))
        return self.at(t, f"{point} {mode}", lambda stack: setattr(stack.contact(point), "mode", mode))

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """Carry out what has become due; returns what it was.

        Args:
            t: Time [s].
            stack: What changes.
            loads: Measured normal force on each foot [N], for schedules that heed it.
        """
        done = []
        while self._next < len(self.events) and self.events[self._next].t <= t + 1e-9:
            event = self.events[self._next]
            self._next += 1  # first: the event may itself add others
            event.change(stack)
            done.append(event.what)
        for ramp in self._ramps:
            stack.contact(ramp.point).load = ramp.load(t)
        self._ramps = [ramp for ramp in self._ramps if t < ramp.end]
        return done
