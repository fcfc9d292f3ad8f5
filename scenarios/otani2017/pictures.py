"""Figures 5, 7 and 8 of Otani 2017: one run's curves, or several runs' over the demonstration's time.

`python -m scenarios.otani2017.pictures DIR... FILE.svg` draws several runs that `sot run otani` wrote.
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sim.log import RunLog
from sim.reporting.chart import Curve, Panel, write_panels
from sim.thing_paths import frame_path, hand_contacts
from sot.errors import InputError
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.whole_file import atomic_write

Array = NDArray[np.float64]

CURVES_FILE, PICTURE_FILE = "curves.npz", "curves.svg"
DRAWN_RATE_HZ = 50.0
AVERAGED_S = 0.1  # over which torques are averaged: what a picture shows
MM_PER_M = 1e3
COLORS = ("#1560d4", "#d9682b", "#2b9a4a", "#8a4fc9", "#555555")


def save_curves(path: Path, log: RunLog, system: System, clock: Array, label: str) -> dict[str, Any]:
    """Write the curves of a run's pictures to a file (`.npz`), and return them.

    Args:
        path: Of the file.
        log: Rows of the run.
        system: The robot and the things, as they are simulated.
        clock: The demonstration's time at every tick (T,) [s].
        label: What tells the run from others.
    """
    rows, robot = log.rows_at(DRAWN_RATE_HZ), system.robot
    window = max(1, round(AVERAGED_S / log.period))
    smooth = np.apply_along_axis(np.convolve, 0, log.torque, np.ones(window) / window, mode="same")
    feet = {foot: frame_path(log, system, foot, rows)[0] for foot in robot.feet}
    curves: dict[str, Any] = {
        "label": np.array(label),
        "robot": np.array(robot.name),
        "time": log.time[rows],
        "clock": clock[rows],
        "torque": smooth[rows],
        "right_foot_back": feet["left_foot"][:, 0] - feet["right_foot"][:, 0],
    }
    for thing in system.moving_things:
        if not thing.is_free:
            start = system.coordinates[thing.name].start - robot.nq
            curves["angle"] = np.degrees(log.thing_q[rows, start])
        hands = list(hand_contacts(log, system, thing.name))
        curves["hand_force"] = np.nan_to_num(log.contact_normal[rows][:, hands]).sum(axis=1)
    with atomic_write(path) as place:
        np.savez_compressed(place, **curves)
    return curves


def load_curves(folder: Path) -> dict[str, Any]:
    """The curves of a run.

    Raises:
        InputError: The folder holds none.
    """
    path = folder / CURVES_FILE
    if not path.is_file():
        raise InputError(f"{folder}: holds no {CURVES_FILE}; `sot run otani` writes it")
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def draw(path: Path, runs: Sequence[dict[str, Any]], title: str) -> None:
    """Draw the pictures of runs of one study, a colour each."""
    robot = Robot.load(str(runs[0]["robot"]))
    sagittal = [_pitch_joint(robot, "left", "hip"), _pitch_joint(robot, "left", "knee")]
    if all("angle" in run for run in runs):
        ankle = _pitch_joint(robot, "right", "ankle")
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


def _pitch_joint(robot: Robot, side: str, part: str) -> int:
    """Number of the joint of a leg that pitches at hip, knee or ankle: in order, those that turn about Y at rest."""
    data = robot.model.createData()
    pin.computeJointJacobians(robot.model, data, robot.rest)
    leg = robot.groups[f"{side}_leg"]
    pitching = [joint for joint in leg if abs(data.J[4, 6 + joint]) > 0.9]
    return pitching[("hip", "knee", "ankle").index(part)]


if __name__ == "__main__":
    *folders, target = map(Path, sys.argv[1:])
    draw(target, [load_curves(folder) for folder in folders], ", ".join(folder.name for folder in folders))
