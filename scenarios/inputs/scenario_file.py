"""A user's own scenario, from a Python file with `scenario(robot, rate)`."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from scenarios.inputs.stack_file import as_input_error, load_module
from scenarios.scenario import Scenario
from sot.errors import InputError
from sot.robots.robot import Robot


def load_scenario(path: Path) -> Callable[[Robot, float], Scenario]:
    """The function that makes a file's scenario for a robot and a rate [Hz].

    Whatever the file raises, when it is loaded or when its function runs, becomes an InputError that names the line.

    Raises:
        InputError: no such file, it raises, or it defines no function `scenario`.
    """
    module = load_module(path)
    if not callable(getattr(module, "scenario", None)):
        raise InputError(f"{path}: defines no function scenario(robot, rate)")

    def make(robot: Robot, rate: float) -> Scenario:
        with as_input_error(path):
            made = module.scenario(robot, rate)
        if not isinstance(made, Scenario):
            raise InputError(f"{path}: scenario(robot, rate) returned {type(made).__name__}, not a Scenario")
        return replace(made, edits=[replace(edit, source=edit.source or str(path)) for edit in made.edits])

    return make
