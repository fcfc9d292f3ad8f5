"""A user's own stack, from a Python file that defines `stack(robot, motion)`."""

import importlib.util
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from sot.errors import InputError
from sot.motion.trajectory import Motion
from sot.robot import Robot
from sot.stack import Stack

Composer = Callable[[Robot, Motion], Stack]


def load_stack(path: Path) -> Composer:
    """The function `stack` of a file.

    Whatever the file raises, when it is loaded or when its function composes the stack, becomes an InputError that
    names the line.

    Raises:
        InputError: no such file, it raises, or it defines no function `stack`.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such stack file; give a Python file that defines stack(robot, motion)")
    spec = importlib.util.spec_from_file_location("user_stack", path)
    if spec is None or spec.loader is None:
        raise InputError(f"{path}: not a Python file (.py)")
    module = importlib.util.module_from_spec(spec)
    _guarded(path, spec.loader.exec_module, module)
    composer = getattr(module, "stack", None)
    if not callable(composer):
        raise InputError(f"{path}: defines no function stack(robot, motion)")

    def compose(robot: Robot, motion: Motion) -> Stack:
        composed = _guarded(path, composer, robot, motion)
        if not isinstance(composed, Stack):
            raise InputError(f"{path}: stack(robot, motion) returned {type(composed).__name__}, not a Stack")
        return composed

    return compose


def _guarded(path: Path, function: Callable[..., Any], *arguments: Any) -> Any:
    try:
        return function(*arguments)
    except SyntaxError as error:
        raise InputError(f"{path}:{error.lineno}: {error.msg}") from error
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)
        own = [frame.lineno for frame in frames if Path(frame.filename).resolve() == path.resolve()]
        where = f"{path}:{own[-1]}" if own else f"{path}"
        what = str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
        raise InputError(f"{where}: {what}") from error
