"""Changes of a stack over time."""

from bisect import insort
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from sot.control.contact import SLIDING_SHARE, Mode
from sot.control.stack import Stack
from sot.control.task import Task
from sot.control.tick import Tick
from sot.control.transition import Transition
from sot.errors import InputError

RAMP = 0.2
"""Time that a task takes to come, to go, or to change its level, unless it says otherwise [s]."""


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

    Tasks come, go and change their level by their weight (see `Transition`), within a ramp that may be nothing.

    Example:
        ``Schedule().add(2.0, hand, level="hands").mode(4.0, "right_foot", "sliding").remove(6.0, "hand")``

    Attributes:
        events: What has happened and what will, in order.
        tasks: Tasks that come, with their levels.
        underway: Tasks that are coming, going or moving, by name: the share of the way that is behind them.
    """

    def __init__(self) -> None:
        self.events: list[Event] = []
        self.tasks: list[tuple[str, Task]] = []
        self.underway: dict[str, float] = {}
        self._now = 0.0
        self._next = 0
        self._ramps: list[Ramp] = []
        self._transitions: dict[str, Transition] = {}

    def at(self, t: float, what: str, change: Callable[[Stack], object]) -> "Schedule":
        """Do anything to the stack at time `t`, or at once if that has passed; `what` says so to a reader."""
        insort(self.events, Event(t, what, change), lo=self._next)
        return self

    def add(self, t: float, task: Task, level: str, before: str | None = None, ramp: float = RAMP) -> "Schedule":
        """Add a task to a level, or to a new one before `before`; it counts fully `ramp` [s] later."""
        self.tasks.append((level, task))

        def change(stack: Stack) -> None:
            if any(task.name == other.name for other in (*stack.hard, *stack.tasks)):
                raise InputError(f"the stack has a task '{task.name}' already")
            self._lead(stack, task, level, before, t, ramp)

        return self.at(t, f"add {task.name} to {level}", change)

    def remove(self, t: float, name: str, ramp: float = RAMP) -> "Schedule":
        """Remove a task; it counts less and less in the `ramp` [s] that leads up to `t`."""
        start = t - ramp
        return self.at(
            start, f"remove {name}", lambda stack: self._lead(stack, stack.task(name), None, None, start, ramp)
        )

    def move(self, t: float, name: str, level: str, before: str | None = None, ramp: float = RAMP) -> "Schedule":
        """Move a task to another level, or to a new one before `before`; it is there `ramp` [s] later."""
        return self.at(
            t, f"move {name} to {level}", lambda stack: self._lead(stack, stack.task(name), level, before, t, ramp)
        )

    def mode(self, t: float, point: str, mode: Mode, ramp: float = 0.04) -> "Schedule":
        """Change a contact's mode; one that is made takes `ramp` [s] to carry its full load, one that is broken too.

        The ramp leads up to `t` when the contact gives its load away and follows it when it takes it. A contact that
        slides keeps as much of it as it may carry then.
        """

        def begin(stack: Stack) -> None:
            light = SLIDING_SHARE if "sliding" in (mode, stack.contact(point).mode) else 0.0
            before, after = (light, 1.0) if mode == "fixed" else (1.0, light)
            self._ramps.append(Ramp(point, start, start + ramp, before, after))

        start = t if mode == "fixed" else t - ramp
        self.at(start, f"{point} {'takes' if mode == 'fixed' else 'gives away'} its load", begin)
        return self.at(t, f"{point} {mode}", lambda stack: setattr(stack.contact(point), "mode", mode))

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """Carry out what has become due; returns what it was.

        Args:
            t: Time [s].
            stack: What changes.
            loads: Measured normal force on each foot [N], for schedules that heed it.
        """
        done, self._now = [], t
        while self._next < len(self.events) and self.events[self._next].t <= t + 1e-9:
            event = self.events[self._next]
            self._next += 1  # first: the event may itself add others
            event.change(stack)
            done.append(event.what)
        for ramp in self._ramps:
            stack.contact(ramp.point).load = ramp.load(t)
        self._ramps = [ramp for ramp in self._ramps if t < ramp.end]
        for name, way in list(self._transitions.items()):
            self.underway[name] = way.apply(t, stack)
            if self.underway[name] >= 1.0:
                del self.underway[name], self._transitions[name]
        return done

    def heed(self, tick: Tick) -> None:
        """See what the robot does; what follows from it happens with the next `apply`."""

    def _lead(self, stack: Stack, task: Task, level: str | None, before: str | None, start: float, ramp: float) -> None:
        earlier = self._transitions.pop(task.name, None)
        if earlier is not None:
            earlier.finish(stack)
        way = Transition(stack, task, level, before, start, ramp)
        share = way.apply(self._now, stack)
        if share < 1.0:
            self._transitions[task.name], self.underway[task.name] = way, share
