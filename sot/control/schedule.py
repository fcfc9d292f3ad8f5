"""Changes of a stack over time."""

from bisect import insort
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from sot.control.contact import SLIDING_LOAD_RAMP, Mode
from sot.control.stack import Stack
from sot.control.task import Task
from sot.control.tick import Tick
from sot.control.transition import TASK_RAMP


@dataclass(order=True, slots=True)
class Event:
    """A change of the stack at time `t` [s]; `what` describes it to a reader."""

    t: float
    what: str = field(compare=False)
    change: Callable[[Stack], object] = field(compare=False)


@dataclass(slots=True)
class LoadRamp:
    """A contact's load that changes linearly from one value to another."""

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

    A task comes, goes or changes its level by way of its weight (see `Transition`), within a ramp that may be 0.

    Example:
        ``Schedule().add(2.0, hand, level="hands").mode(4.0, "right_foot", "sliding").remove(6.0, "hand")``

    Attributes:
        events: Past and future events, in order of time.
        tasks: Levels and tasks that are added at some time.
        finished: Whether the run may end before the motion does.
        extra_time: Longest time that waiting may add to the motion's [s].
        failure: Why what was planned was given up, in words; empty while it is not.
    """

    finished = False
    extra_time = 0.0
    failure = ""

    def __init__(self) -> None:
        self.events: list[Event] = []
        self.tasks: list[tuple[str, Task]] = []
        self._next_event = 0
        self._load_ramps: list[LoadRamp] = []

    def at(self, t: float, what: str, change: Callable[[Stack], object]) -> "Schedule":
        """Change the stack in any way at time `t`, or at once if that has passed; `what` describes it to a reader."""
        insort(self.events, Event(t, what, change), lo=self._next_event)
        return self

    def add(self, t: float, task: Task, level: str, before: str | None = None, ramp: float = TASK_RAMP) -> "Schedule":
        """Add a task to a level, or to a new one before `before`; it counts fully `ramp` [s] later."""
        self.tasks.append((level, task))
        return self.at(t, f"add {task.name} to {level}", lambda stack: stack.add(task, level, before, ramp, start=t))

    def remove(self, t: float, name: str, ramp: float = TASK_RAMP) -> "Schedule":
        """Remove a task; it counts less and less in the `ramp` [s] that leads up to `t`."""
        start = t - ramp
        return self.at(start, f"remove {name}", lambda stack: stack.remove(name, ramp, start))

    def move(self, t: float, name: str, level: str, before: str | None = None, ramp: float = TASK_RAMP) -> "Schedule":
        """Move a task to another level, or to a new one before `before`; it is there `ramp` [s] later."""
        return self.at(t, f"move {name} to {level}", lambda stack: stack.move(name, level, before, ramp, start=t))

    def mode(self, t: float, point: str, mode: Mode, ramp: float = 0.04) -> "Schedule":
        """Change a contact's mode at time `t`; its load changes within `ramp` [s].

        The load ramp ends at `t` when the contact gives its load away and begins at `t` when it takes it. A contact
        that slides keeps as much load as it may carry then.
        """

        def begin(stack: Stack) -> None:
            light = SLIDING_LOAD_RAMP if "sliding" in (mode, stack.contact(point).mode) else 0.0
            before, after = (light, 1.0) if mode == "fixed" else (1.0, light)
            self._load_ramps.append(LoadRamp(point, start, start + ramp, before, after))

        start = t if mode == "fixed" else t - ramp
        self.at(start, f"{point} {'takes' if mode == 'fixed' else 'gives away'} its load", begin)
        return self.at(t, f"{point} {mode}", lambda stack: setattr(stack.contact(point), "mode", mode))

    def apply(self, t: float, stack: Stack, loads: Mapping[str, float] | None = None) -> list[str]:
        """Carry out the events that are due; returns their descriptions.

        Args:
            t: Time [s].
            stack: The stack to change.
            loads: Measured normal force on each foot [N], for schedules that use it.
        """
        done: list[str] = []
        stack.time = t
        while self._next_event < len(self.events) and self.events[self._next_event].t <= t + 1e-9:
            event = self.events[self._next_event]
            self._next_event += 1  # first: the event may itself add others
            event.change(stack)
            done.append(event.what)
        for ramp in self._load_ramps:
            stack.contact(ramp.point).load = ramp.load(t)
        self._load_ramps = [ramp for ramp in self._load_ramps if t < ramp.end]
        stack.advance(t)
        return done

    def motion_time(self, t: float) -> float:
        """The motion's time at a time of the run [s]: earlier where a schedule makes it wait."""
        return t

    def remarks(self) -> list[str]:
        """What happened otherwise than planned, a sentence each, once the run is over."""
        return [self.failure] if self.failure else []

    def observe(self, tick: Tick) -> None:
        """Look at the state of the robot; changes that follow from it are made by the next `apply`."""
