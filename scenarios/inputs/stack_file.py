"""A user's own stack, from a Python file with `stack(robot, motion)`; how it changes, and edits of the dance."""

import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import NamedTuple, TypeVar

from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.errors import InputError
from sot.motion.edit import Edit
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.text_file import read_text

Result = TypeVar("Result")


class Composition(NamedTuple):
    """A stack, the schedule that changes it over time, and the edits of the dance."""

    stack: Stack
    schedule: Schedule | None = None
    edits: tuple[Edit, ...] = ()


Composer = Callable[[Robot, Motion], Composition]


def load_stack(path: Path) -> Composer:
    """The function that composes a file's stack for a robot and a motion; also its schedule, if the file defines
    `schedule(robot, motion)`, and edits of the dance, if it defines `edits(robot, motion)`.

    Whatever the file raises, when it is loaded or when its functions run, becomes an InputError that names the line.

    Raises:
        InputError: no such file, it raises, or it defines no function `stack`.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such stack file; give a Python file that defines stack(robot, motion)")
    module = load_module(path)
    if not callable(getattr(module, "stack", None)):
        raise InputError(f"{path}: defines no function stack(robot, motion)")

    def made(name: str, kind: type[Result], robot: Robot, motion: Motion) -> Result:
        with as_input_error(path):
            result = getattr(module, name)(robot, motion)
        if not isinstance(result, kind):
            raise InputError(f"{path}: {name}(robot, motion) returned {type(result).__name__}, not a {kind.__name__}")
        return result

    def compose(robot: Robot, motion: Motion) -> Composition:
        stack = made("stack", Stack, robot, motion)
        schedule = made("schedule", Schedule, robot, motion) if hasattr(module, "schedule") else None
        edits = made("edits", list, robot, motion) if hasattr(module, "edits") else []
        if not all(isinstance(edit, Edit) for edit in edits):
            raise InputError(f"{path}: edits(robot, motion) returned a list with something else than Edit in it")
        return Composition(stack, schedule, tuple(replace(edit, source=edit.source or str(path)) for edit in edits))

    return compose


def load_module(path: Path) -> ModuleType:
    """A Python file of the user's, as a module.

    Raises:
        InputError: no such file, or it raises, with the line.
    """
    if not path.is_file() or path.suffix != ".py":
        raise InputError(f"{path}: no such file, or not a Python file (.py)")
    text, module = read_text(path), ModuleType(f"user_{path.stem}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # a data class looks for its module there
    with as_input_error(path):
        exec(compile(text, str(path), "exec", dont_inherit=True), module.__dict__)
    return module


@contextmanager
def blaming_stack_file(path: Path | None) -> Iterator[None]:
    """Turn an exception that comes from a stack file, by way of a reference or a task of its own, into an InputError.

    Raises:
        InputError: naming the file's line; exceptions that the file has no part in pass through.
    """
    try:
        yield
    except Exception as error:
        line = path and _line_in_file(path, error)
        if not line:
            raise
        raise InputError(f"{path}:{line}: {_error_text(error)}") from error


@contextmanager
def as_input_error(path: Path) -> Iterator[None]:
    """Turn any exception into an InputError that names the file's line.

    Raises:
        InputError: instead of anything else.
    """
    try:
        yield
    except SyntaxError as error:
        raise InputError(f"{path}:{error.lineno}: {error.msg}") from error
    except Exception as error:
        line = _line_in_file(path, error)
        raise InputError(f"{path}{f':{line}' if line else ''}: {_error_text(error)}") from error


def _line_in_file(path: Path, error: Exception) -> int | None:
    """The innermost line of the file that the exception, or the one that caused it, came through."""
    cause: BaseException | None = error
    own: list[int | None] = []
    while cause is not None:
        frames = traceback.extract_tb(cause.__traceback__)
        own += [frame.lineno for frame in frames if Path(frame.filename).resolve() == path.resolve()]
        cause = cause.__cause__
    return own[-1] if own else None


def _error_text(error: Exception) -> str:
    return str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
