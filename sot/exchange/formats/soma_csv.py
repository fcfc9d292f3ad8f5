"""The CSV of the SOMA retargeter and BONES-SEED: a header, root in centimetres and degrees, joints in degrees; no rate.

Columns: Frame, root_translateX..Z [cm], root_rotateX..Z [deg, about the world's x, y, z in turn], <joint>_dof [deg].
"""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.exchange.checks import given_rate, motion_of_columns
from sot.exchange.robot_motion import RobotMotion
from sot.robots.robot import Robot
from sot.text_file import read_text

ROOT = tuple(f"root_{what}{axis}" for what in ("translate", "rotate") for axis in "XYZ")
JOINT_ENDING = "_dof"
DIGITS = 7  # after the point: a nanometre


def write(motion: RobotMotion, path: Path) -> None:
    """Write the frames of a motion."""
    turns = Rotation.from_quat(motion.root_xyzw).as_euler("xyz", degrees=True)
    table = np.column_stack([np.arange(motion.count), 100.0 * motion.root_position, turns, np.rad2deg(motion.angles)])
    header = ",".join(["Frame", *ROOT, *(name + JOINT_ENDING for name in motion.robot.joints)])
    np.savetxt(
        path, table, fmt=["%d", *[f"%.{DIGITS}f"] * (table.shape[1] - 1)], delimiter=",", header=header, comments=""
    )


def read(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read frames of a robot's motion at a rate [Hz], which no such file holds.

    Raises:
        InputError: not such a file, of another robot, or no rate.
    """
    rate = given_rate(path, rate)
    lines = [line for line in read_text(path).splitlines() if line.strip()]
    names = [name.strip() for name in lines[0].split(",")] if lines else []
    if missing := [name for name in ROOT if name not in names]:
        raise InputError(f"{path}: its first line does not name {missing[0]}: not a CSV of this kind")
    try:
        table = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    except ValueError:
        raise InputError(f"{path}: not a table of numbers with as many in each row, separated by commas") from None
    if table.ndim != 2 or table.shape[1] != len(names):
        raise InputError(f"{path}: its rows have not as many numbers as the first line has names")
    root = table[:, [names.index(name) for name in ROOT]]
    joints = [name.removesuffix(JOINT_ENDING) for name in names if name.endswith(JOINT_ENDING)]
    angles = np.deg2rad(table[:, [k for k, name in enumerate(names) if name.endswith(JOINT_ENDING)]])
    if not np.isfinite(root).all():
        raise InputError(f"{path}: its root holds something that is not a finite number")
    turns = Rotation.from_euler("xyz", root[:, 3:], degrees=True).as_quat()
    return motion_of_columns(path, robot, rate, 0.01 * root[:, :3], turns, angles, joints)
