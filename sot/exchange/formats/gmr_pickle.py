"""The pickle of General Motion Retargeting (GMR): fps, root_pos [m], root_rot (xyzw), dof_pos [rad], MuJoCo's order."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.exchange.checks import motion_of_columns, numbers
from sot.exchange.restricted_pickle import read_pickle, write_pickle
from sot.exchange.robot_motion import RobotMotion
from sot.robots.robot import Robot

NEEDED = ("fps", "root_pos", "root_rot", "dof_pos")
NAME_KEYS = ("dof_joint_names", "joint_names", "joint_order")  # of the joints' names; some files have none


def write(motion: RobotMotion, path: Path) -> None:
    """Write the frames of a motion, with the joints' and links' names and the links' places in the root's frame."""
    links = motion.links
    to_world = Rotation.from_quat(motion.root_xyzw).as_matrix()
    local = np.einsum("tji,tbj->tbi", to_world, links.position - motion.root_position[:, None])
    content = {
        "fps": motion.rate,
        "root_pos": motion.root_position.copy(),
        "root_rot": motion.root_xyzw.copy(),
        "dof_pos": motion.angles.copy(),
        "local_body_pos": local,
        "link_body_list": list(links.names),
        "joint_names": list(motion.robot.joints),
    }
    write_pickle(path, content)


def read(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read a robot's motion; its frame rate is the file's.

    Raises:
        InputError: not such a file, hostile, or of another robot.
    """
    content: Any = read_pickle(path, "a motion of GMR")
    if not isinstance(content, dict) or (missing := [key for key in NEEDED if key not in content]):
        lacking = ", ".join(missing) if isinstance(content, dict) else "everything"
        raise InputError(f"{path}: not a motion of GMR, it lacks {lacking}")
    names = next((content[key] for key in NAME_KEYS if content.get(key) is not None), None)
    position, turns, angles = (numbers(path, key, content[key]) for key in NEEDED[1:])
    return motion_of_columns(path, robot, content["fps"], position, turns, angles, names)
