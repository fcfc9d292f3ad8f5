"""The stack of tasks: named levels in order of priority, over hard limits and contacts."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from solvers.rows import Solution
from sot.control.contact import Contact
from sot.control.task import Task
from sot.control.tick import Tick
from sot.errors import InputError


class Stack:
    """Levels of tasks in order of priority, over contacts and hard limits; everything can change between two ticks.

    The equation of motion is always in level 0; so are the contacts and what `hard` lists.

    Args:
        contacts: Surfaces on the floor.
        hard: Limits that hold before any task.
        levels: Tasks of each level, by the level's name, in order of priority. Tasks of one level share by weight.

    Raises:
        InputError: If two tasks or two contacts have the same name.
    """

    def __init__(self, contacts: Iterable[Contact], hard: Iterable[Task], levels: Mapping[str, Sequence[Task]]) -> None:
        self.contacts = list(contacts)
        self.hard = list(hard)
        self._levels = {name: list(tasks) for name, tasks in levels.items()}
        names = [task.name for task in (*self.hard, *self.tasks)] + [contact.point for contact in self.contacts]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"the stack has two entries named '{name}': give one of them another name")

    @property
    def levels(self) -> list[tuple[str, list[Task]]]:
        """Names and tasks of the levels that have any, in order of priority."""
        return [(name, tasks) for name, tasks in self._levels.items() if tasks]

    @property
    def level_names(self) -> list[str]:
        """Names of all levels, in order of priority, those without tasks included."""
        return list(self._levels)

    @property
    def tasks(self) -> list[Task]:
        """All tasks below level 0, in order of priority."""
        return [task for tasks in self._levels.values() for task in tasks]

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

    def add(self, task: Task, level: str, before: str | None = None) -> None:
        """Add a task to a level; a level that is new comes before `before`, or last.

        Raises:
            InputError: If there is a task of that name, or no level `before`.
        """
        if any(task.name == other.name for other in (*self.hard, *self.tasks)):
            raise InputError(f"the stack has a task '{task.name}' already")
        self.add_level(level, before)
        self._levels[level].append(task)

    def remove(self, name: str) -> Task:
        """Take a task out of its level and return it.

        Raises:
            InputError: If there is no task of that name.
        """
        task = self.task(name)
        for tasks in self._levels.values():
            if task in tasks:
                tasks.remove(task)
        return task

    def move(self, name: str, level: str, before: str | None = None) -> None:
        """Move a task to another level, made before `before` or last if it is new.

        Raises:
            InputError: If there is no such task, or no level `before`.
        """
        task = self.task(name)  # before anything changes: an error leaves the stack as it was
        self.add_level(level, before)
        self.remove(name)
        self._levels[level].append(task)

    def contact(self, point: str) -> Contact:
        """The contact at an operational point, to change its mode or load.

        Raises:
            InputError: If the stack has none there.
        """
        for contact in self.contacts:
            if contact.point == point:
                return contact
        raise InputError(f"the stack has no contact '{point}': it has {', '.join(c.point for c in self.contacts)}")

    def task(self, name: str) -> Task:
        """The task of a name, in any level below the hard one.

        Raises:
            InputError: If there is none.
        """
        for task in self.tasks:
            if task.name == name:
                return task
        raise InputError(f"the stack has no task '{name}': it has {', '.join(task.name for task in self.tasks)}")

    def level_of(self, task: Task) -> str | None:
        """Name of the level that a task is in; None if it is not in the stack."""
        return next((name for name, tasks in self._levels.items() if any(task is other for other in tasks)), None)

    def add_level(self, level: str, before: str | None = None) -> None:
        """Make a level that is new, without tasks yet, before `before` or last.

        Raises:
            InputError: If there is no level `before`.
        """
        if level in self._levels:
            return
        if before is not None and before not in self._levels:
            raise InputError(f"the stack has no level '{before}': it has {', '.join(self._levels)}")
        order = list(self._levels)
        order.insert(len(order) if before is None else order.index(before), level)
        self._levels = {name: self._levels.get(name, []) for name in order}
