"""The motion library pickle of PHC, ASAP, PBHC and SONIC: clip -> root, joints and the turn of every body's joint.

root_trans_offset [m], root_rot (xyzw), dof [rad], pose_aa (T, bodies, 3): the root's rotation vector, then each joint's
axis times its angle; contact_mask (T, 2) as PBHC has it, left and right; smpl_joints are zeros, which readers accept.
"""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.exchange.checks import motion_of_columns, numbers
from sot.exchange.restricted_pickle import read_pickle, write_pickle
from sot.exchange.robot_motion import RobotMotion
from sot.robots.robot import Robot

SMPL_JOINTS = 24
NEEDED = ("root_trans_offset", "root_rot", "dof", "fps")


def write(motion: RobotMotion, path: Path) -> None:
    """Write a library of one clip.

    Raises:
        InputError: the rate is no whole number, as these libraries take it.
    """
    if motion.rate != round(motion.rate):
        raise InputError(f"{path}: {motion.rate:g} frames per second; this format takes a whole number, name one")
    axes = np.array([hinge.axis for hinge in motion.robot.tree.hinges])
    turns = Rotation.from_quat(motion.root_xyzw).as_rotvec()
    entry: dict[str, Any] = {
        "root_trans_offset": motion.root_position.copy(),
        "root_rot": motion.root_xyzw.copy(),
        "dof": motion.angles.copy(),
        "pose_aa": np.concatenate([turns[:, None], motion.angles[:, :, None] * axes], axis=1),
        "smpl_joints": np.zeros((motion.count, SMPL_JOINTS, 3)),
        "fps": int(motion.rate),
        "joint_names": list(motion.robot.joints),
    }
    if motion.contacts is not None:
        entry["contact_mask"] = motion.contacts.astype(np.float32)
    write_pickle(path, {motion.name: entry})


def read(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read the one clip of a library; its frame rate is the file's.

    Raises:
        InputError: not such a file, hostile, of several clips, or of another robot.
    """
    content: Any = read_pickle(path, "a motion library")
    if not isinstance(content, dict) or not content or not all(isinstance(one, dict) for one in content.values()):
        raise InputError(f"{path}: not a motion library: expected clips by their names")
    if len(content) > 1:
        raise InputError(f"{path}: holds {len(content)} clips; split it into a file a clip")
    entry = next(iter(content.values()))
    if missing := [key for key in NEEDED if key not in entry]:
        raise InputError(f"{path}: not a motion library, its clip lacks {', '.join(missing)}")
    position, turns, angles = (numbers(path, key, entry[key]) for key in NEEDED[:3])
    return motion_of_columns(path, robot, entry["fps"], position, turns, angles, entry.get("joint_names"))
