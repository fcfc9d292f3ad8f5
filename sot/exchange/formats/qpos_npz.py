"""The npz of OmniRetarget and of Humanoid-GPT: qpos in MuJoCo's order, the robot's first, then any object's.

A row a frame: root xyz [m], quaternion wxyz, joints [rad]; the rate is `fps` or `frequency`.
"""

from pathlib import Path

import numpy as np

from sot.array_file import read_arrays
from sot.errors import InputError
from sot.exchange.checks import checked_rate, given_rate, motion_of_columns, numbers
from sot.exchange.robot_motion import RobotMotion
from sot.robots.robot import Robot

RATE_KEYS = ("fps", "frequency")
OBJECT_WIDTH = 7  # columns of an object after the robot's


def write(motion: RobotMotion, path: Path) -> None:
    """Write a motion, with the joints' names."""
    linear, angular = motion.root_velocity[0], motion.v[:, 3:6]
    np.savez(
        path,
        fps=np.array(motion.rate),
        qpos=np.hstack([motion.root_position, motion.root_wxyz, motion.angles]),
        qvel=np.hstack([linear, angular, motion.joint_velocities]),
        joint_names=np.array(motion.robot.joints),
    )


def read(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read the robot's part of a motion; its frame rate is the file's, or `rate` where it holds none.

    Raises:
        InputError: not such a file, of another robot, or no rate.
    """
    content = read_arrays(path, "a motion")
    if "qpos" not in content:
        raise InputError(f"{path}: not such a motion, it lacks qpos")
    found = next((content[key] for key in RATE_KEYS if key in content), None)
    rate = given_rate(path, rate) if found is None else checked_rate(path, found)
    qpos, width = numbers(path, "qpos", content["qpos"]), 7 + robot.na
    if qpos.ndim != 2 or qpos.shape[1] not in (width, width + OBJECT_WIDTH):
        raise InputError(f"{path}: qpos has shape {qpos.shape}, expected (T, {width}) for {robot.label}")
    names = content["joint_names"].tolist() if "joint_names" in content else None
    return motion_of_columns(path, robot, rate, qpos[:, :3], qpos[:, [4, 5, 6, 3]], qpos[:, 7:width], names)
