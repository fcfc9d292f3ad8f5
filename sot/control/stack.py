"""The stack of tasks: named levels in order of priority, over hard limits and contacts."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from solvers.rows import Solution
from sot.control.contact import Contact
from sot.control.levels import Levels
from sot.control.load import Load
from sot.control.task import Task
from sot.control.tick import Tick, contact_named
from sot.control.transition import TASK_RAMP, Transition
from sot.errors import InputError

LOAD_RAMP = 0.2
"""Default time in which a load comes or goes [s]."""


class Stack(Levels):
    """Levels of tasks in order of priority, over contacts and hard limits; everything can change between two ticks.

    The equation of motion is always in level 0; so are the contacts and what `hard` lists.

    Before its controller's first tick, changes are made at once. While it runs, `add`, `remove` and `move` are eased
    within a ramp (see `Transition`), so that what the robot is asked for has no jump; with `ramp=0.0` they are not.

    Args:
        contacts: Pairs of surfaces that touch.
        hard: Limits that hold before any task.
        levels: Tasks of each level, by the level's name, in order of priority. Tasks of one level share by weight.
        loads: What the robot carries or is pulled by, and knows.

    Attributes:
        carried: Names of the things that count as the robot's own in mass, centre of mass and momentum.
        time: Time of the present tick [s]; None while the stack does not run.
        transition_shares: Name of each task that is coming, going or moving -> share of its transition that is done.

    Raises:
        InputError: If two tasks or two contacts have the same name.
    """

    def __init__(
        self,
        contacts: Iterable[Contact],
        hard: Iterable[Task],
        levels: Mapping[str, Sequence[Task]],
        loads: Iterable[Load] = (),
    ) -> None:
        super().__init__(levels)
        self.contacts = list(contacts)
        self.loads = list(loads)
        self.carried: list[str] = []
        self.hard = list(hard)
        self.time: float | None = None
        self.transition_shares: dict[str, float] = {}
        self._transitions: dict[str, Transition] = {}
        names = [task.name for task in (*self.hard, *self.tasks)] + [contact.name for contact in self.contacts]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"the stack has two entries named '{name}': give one of them another name")

    def status(self, tick: Tick, solution: Solution | None = None) -> str:
        """A table for a reader: every level with its tasks, their weights, numbers of rows, errors and units.

        Args:
            tick: A state; its rows are evaluated.
            solution: Of the same state; adds each level's slack (the weighted norm that it minimises) and how many
                inequalities of level 0 are active.
        """
        results = solution.levels if solution else []
        lines = [("level", "task", "weight", "rows", "error", "unit", "slack")]
        for k, (name, tasks) in enumerate([("hard", self.hard), *self.levels]):
            for task in tasks:
                rows = task.rows(tick)
                error = f"{np.sqrt(task.error @ task.error):.3g}"
                slack = f"{results[k].error:.3g}" if k < len(results) else ""
                lines.append(
                    (name, task.name, f"{task.weight:.3g}", str(len(rows.lower)), error, task.error_unit, slack)
                )
        if results:
            active = results[0].active
            for block in results[0].level.blocks:
                if not block.equality and (count := int(np.count_nonzero(active[block.rows]))):
                    lines.append(("", block.name, "", f"{count} active", "", "", ""))
        widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
        return "\n".join("  ".join(f"{c:<{w}}" for c, w in zip(line, widths, strict=True)).rstrip() for line in lines)

    def add(
        self, task: Task, level: str, before: str | None = None, ramp: float = TASK_RAMP, start: float | None = None
    ) -> None:
        """Add a task to a level; a level that is new comes before `before`, or last.

        While the stack runs, the task counts more and more for `ramp` [s] from `start` on, now unless given.

        Raises:
            InputError: If there is a task of that name, or no level `before`.
        """
        if any(task.name == other.name for other in (*self.hard, *self.tasks)):
            raise InputError(f"the stack has a task '{task.name}' already")
        self._begin_transition(task, level, before, ramp, start)

    def remove(self, name: str, ramp: float = TASK_RAMP, start: float | None = None) -> Task:
        """Take a task out of its level and return it.

        While the stack runs, the task counts less and less for `ramp` [s] from `start` on, now unless given; then it is
        out.

        Raises:
            InputError: If there is no task of that name.
        """
        task = self.task(name)
        self._begin_transition(task, None, None, ramp, start)
        return task

    def move(
        self, name: str, level: str, before: str | None = None, ramp: float = TASK_RAMP, start: float | None = None
    ) -> None:
        """Move a task to another level, made before `before` or last if it is new.

        While the stack runs, the task is there `ramp` [s] after `start`, now unless given.

        Raises:
            InputError: If there is no such task, or no level `before`.
        """
        self._begin_transition(self.task(name), level, before, ramp, start)

    def advance(self, t: float) -> None:
        """Let transitions be where they are at a time [s]; the controller calls it every tick."""
        self.time = t
        for load in self.loads:
            load.advance(t)
        self.loads = [load for load in self.loads if load.share or not load.is_going]
        for name, transition in list(self._transitions.items()):
            self.transition_shares[name] = transition.apply(t, self)
            if self.transition_shares[name] >= 1.0:
                del self.transition_shares[name], self._transitions[name]

    def add_load(self, load: Load, ramp: float = LOAD_RAMP) -> None:
        """Let the robot know of a mass that it carries, or of a wrench on it; it counts fully `ramp` [s] from now on.

        Raises:
            InputError: If there is a load of that name.
        """
        if any(load.name == other.name for other in self.loads):
            raise InputError(f"the stack has a load '{load.name}' already")
        if self.time is not None:
            load.begin_ramp(self.time, ramp, 0.0, 1.0)
        self.loads.append(load)

    def remove_load(self, name: str, ramp: float = LOAD_RAMP) -> Load:
        """Let a load go within `ramp` [s] and return it.

        Raises:
            InputError: If there is none of that name.
        """
        load = next((load for load in self.loads if load.name == name), None)
        if load is None:
            known = ", ".join(load.name for load in self.loads) or "none"
            raise InputError(f"the stack has no load '{name}': it has {known}")
        if self.time is None:
            self.loads.remove(load)
        else:
            load.begin_ramp(self.time, ramp, load.share, 0.0)
        return load

    def settle(self) -> None:
        """Finish all transitions at once, and make changes at once until the next tick: for the start of a run."""
        for transition in self._transitions.values():
            transition.finish(self)
        self._transitions.clear()
        self.transition_shares.clear()
        self.time = None

    def contact(self, name: str) -> Contact:
        """The contact of a name, or of a surface or point that has one only, to change its mode or load.

        Raises:
            InputError: If the stack has none.
        """
        return contact_named(self.contacts, name)

    def _begin_transition(
        self, task: Task, level: str | None, before: str | None, ramp: float, start: float | None
    ) -> None:
        """Begin to move a task to a level, None for out of the stack; an earlier transition of it is finished first."""
        if level is not None:
            self.add_level(level, before)
        earlier = self._transitions.pop(task.name, None)
        if earlier is not None:
            earlier.finish(self)
            del self.transition_shares[task.name]
        if self.time is None:
            Transition(self, task, level, 0.0, 0.0).finish(self)
            return
        transition = Transition(self, task, level, self.time if start is None else start, ramp)
        share = transition.apply(self.time, self)
        if share < 1.0:
            self._transitions[task.name], self.transition_shares[task.name] = transition, share
