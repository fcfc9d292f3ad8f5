"""The CSV of Unitree's LAFAN1 retargeting, which BeyondMimic, mjlab and unitree_rl_lab convert: no header, no rate.

A row a frame: root position [m], root quaternion xyzw, joints [rad] in MuJoCo's order.
"""

from pathlib import Path

import numpy as np

from sot.errors import InputError
from sot.exchange.checks import given_rate, motion_of_columns
from sot.exchange.robot_motion import RobotMotion
from sot.robots.robot import Robot
from sot.text_file import read_text

DIGITS = 9  # after the point: a nanometre, a nanoradian


def write(motion: RobotMotion, path: Path) -> None:
    """Write the frames of a motion."""
    np.savetxt(path, motion.q, fmt=f"%.{DIGITS}f", delimiter=",")


def read(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read frames of a robot's motion at a rate [Hz], which no such file holds.

    Raises:
        InputError: not such a file, of another robot, or no rate.
    """
    rate = given_rate(path, rate)
    lines = [line for line in read_text(path).splitlines() if line.strip()]
    if lines and any(c.isalpha() and c not in "eE" for c in lines[0]):
        raise InputError(
            f"{path}: begins with a header, {lines[0][:40]!r}: this format has none; of SOMA's kind, try soma-csv"
        )
    try:
        table = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    except ValueError:
        raise InputError(f"{path}: not a table of numbers with as many in each row, separated by commas") from None
    if table.ndim != 2 or table.shape[1] != 7 + robot.na:
        width = table.shape[1] if table.ndim == 2 else 0
        raise InputError(f"{path}: {width} columns, expected 7 + {robot.na} for {robot.label}")
    return motion_of_columns(path, robot, rate, table[:, :3], table[:, 3:7], table[:, 7:])
