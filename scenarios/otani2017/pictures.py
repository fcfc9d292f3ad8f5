"""Figures 5, 7 and 8 of Otani 2017: one run's curves, or several runs' over the demonstration's time.

`python -m scenarios.otani2017.pictures DIR... FILE.svg` draws several runs that `sot run otani` wrote.
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenarios.otani2017.curves import load_curves, pitch_joint
from sim.reporting.chart import Curve, Panel, write_panels
from sot.robots.robot import Robot

Array = NDArray[np.float64]

PICTURE_FILE = "curves.svg"
MM_PER_M = 1e3
COLORS = ("#1560d4", "#d9682b", "#2b9a4a", "#8a4fc9", "#555555")


def draw(path: Path, runs: Sequence[dict[str, Any]], title: str) -> None:
    """Draw the pictures of runs of one study, a colour each."""
    robot = Robot.load(str(runs[0]["robot"]))
    sagittal = [pitch_joint(robot, "left", "hip"), pitch_joint(robot, "left", "knee")]
    if all("angle" in run for run in runs):
        ankle = pitch_joint(robot, "right", "ankle")
        panels = [
            _panel("5: right ankle, torque", "N m", runs, lambda run: run["torque"][:, ankle]),
            _panel("hinge", "deg", runs, lambda run: run["angle"]),
            _panel("hand, normal force", "N", runs, lambda run: run["hand_force"]),
        ]
    else:
        panels = [
            _panel("7: free foot behind the other one", "mm", runs, lambda run: MM_PER_M * run["right_foot_back"]),
            _panel("8: left hip, torque", "N m", runs, lambda run: run["torque"][:, sagittal[0]]),
            _panel("8: left knee, torque", "N m", runs, lambda run: run["torque"][:, sagittal[1]]),
            _panel("hands, sum of normal forces", "N", runs, lambda run: run["hand_force"]),
        ]
    write_panels(path, title, panels, 2)


def _panel(title: str, unit: str, runs: Sequence[dict[str, Any]], value: Callable[[dict[str, Any]], Array]) -> Panel:
    curves = [Curve(run["clock"], value(run), COLORS[k % len(COLORS)], str(run["label"])) for k, run in enumerate(runs)]
    return Panel(title, "s of the demonstration", unit, curves)


if __name__ == "__main__":
    *folders, target = map(Path, sys.argv[1:])
    draw(target, [load_curves(folder) for folder in folders], ", ".join(folder.name for folder in folders))
