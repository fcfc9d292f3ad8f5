"""Scenarios that need no clip: each a module with its motion, its stack and its schedule."""

from pathlib import Path
from types import ModuleType
from typing import Any

from scenarios import sliding
from scenarios.replay import Replay, Tell, check_writable, keep, make_solver, perform
from scenarios.stack_file import Composition
from sot.errors import InputError
from sot.motion.trajectory import Motion
from sot.robot import Robot

SCENARIOS: dict[str, ModuleType] = {"sliding": sliding}


def run_scenario(request: Replay, out: Path, tell: Tell) -> dict[str, Any]:
    """Run the scenario that a request names as its clip, record and report; the files appear in the folder `out`.

    Returns:
        The report.

    Raises:
        InputError: no such scenario, or anything in the request that does not fit; nothing is written then.
    """
    scenario = SCENARIOS.get(request.clip)
    if scenario is None:
        raise InputError(f"unknown scenario '{request.clip}': choose one of {', '.join(SCENARIOS)}")
    check_writable(out)
    make_solver(request.solver)  # before any work
    tell("planning", None)
    motion = scenario.motion(Robot.load(request.robot), request.rate)

    def compose(robot: Robot, motion: Motion) -> Composition:
        return scenario.stack(robot, motion), scenario.schedule(robot, motion)

    return keep(perform(request, compose, motion, None, tell), out, tell)
