"""Dariush's Figures 6, 7, 9, 11 and 12 of our own runs, as pictures that any browser shows."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from scenarios.dariush2009.experiments import PRIORITIES, CollisionRuns, LimitRuns
from scenarios.dariush2009.velocity_runs import VelocityRun
from scenarios.hammam2015.pictures import HANDS
from sim.reporting.chart import Curve, Panel, limit_lines, write_panels
from sot.robots.robot import Robot
from tasks.resolved.redirection import CRITICAL_DISTANCE, blending

COLORS = ("#999", "#d9762b", "#8a4fd9", "#2b6fd9")
DISTANCE_DRAWN = (-0.1, 0.3)
DRAWN_JOINTS = 3
"""Number of joints in Figure 7: those that are most out of their ranges without the weight."""


def draw_blending(path: Path) -> None:
    """Figure 9."""
    ratio = np.linspace(0.0, 2.0, 200)
    curves = [
        Curve(ratio, blending(ratio, shift), color, f"δ = {shift:g}")
        for shift, color in ((0.5, COLORS[1]), (1.0, COLORS[3]))
    ]
    write_panels(path, "Blending (23)", [Panel("Share of the redirected motion", "d / d_c", "b", curves)], 1)


def draw_priorities(path: Path, runs: Mapping[str, VelocityRun], label: str) -> None:
    """Figure 6: the errors of each level."""
    panels = []
    for level, title in zip(PRIORITIES, ("First: waist", "Second: wrists", "Third: the others"), strict=True):
        curves = []
        for (name, run), color in zip(runs.items(), COLORS, strict=False):
            error = 1e3 * np.sqrt(np.mean([np.square(run.errors[point]) for point in level], axis=0))
            curves.append(Curve(run.times, error, color, name))
        panels.append(Panel(title, "s", "mm", curves))
    write_panels(path, f"Errors by priority, {label}", panels, 1, (760.0, 200.0))


def draw_limits(path: Path, robot: Robot, runs: LimitRuns, label: str) -> None:
    """Figure 7: the joints that leave their ranges most, without and with the weight of (14)."""
    beyond = np.maximum(runs.free.q[:, 7:] - runs.upper, runs.lower - runs.free.q[:, 7:]).max(axis=0)
    panels = []
    for joint in np.argsort(-beyond)[:DRAWN_JOINTS].tolist():
        curves = [
            Curve(run.times, np.degrees(run.q[:, 7 + joint]), color, name)
            for name, run, color in (("without", runs.free, COLORS[0]), ("with (14)", runs.kept, COLORS[3]))
        ]
        ends = [float(np.degrees(side[joint])) for side in (runs.lower, runs.upper)]
        curves += limit_lines(ends, float(runs.free.times[-1]), "")
        panels.append(Panel(robot.joints[joint], "s", "deg", curves))
    write_panels(path, f"Joint limits by the weight of (14), {label}", panels, 1, (760.0, 200.0))


def draw_distances(path: Path, runs: CollisionRuns, label: str) -> None:
    """Figures 11 and 12."""
    panels = []
    for pair in HANDS:
        curves = [
            Curve(runs.times, np.clip(of[pair], *DISTANCE_DRAWN), color, name)
            for (name, of), color in zip(runs.distances.items(), COLORS, strict=True)
        ]
        curves += limit_lines([0.0, CRITICAL_DISTANCE], float(runs.times[-1]), "")
        panels.append(Panel(pair, "s", "m", curves))
    write_panels(path, f"Least distances by redirection (17)–(23), {label}", panels, 1, (760.0, 220.0))
