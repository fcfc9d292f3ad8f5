"""any4hdmi's data set: a folder with manifest.json and motions/<clip>.npz, each one array qpos in MuJoCo's order.

A row a frame: root xyz [m], quaternion wxyz, joints [rad]; the manifest names the columns and the time step.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

from sot.array_file import read_arrays
from sot.errors import InputError
from sot.exchange.checks import checked_rate, motion_of_columns, numbers
from sot.exchange.robot_motion import RobotMotion
from sot.robots.robot import Robot
from sot.text_file import read_text

MANIFEST, FOLDER, VERSION = "manifest.json", "motions", 2
ROOT_NAMES = ("root_x", "root_y", "root_z", "root_qw", "root_qx", "root_qy", "root_qz")


def write(motion: RobotMotion, path: Path) -> None:
    """Write a data set of one motion to a folder."""
    (path / FOLDER).mkdir(parents=True)
    qpos = np.hstack([motion.root_position, motion.root_wxyz, motion.angles])
    np.savez(path / FOLDER / f"{motion.name}.npz", qpos=qpos.astype(np.float32))
    manifest = {
        "format_version": VERSION,
        "dataset_name": motion.name,
        "mjcf": motion.robot.path.name,
        "motions_subdir": FOLDER,
        "timestep": 1.0 / motion.rate,
        "qpos_dim": qpos.shape[1],
        "qpos_names": [*ROOT_NAMES, *motion.robot.joints],
        "num_motions": 1,
        "source": motion.facts.get("source", ""),
    }
    (path / MANIFEST).write_text(json.dumps(manifest, indent=2) + "\n", encoding="utf-8")


def read(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read the one motion of a data set's folder, or the motion's file in one; the time step is the manifest's.

    Raises:
        InputError: no such data set, of several motions, or of another robot.
    """
    path = path.parent if path.name == MANIFEST else path
    root = path if path.is_dir() else next((up for up in path.parents if (up / MANIFEST).is_file()), None)
    if root is None or not (root / MANIFEST).is_file():
        raise InputError(f"{path}: no {MANIFEST} with it, which has the names and the time step")
    try:
        manifest: Any = json.loads(read_text(root / MANIFEST))
        names, step, folder = manifest["qpos_names"], float(manifest["timestep"]), str(manifest["motions_subdir"])
        files = sorted((root / folder).rglob("*.npz")) if path.is_dir() else [path]
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{root / MANIFEST}: cannot be read as a manifest: {type(error).__name__} {error}") from None
    if len(files) != 1:
        raise InputError(f"{root}: holds {len(files)} motions; name one of the files in {folder}")
    content = read_arrays(files[0], "a motion")
    qpos = numbers(files[0], "qpos", content.get("qpos", np.array(["missing"])))
    if not isinstance(names, list) or qpos.ndim != 2 or qpos.shape[1] != len(names) or not step > 0.0:
        raise InputError(f"{files[0]}: qpos has shape {qpos.shape}, and the manifest does not name as many columns")
    if rate is not None and abs(rate * step - 1.0) > 1e-6:
        raise InputError(f"{root / MANIFEST}: says {1.0 / step:g} frames per second, and --fps another number")
    rate = checked_rate(root / MANIFEST, round(1.0 / step, 6))
    return motion_of_columns(files[0], robot, rate, qpos[:, :3], qpos[:, [4, 5, 6, 3]], qpos[:, 7:], names[7:])
