"""holosoma's tracking npz: the tracking npz's keys with other widths, since the root is part of the joints' arrays.

joint_pos (T, 7 + n): root xyz, quaternion wxyz, joints; joint_vel (T, 6 + n): root linear, angular, joints; bodies with
one called "world" first; joint_names and body_names. Double precision.
"""

from pathlib import Path

import numpy as np

from sot.array_file import read_arrays
from sot.errors import InputError
from sot.exchange.checks import checked_rate, motion_of_columns, numbers
from sot.exchange.formats.tracking_npz import WXYZ, check_link_places
from sot.exchange.robot_motion import RobotMotion, link_names
from sot.robots.robot import Robot

WORLD = "world"
NEEDED = ("fps", "joint_pos", "joint_names", "body_names", "body_pos_w")


def write(motion: RobotMotion, path: Path) -> None:
    """Write a motion."""
    links, (linear, angular), still = motion.links, motion.root_velocity, np.zeros((motion.count, 1, 3))
    upright = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (motion.count, 1, 4))
    np.savez(
        path,
        fps=np.array([motion.rate]),
        joint_pos=np.hstack([motion.root_position, motion.root_wxyz, motion.angles]),
        joint_vel=np.hstack([linear, angular, motion.joint_velocities]),
        body_pos_w=np.concatenate([still, links.position], axis=1),
        body_quat_w=np.concatenate([upright, links.rotation[..., WXYZ]], axis=1),
        body_lin_vel_w=np.concatenate([still, links.linear], axis=1),
        body_ang_vel_w=np.concatenate([still, links.angular], axis=1),
        joint_names=np.array(motion.robot.joints),
        body_names=np.array([WORLD, *links.names]),
    )


def read(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read a motion; its frame rate is the file's.

    Raises:
        InputError: not such a file, its links are not where its joints put them, or of another robot.
    """
    content = read_arrays(path, "a motion of holosoma")
    if missing := [key for key in NEEDED if key not in content]:
        raise InputError(f"{path}: not a motion of holosoma, it lacks {', '.join(missing)}")
    table, places = numbers(path, "joint_pos", content["joint_pos"]), numbers(path, "body_pos_w", content["body_pos_w"])
    names, bodies = ([str(name) for name in content[key].ravel()] for key in ("joint_names", "body_names"))
    if table.ndim != 2 or table.shape[1] != len(names) + 7:
        hint = "; without the root it is mjlab's: --from tracking-npz" if table.shape[-1:] == (len(names),) else ""
        raise InputError(f"{path}: joint_pos has shape {table.shape}, expected (T, 7 + {len(names)}){hint}")
    if places.shape != (len(table), len(bodies), 3):
        raise InputError(f"{path}: body_pos_w has shape {places.shape}, expected {(len(table), len(bodies), 3)}")
    rate = checked_rate(path, content["fps"])
    motion = motion_of_columns(path, robot, rate, table[:, :3], table[:, [4, 5, 6, 3]], table[:, 7:], names)
    known = [name for name in link_names(robot) if name in bodies]
    links = np.array([link_names(robot).index(name) for name in known], dtype=int)
    check_link_places(
        path, motion, links, places[:, [bodies.index(name) for name in known]], "a wrong order of bodies?"
    )
    return motion
