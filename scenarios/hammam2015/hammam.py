"""Constrained resolved acceleration control, Bin Hammam 2015, on real clips: printed, mended, and our cascade."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from scenarios.hammam2015.figures import (
    print_summaries,
    print_torque_law,
    run_figures,
    summary,
    violation_histogram,
)
from scenarios.hammam2015.key_point_reference import ClipPart, key_point_reference
from scenarios.hammam2015.kinematic_run import KinematicRun, follow_key_points
from scenarios.hammam2015.methods import METHODS, TASK_SETS
from scenarios.hammam2015.pictures import AFTER, BEFORE, PRINTED, draw_pictures, draw_powers
from scenarios.hammam2015.torque_law import STACKS, torque_law_run
from scenarios.replay import ProgressCallback
from sim.reference import hot_reference_us
from sot.robots.robot import Robot

ROBOT = "hrp2"
CLIPS = (
    ClipPart("groove", 0.0, 5.0),
    ClipPart("lafan1_dance1_subject2", 10.0, 5.0),
    ClipPart("lafan1_dance1_subject2", 60.0, 5.0),
    ClipPart("lafan1_aiming", 20.0, 5.0),
    ClipPart("lafan1_aiming", 120.0, 5.0),
    ClipPart("cmu_01_01", 0.0, 5.0),
)
POWER_PAIR = {"H": AFTER, "I": "CRAC mended, I"}


def study(rate: float, out: Path, tell: ProgressCallback, parts: Sequence[ClipPart] = CLIPS) -> dict[str, Any]:
    """Follow every clip by every method and with every task set, and by the torque law under physics.

    Args:
        rate: Of the control under physics [Hz]; what is kinematic runs at the paper's 100 Hz.
        out: Folder for the pictures.
        tell: Told of the progress.
        parts: Of clips, six unless given.
    """
    robot = Robot.load(ROBOT)
    clips: dict[str, dict[str, dict[str, Any]]] = {str(task_set): {} for task_set in TASK_SETS}
    torque_law: dict[str, dict[str, Any]] = {}
    histograms: dict[str, list[int]] = {}
    worst, drawn = -1.0, ""
    for k, part in enumerate(parts):
        reference = key_point_reference(part.human(), robot)
        runs: dict[tuple[int, str], KinematicRun] = {}
        for task_set in TASK_SETS:
            figures = clips[str(task_set)][part.label] = {}
            for name, method in METHODS.items():
                tell(f"{part.label}, set {task_set}, {name}", k / len(parts))
                runs[task_set, name] = follow_key_points(robot, method, reference, task_set)
                figures[name] = run_figures(runs[task_set, name], hot_reference_us())
        torque_law[part.label] = {}
        for kind in STACKS:
            tell(f"{part.label}, torque law, {kind}", (k + 0.5) / len(parts))
            torque_law[part.label][kind] = torque_law_run(robot, reference, kind, rate)
        before = float(runs[2, BEFORE].violations.mean())
        if before > worst:
            worst, drawn = before, part.label
            draw_pictures(out, robot, runs, part.label)
            histograms = {name: violation_histogram(runs[2, name]) for name in (BEFORE, PRINTED, AFTER)}
    powers = {
        task_set: {
            label: {kind: figures[name]["power_w"] for kind, name in POWER_PAIR.items()}
            for label, figures in of.items()
        }
        for task_set, of in clips.items()
    }
    draw_powers(out / "powers.svg", powers)
    return {
        "scenario": "hammam",
        "rate_hz": rate,
        "drawn": drawn,
        "summary": {task_set: {name: summary(of, name) for name in METHODS} for task_set, of in clips.items()},
        "clips": clips,
        "histograms": histograms,
        "torque_law": torque_law,
    }


def show(figures: dict[str, Any], console: Console) -> None:
    """Print the tables."""
    print_summaries(figures, console)
    console.print()
    print_torque_law(figures, console)
