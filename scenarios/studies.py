"""Scenarios: dances, each a module with its motion, its stack and its schedule; dances of a clip; and studies."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

from rich.console import Console

from scenarios.dariush2009 import dariush
from scenarios.hammam2015 import hammam
from scenarios.hammam2015.key_point_reference import ClipPart
from scenarios.humanoidbench import humanoidbench
from scenarios.humanoidbench.humanoidbench import BenchTrial
from scenarios.inputs.scenario_file import load_scenario
from scenarios.inputs.stack_file import Composition
from scenarios.kimoh2013 import imitation, planar3r, printed_bounds
from scenarios.kimoh2013.damping import damping
from scenarios.kimoh2013.damping.damping import DampingOptions
from scenarios.legs import legs
from scenarios.otani2017 import otani
from scenarios.otani2017.bag.bag import BagTrial
from scenarios.otani2017.carrying.carry import Carrying
from scenarios.otani2017.carrying.cart import Pushing
from scenarios.otani2017.otani import Handling
from scenarios.ramos2011 import ramos, sliding
from scenarios.replay import (
    REPORT_FILE,
    Dance,
    ProgressCallback,
    Replay,
    check_writable,
    make_solver,
    run_motion,
    write_outputs,
)
from scenarios.stairs import stairs
from scenarios.stairs.stairs import Stairs
from sim.reporting import report
from sot.errors import InputError
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot

MOTION_SCENARIOS: dict[str, ModuleType] = {"sliding": sliding, "imitation": imitation}
"""Scenarios of a robot under physics. They may name their `SOLVER`, and add `findings` to the report with a way to
`show` them."""
STUDIES: dict[str, ModuleType] = {"planar3r": planar3r, "bounds": printed_bounds}
"""Scenarios without physics: `study(rate, out, tell)` returns figures, `show(figures, console)` prints them."""
CLIP_STUDIES: dict[str, ModuleType] = {"hammam": hammam, "dariush": dariush, "legs": legs}
"""Studies of clips, their `CLIPS` unless one is named: `study(rate, out, tell, parts)`, the rest as of STUDIES.
One whose `TAKES_RATE` is false has nothing under physics, and is given no rate."""
CLIP_SCENARIOS: dict[str, ModuleType] = {"ramos": ramos}
"""Scenarios that dance a clip, their `CLIP` unless another is named: `run(request, out, tell)` returns the report,
`show(report, console)` prints it."""
OPTION_SCENARIOS: dict[str, ModuleType] = {
    "otani": otani,
    "damping": damping,
    "stairs": stairs,
    "humanoidbench": humanoidbench,
}
"""Scenarios with options of their own: `run(request, options, out, tell)` returns the report, `show(report, console)`
prints it."""
SCENARIOS = {**MOTION_SCENARIOS, **CLIP_SCENARIOS, **OPTION_SCENARIOS, **STUDIES, **CLIP_STUDIES}

Show = Callable[[dict[str, Any], Console], None]


def default_solver(name: str) -> str:
    """Name of the solver that a scenario uses unless told otherwise."""
    return getattr(SCENARIOS.get(name), "SOLVER", "cascade")


def is_file(name: str) -> bool:
    """Whether a scenario is a user's own file."""
    return name.endswith(".py")


def run_scenario(
    name: str,
    clip: str | None,
    request: Replay,
    out: Path,
    tell: ProgressCallback,
    options: Handling | BagTrial | Carrying | Pushing | DampingOptions | Stairs | BenchTrial | None = None,
) -> tuple[dict[str, Any], Show | None]:
    """Run a scenario, record and report; the files appear in the folder `out`.

    Args:
        name: Of the scenario, or a user's own file (.py), see `scenarios.Scenario`.
        clip: Which it is to dance; its own unless given.
        request: The rest of what is asked for.
        out: Folder to write to.
        tell: Told of the progress.
        options: Of a scenario that has some of its own.

    Returns:
        The report, and what prints the part of it that is the scenario's own, if there is one.

    Raises:
        InputError: no such scenario, or anything in the request that does not fit; nothing is written then.
    """
    if name not in SCENARIOS and not is_file(name):
        raise InputError(f"unknown scenario '{name}': choose one of {', '.join(SCENARIOS)}, or give a file (.py)")
    if name in OPTION_SCENARIOS:
        scenario = OPTION_SCENARIOS[name]
        chosen = options or scenario.DEFAULT_OPTIONS
        if not chosen.takes_clip and (clip or request.start or request.duration is not None):
            raise InputError(f"{name} has motions of its own: leave the clip and its part out")
        return scenario.run(replace(request, clip=clip or ""), chosen, out, tell), scenario.show
    if name in CLIP_SCENARIOS:
        scenario = CLIP_SCENARIOS[name]
        return scenario.run(replace(request, clip=clip or scenario.CLIP), out, tell), scenario.show
    if name in CLIP_STUDIES:
        parts = [ClipPart(clip, request.start, request.duration)] if clip else CLIP_STUDIES[name].CLIPS
        if not clip and (request.start or request.duration is not None):
            raise InputError(f"{name} has clips of its own, each with its part: name the clip that --start is of")
        return _run_study(CLIP_STUDIES[name], replace(request, clip=name, start=0.0, duration=None), out, tell, parts)
    if clip or request.start or request.duration is not None:
        known = ", ".join([*CLIP_SCENARIOS, *CLIP_STUDIES])
        raise InputError(f"{name} dances no clip: leave the clip and its part out, or run {known}")
    request = replace(request, clip=name)
    check_writable(out)
    if is_file(name):
        return write_outputs(_perform_file(Path(name), request, tell), out, tell), None
    scenario = SCENARIOS[name]
    if name in STUDIES:
        return _run_study(scenario, request, out, tell)
    make_solver(request.solver)  # before any work
    tell("planning", None)
    motion = scenario.motion(Robot.load(request.robot), request.rate)

    def compose(robot: Robot, motion: Motion) -> Composition:
        return Composition(scenario.stack(robot, motion), scenario.schedule(robot, motion))

    danced = run_motion(request, compose, motion, None, tell)
    if not hasattr(scenario, "findings"):
        return write_outputs(danced, out, tell), None
    return write_outputs(danced, out, tell, {name: scenario.findings(danced, out, tell)}), scenario.show


def _run_study(
    scenario: ModuleType, request: Replay, out: Path, tell: ProgressCallback, *parts: Sequence[ClipPart]
) -> tuple[dict[str, Any], Show]:
    """Run a study; `parts` of clips, if it is of clips."""
    name = request.clip
    takes_rate = getattr(scenario, "TAKES_RATE", True)
    if request != Replay(name, rate=request.rate if takes_rate else Replay.rate, feet=request.feet):
        options = [*(["--clip", "--start", "--duration"] if parts else []), *(["--rate"] if takes_rate else [])]
        raise InputError(f"{name} is a study: it takes no options but {', '.join(options)} and --out")
    check_writable(out)
    out.mkdir(parents=True, exist_ok=True)
    figures = scenario.study(*((request.rate,) if takes_rate else ()), out, tell, *parts)
    report.write_json(figures, out / REPORT_FILE)
    return figures, scenario.show


def _perform_file(path: Path, request: Replay, tell: ProgressCallback) -> Dance:
    """Run the scenario of a user's own file."""
    make = load_scenario(path)
    make_solver(request.solver)  # before any work
    tell("planning", None)
    scenario = make(Robot.load(request.robot), request.rate)

    def compose(robot: Robot, motion: Motion) -> Composition:
        return Composition(scenario.stack, scenario.schedule, tuple(scenario.edits))

    request = replace(request, stack=path)
    return run_motion(request, compose, scenario.motion, None, tell, scenario.scene, scenario.solver)
