"""Named levels of tasks in order of priority."""

from collections.abc import Mapping, Sequence

from sot.control.task import Task
from sot.errors import InputError


class Levels:
    """Tasks in named levels, most important level first; every change is made at once.

    Args:
        levels: Tasks of each level, by the level's name, in order of priority.
    """

    def __init__(self, levels: Mapping[str, Sequence[Task]]) -> None:
        self._levels = {name: list(tasks) for name, tasks in levels.items()}

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
        """All tasks, in order of priority."""
        return [task for tasks in self._levels.values() for task in tasks]

    def task(self, name: str) -> Task:
        """The task of a name.

        Raises:
            InputError: If there is none.
        """
        for task in self.tasks:
            if task.name == name:
                return task
        raise InputError(f"the stack has no task '{name}': it has {', '.join(task.name for task in self.tasks)}")

    def level_of(self, task: Task) -> str | None:
        """Name of the level that a task is in; None if it is in none."""
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

    def place(self, task: Task, level: str) -> None:
        """Put a task last in a level that exists, out of any other that it is in."""
        self.take_out(task)
        self._levels[level].append(task)

    def take_out(self, task: Task) -> None:
        """Take a task out of its level, if it is in any."""
        for tasks in self._levels.values():
            tasks[:] = [other for other in tasks if other is not task]
