"""Changes of a stack over time."""

from bisect import insort
from collections.abc import Callable
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


class Schedule:
    """Events in time; each happens once, at the first tick that is not before it.

    Example:
        ``Schedule().add(2.0, hand, level="hands").mode(4.0, "right_foot", "sliding").remove(6.0, "hand")``
    """

    def __init__(self) -> None:
        self.events: list[Event] = []
        self._next = 0

    def at(self, t: float, what: str, change: Callable[[Stack], object]) -> "Schedule":
        """Do anything to the stack at time `t`; `what` says so to a reader."""
        insort(self.events, Event(t, what, change))
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
        if mode == "fixed":
            self.at(t, f"{point} {mode}", lambda stack: setattr(stack.contact(point), "mode", mode))
            return self._ramp(point, t, t + ramp, 0.0, 1.0)
        self._ramp(point, t - ramp, t, 1.0, 0.0)
        return self.at(t, f"{point} {mode}", lambda stack: setattr(stack.contact(point), "mode", mode))

    def apply(self, t: float, stack: Stack) -> list[str]:
        """Carry out what has become due; returns what it was."""
        done = []
        while self._next < len(self.events) and self.events[self._next].t <= t + 1e-9:
            event = self.events[self._next]
            event.change(stack)
            done.append(event.what)
            self._next += 1
        return done

    def _ramp(self, point: str, start: float, end: float, before: float, after: float, steps: int = 20) -> "Schedule":
        for i in range(steps + 1):
            load = before + (after - before) * i / steps
            t = start + (end - start) * i / steps
            self.at(t, f"{point} load {load:.2f}", lambda stack, load=load: setattr(stack.contact(point), "load", load))
        return self
