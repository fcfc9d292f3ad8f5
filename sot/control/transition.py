"""Transitions of a task from one level of a stack to another, continuous in what the robot is asked for."""

from dataclasses import dataclass

from sot.control.levels import Levels
from sot.control.task import Task

TASK_RAMP = 0.2
"""Default time in which a task comes, goes, or changes its level [s]."""
NEGLIGIBLE_SHARE, DOMINANT_SHARE = 1.0 / 30.0, 30.0
"""Factors on the weight of a task at which it hardly counts in its level, and at which hardly anything else counts."""
SHARE_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Stage:
    """Stay of a task in one level, while the factor on its weight goes from one value to another."""

    level: str
    start_share: float
    end_share: float


class Transition:
    """Moves a task to another level of a stack by way of its weight.

    A level of one task is equivalent to the level below it with that task in it at an unbounded weight, and to the
    level above it with that task in it at a vanishing weight. So a task rises through the levels, in each until little
    else counts there; a task that comes rises from below all levels, and one that goes sinks.

    Args:
        stack: The levels.
        task: The task to move, in one of them already or not yet.
        level: Its level at the end, one of them; None to take it out.
        start: When the transition begins [s].
        ramp: How long it takes [s].
    """

    def __init__(self, stack: Levels, task: Task, level: str | None, start: float, ramp: float) -> None:
        self.task = task
        self._level, self._weight, self._start, self._ramp = level, task.weight, start, ramp
        self._stages = _stages_of_way(stack, task, level)
        self._stage: Stage | None = None

    def apply(self, t: float, stack: Levels) -> float:
        """Set the task's level and weight at a time [s]; returns the share of the transition done, 1 at the end."""
        share = min(max((t - self._start) / self._ramp, 0.0), 1.0) if self._ramp else 1.0
        if share > 1.0 - SHARE_TOLERANCE or not self._stages:
            self.finish(stack)
            return 1.0
        along = share * len(self._stages)
        stage = self._stages[int(along)]
        if stage is not self._stage:
            self._stage = stage
            stack.place(self.task, stage.level)
        self.task.weight = self._weight * stage.start_share * (stage.end_share / stage.start_share) ** (along % 1.0)
        return share

    def finish(self, stack: Levels) -> None:
        """Set the task's level and weight as they are at the end."""
        self.task.weight = self._weight
        if self._level is not None:
            stack.place(self.task, self._level)
        else:
            stack.take_out(self.task)


def _stages_of_way(stack: Levels, task: Task, level: str | None) -> list[Stage]:
    """Stages from the present level of a task to another; None stands for below all levels."""
    order = stack.level_names
    now = stack.level_of(task)
    start, end = (len(order) if name is None else order.index(name) for name in (now, level))
    if end < start:
        return _rising_stages(stack, task, order[end:], now)
    rising = _rising_stages(stack, task, order[start:], level) if start < end else []
    return [Stage(stage.level, stage.end_share, stage.start_share) for stage in reversed(rising)]


def _rising_stages(stack: Levels, task: Task, levels: list[str], low: str | None) -> list[Stage]:
    """Stages from the level `low`, or from below all levels, up to the first of `levels`."""
    high = levels[0]
    stages = []
    for level in reversed(levels if low is None else levels[: levels.index(low) + 1]):
        if any(other is not task for name, tasks in stack.levels if name == level for other in tasks):
            stages.append(
                Stage(level, 1.0 if level == low else NEGLIGIBLE_SHARE, 1.0 if level == high else DOMINANT_SHARE)
            )
    return stages
