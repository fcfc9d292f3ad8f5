"""Online transfer of human motion, Dariush 2009: its methods on our clips, Figures 5, 6, 7, 9, 11 and 12."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from scenarios.dariush2009.experiments import (
    collision_runs,
    confidence_figures,
    gain_figures,
    limit_runs,
    priority_runs,
    velocity_figures,
)
from scenarios.dariush2009.pictures import draw_blending, draw_distances, draw_limits, draw_priorities
from scenarios.dariush2009.tables import print_tables
from scenarios.hammam2015.hammam import CLIPS, ROBOT
from scenarios.hammam2015.key_point_reference import RATE, ClipPart, key_point_reference
from scenarios.replay import ProgressCallback
from sot.robots.robot import Robot
from tasks.resolved.virtual_limits import virtual_limits

TAKES_RATE = False
"""Nothing runs under physics: `study` is not given a rate."""


def study(out: Path, tell: ProgressCallback, parts: Sequence[ClipPart] = CLIPS) -> dict[str, Any]:
    """Run every experiment on every clip, all of it kinematic at the paper's 100 Hz.

    Args:
        out: Folder for the pictures.
        tell: Told of the progress.
        parts: Of clips, six unless given.
    """
    robot = Robot.load(ROBOT)
    lower, upper = virtual_limits(robot)
    figures: dict[str, dict[str, Any]] = {
        key: {} for key in ("gains", "priorities", "limits", "collisions", "velocities", "confidence")
    }
    draw_blending(out / "blending.svg")
    most_out, nearest = -np.inf, np.inf
    for k, part in enumerate(parts):
        share = k / len(parts)
        reference = key_point_reference(part.human(), robot)
        tell(f"{part.label}, gains and confidence", share)
        figures["gains"][part.label] = gain_figures(robot, reference)
        figures["confidence"][part.label] = confidence_figures(robot, reference)
        tell(f"{part.label}, priorities", share)
        priorities = priority_runs(robot, reference)
        figures["priorities"][part.label] = {name: found.figures for name, found in priorities.items()}
        tell(f"{part.label}, joint limits", share)
        limits = limit_runs(robot, reference, lower, upper)
        figures["limits"][part.label] = limits.figures
        figures["velocities"][part.label] = velocity_figures(robot, limits.kept)
        tell(f"{part.label}, collisions", share)
        collisions = collision_runs(robot, reference)
        figures["collisions"][part.label] = collisions.figures
        if limits.figures["without"]["beyond_rad"] > most_out:
            most_out = limits.figures["without"]["beyond_rad"]
            draw_limits(out / "limits.svg", robot, limits, part.label)
            draw_priorities(out / "priorities.svg", {name: found.run for name, found in priorities.items()}, part.label)
        if collisions.figures["without"] < nearest:
            nearest = collisions.figures["without"]
            draw_distances(out / "distances.svg", collisions, part.label)
    narrowed = (lower > robot.lower + 1e-9) | (upper < robot.upper - 1e-9)
    names = [name for name, one in zip(robot.joints, narrowed, strict=True) if one]
    return {"scenario": "dariush", "rate_hz": RATE, "virtual_limits": names, **figures}


def show(figures: dict[str, Any], console: Console) -> None:
    """Print the tables."""
    print_tables(figures, console)
