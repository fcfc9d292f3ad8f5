"""A task on its way from one place of a stack to another, without a jump of what the robot is asked for."""

from dataclasses import dataclass

from sot.control.stack import Stack
from sot.control.task import Task

SLIGHT, HEAVY = 1.0 / 30.0, 30.0
"""Shares of its weight with which a task in a level hardly counts, and with which hardly anything else counts."""
ARRIVED = 1e-9


@dataclass(frozen=True)
class Stage:
    """A guest in a level, whose share of its own weight goes from one value to another."""

    level: str
    before: float
    after: float


class Transition:
    """Leads a task to another place of a stack by its weight.

    A level of one task alone is as good as the level below it with that task as a guest whose weight has no bound, and
    as the level above it with one whose weight is next to nothing. So a task rises through the levels, a guest of each
    until little else counts there; one that comes rises from below all of them, and one that goes sinks.

    Args:
        stack: Where it moves; its new level is made, empty yet.
        task: What moves: in the stack already, or not yet.
        level: Where it is to be; None for nowhere.
        before: If that level is new, which one it comes before; last unless given.
        start: When the way begins [s].
        ramp: How long it takes [s].

    Raises:
        InputError: If there is no level `before`.
    """

    def __init__(
        self, stack: Stack, task: Task, level: str | None, before: str | None, start: float, ramp: float
    ) -> None:
        if level is not None:
            stack.open(level, before)
        self.task = task
        self._level, self._weight, self._start, self._ramp = level, task.weight, start, ramp
        self._stages = _way(stack, task, level)
        self._stage: Stage | None = None

    def apply(self, t: float, stack: Stack) -> float:
        """Let the task be where it is at a time [s]; returns the share of its way, 1 where it is to be."""
        share = min(max((t - self._start) / self._ramp, 0.0), 1.0) if self._ramp else 1.0
        if share > 1.0 - ARRIVED or not self._stages:
            self.finish(stack)
            return 1.0
        along = share * len(self._stages)
        stage = self._stages[int(along)]
        if stage is not self._stage:
            self._stage = stage
            _put(stack, self.task, stage.level)
        self.task.weight = self._weight * stage.before * (stage.after / stage.before) ** (along % 1.0)
        return share

    def finish(self, stack: Stack) -> None:
        """Put the task where it is to be."""
        self.task.weight = self._weight
        if self._level is not None:
            _put(stack, self.task, self._level)
        elif stack.level_of(self.task) is not None:
            stack.remove(self.task.name)


def _put(stack: Stack, task: Task, level: str) -> None:
    if stack.level_of(task) is None:
        stack.add(task, level)
    else:
        stack.move(task.name, level)


def _way(stack: Stack, task: Task, level: str | None) -> list[Stage]:
    """Stages from where a task is to a level; None for nowhere, which is as good as below all levels."""
    order = stack.order
    now = stack.level_of(task)
    start, end = (len(order) if name is None else order.index(name) for name in (now, level))
    if end < start:
        return _rising(stack, task, order[end:], now)
    rising = _rising(stack, task, order[start:], level) if start < end else []
    return [Stage(stage.level, stage.after, stage.before) for stage in reversed(rising)]


def _rising(stack: Stack, task: Task, levels: list[str], low: str | None) -> list[Stage]:
    """Stages from the level `low`, or from below all, up to the first of some levels."""
    high = levels[0]
    stages = []
    for level in reversed(levels if low is None else levels[: levels.index(low) + 1]):
        if any(other is not task for name, tasks in stack.levels if name == level for other in tasks):
            stages.append(Stage(level, 1.0 if level == low else SLIGHT, 1.0 if level == high else HEAVY))
    return stages
