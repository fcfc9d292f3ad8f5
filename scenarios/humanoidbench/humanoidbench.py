"""HumanoidBench's push, package and door in the robot's size, done by footsteps and hands that are planned."""

from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

from rich.console import Console

from scenarios.humanoidbench import door, package, picture, push
from scenarios.replay import ProgressCallback, Replay, check_writable, make_solver, write_outputs
from sim.reporting import report

SCENES: dict[str, ModuleType] = {"push": push, "package": package, "door": door}
"""The scenes: `scene_run(request, seed, tell)` returns the run and its figures, `sentence(figures)` tells of them."""


@dataclass(frozen=True)
class BenchTrial:
    """Which scene, and where things are in it.

    Attributes:
        scene: Its name.
        seed: Of the places that the benchmark draws.
    """

    scene: str
    seed: int = 1

    takes_clip: ClassVar[bool] = False


DEFAULT_OPTIONS = BenchTrial("package")


def run(request: Replay, trial: BenchTrial, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Plan and run a scene, record and report.

    Args:
        request: Robot, solver, rate, pushes and mismatch.
        trial: The scene.
        out: Folder to write to.
        tell: Told of the progress.

    Raises:
        InputError: Anything in the request that does not fit; nothing is written then.
    """
    check_writable(out)
    make_solver(request.solver)
    danced, found = SCENES[trial.scene].scene_run(replace(request, clip=trial.scene), trial.seed, tell)
    figures = write_outputs(danced, out, tell, report.rounded({"scene": trial.scene, **found}))
    title = f"{trial.scene}, seed {trial.seed}, by {danced.motion.robot.label}"
    picture.draw(out / picture.PICTURE_FILE, danced, found["humanoidbench"].get("destination_m"), title)
    return figures


def show(figures: dict[str, Any], console: Console) -> None:
    """Print what became of the scene."""
    own = figures["humanoidbench"]
    words = "reached" if own["reached"] else "not reached"
    text = f"{figures['scene']}: {words}; {SCENES[figures['scene']].sentence(own)}"
    console.print(text, highlight=False, soft_wrap=True)
