"""Curves of a run for Otani's Figures 5, 7 and 8, and the figures that they come down to."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sim.log import RunLog
from sim.thing_paths import frame_path, hand_contacts
from sot.errors import InputError
from sot.motion.objects.events import ContactSets
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.whole_file import atomic_write

Array = NDArray[np.float64]

CURVES_FILE = "curves.npz"
DRAWN_RATE_HZ = 50.0
AVERAGED_S = 0.1
"""Time over which the torques of curves are averaged [s]: what a picture shows."""
HELD_AT_END_S = 1.0
"""Time before the end of a run over which a thing that nobody carries counts as held [s]."""


def curves_of(log: RunLog, system: System, clock: Array, label: str) -> dict[str, Any]:
    """The curves of a run's pictures.

    Args:
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
    return curves


def save_curves(path: Path, curves: dict[str, Any]) -> None:
    """Write a run's curves to a file (`.npz`)."""
    with atomic_write(path) as place:
        np.savez_compressed(place, **curves)


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


def leg_figures(curves: dict[str, Any], robot: Robot, history: Sequence[tuple[float, ContactSets]]) -> dict[str, Any]:
    """What Figures 5, 7 and 8 say of a run, in numbers.

    Args:
        curves: Of the run.
        robot: The robot.
        history: When the sets of contacts changed, and to what.

    Returns:
        The interval while a thing is carried over one leg, or else the last second; and over it the means of torques
        about pitch axes [N m] and of the hands' force [N], and how far the right foot is behind the left one at most
        [m].
    """
    time = curves["time"]
    ends = [*(start for start, _ in history[1:]), float(time[-1])]
    feet = set(robot.feet)
    over_one_leg = [
        (start, end)
        for (start, sets), end in zip(history, ends, strict=True)
        if _carries(sets) and len(feet & sets.supports) == 1
    ]
    begin, end = (over_one_leg[0][0], over_one_leg[-1][1]) if over_one_leg else (time[-1] - HELD_AT_END_S, time[-1])
    rows = (time >= begin) & (time <= end)

    def mean_torque(side: str, part: str) -> float:
        return float(curves["torque"][rows, pitch_joint(robot, side, part)].mean())

    return {
        "over_one_leg": bool(over_one_leg),
        "start_s": float(begin),
        "end_s": float(end),
        "left_hip_torque_mean_nm": mean_torque("left", "hip"),
        "left_knee_torque_mean_nm": mean_torque("left", "knee"),
        "right_ankle_torque_mean_nm": mean_torque("right", "ankle"),
        "right_foot_back_max_m": float(curves["right_foot_back"][rows].max()),
        "hand_force_mean_n": float(curves["hand_force"][rows].mean()),
    }


def _carries(sets: ContactSets) -> bool:
    """Whether hands hold a thing that rests on nothing else."""
    held = {pair.second.entity for pair in sets.pairs if pair.kind == "robot-thing"}
    return bool(held - {pair.first.entity for pair in sets.pairs if pair.kind == "thing-world"})


def pitch_joint(robot: Robot, side: str, part: str) -> int:
    """Number of the joint of a leg that pitches at hip, knee or ankle: in order, those that turn about Y at rest."""
    data = robot.model.createData()
    pin.computeJointJacobians(robot.model, data, robot.rest)
    leg = robot.groups[f"{side}_leg"]
    pitching = [joint for joint in leg if abs(data.J[4, 6 + joint]) > 0.9]
    return pitching[("hip", "knee", "ankle").index(part)]
