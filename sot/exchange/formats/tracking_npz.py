"""The tracking npz that BeyondMimic introduced: joints and the states of all links, in the simulator's own orders.

MuJoCo's trackers (mjlab) number links depth first, Isaac Lab's breadth first, and the loaders look at no names: a file
of the wrong kind loads and trains to nothing. Both kinds are written here with `joint_names` and `body_names` added,
and the links' places tell which kind a file is when it is read.
"""

from pathlib import Path
from typing import Any

import numpy as np

from sot.array_file import read_arrays
from sot.errors import InputError
from sot.exchange.body_orders import breadth_first_joints, breadth_first_links
from sot.exchange.checks import checked_rate, motion_of_columns, numbers
from sot.exchange.robot_motion import RobotMotion, link_names
from sot.robots.robot import Robot

NEEDED = ("fps", "joint_pos", "body_pos_w", "body_quat_w")
MAX_LINK_ERROR_LEGS = 0.05  # of a link's place in the file, off where its joints put it, over the root's height at rest
WXYZ, XYZW = [3, 0, 1, 2], [1, 2, 3, 0]


def write(motion: RobotMotion, path: Path) -> None:
    """Write a motion in MuJoCo's order of joints and links."""
    _write(motion, path, np.arange(motion.robot.na), np.arange(len(link_names(motion.robot))))


def write_isaac(motion: RobotMotion, path: Path) -> None:
    """Write a motion in Isaac Lab's order of joints and links."""
    _write(motion, path, breadth_first_joints(motion.robot), breadth_first_links(motion.robot))


def read(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read a motion in MuJoCo's order; its frame rate is the file's.

    Raises:
        InputError: not such a file, of another order, or of another robot.
    """
    return _read(path, robot, np.arange(robot.na), np.arange(len(link_names(robot))), "tracking-npz-isaac")


def read_isaac(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    """Read a motion in Isaac Lab's order; its frame rate is the file's.

    Raises:
        InputError: not such a file, of another order, or of another robot.
    """
    return _read(path, robot, breadth_first_joints(robot), breadth_first_links(robot), "tracking-npz")


def _write(motion: RobotMotion, path: Path, joints: np.ndarray, links: np.ndarray) -> None:
    states = motion.links.taken(links)
    arrays = {
        "joint_pos": motion.angles[:, joints],
        "joint_vel": motion.joint_velocities[:, joints],
        "body_pos_w": states.position,
        "body_quat_w": states.rotation[..., WXYZ],
        "body_lin_vel_w": states.linear,
        "body_ang_vel_w": states.angular,
    }
    content: dict[str, Any] = {name: values.astype(np.float32) for name, values in arrays.items()}
    content["fps"] = np.array([motion.rate])
    content["joint_names"] = np.array([motion.robot.joints[k] for k in joints])
    content["body_names"] = np.array(states.names)
    np.savez(path, **content)


def _read(path: Path, robot: Robot, joints: np.ndarray, links: np.ndarray, other: str) -> RobotMotion:
    content = read_arrays(path, "a tracking motion")
    if missing := [key for key in NEEDED if key not in content]:
        raise InputError(f"{path}: not a tracking motion, it lacks {', '.join(missing)}")
    angles, position, turns = (numbers(path, key, content[key]) for key in NEEDED[1:])
    if angles.ndim != 2 or angles.shape[1] != robot.na:
        hint = (
            "; with the root in joint_pos it is holosoma's: --from holosoma-npz"
            if angles.shape[-1:] == (robot.na + 7,)
            else ""
        )
        raise InputError(
            f"{path}: joint_pos has shape {angles.shape}, expected (T, {robot.na}) for {robot.label}{hint}"
        )
    if position.ndim != 3 or position.shape[1:] != (len(links), 3) or turns.shape != (*position.shape[:2], 4):
        raise InputError(
            f"{path}: body_pos_w and body_quat_w have shapes {position.shape} and {turns.shape}, expected"
            f" (T, {len(links)}, 3) and (T, {len(links)}, 4) for {robot.label}"
        )
    rate = checked_rate(path, content["fps"])
    in_robot_order = np.empty_like(angles)
    in_robot_order[:, joints] = angles
    motion = motion_of_columns(path, robot, rate, position[:, 0], turns[:, 0][:, XYZW], in_robot_order)
    check_link_places(path, motion, links, position, f"written in another order? Try --from {other}")
    return motion


def check_link_places(path: Path, motion: RobotMotion, links: np.ndarray, position: np.ndarray, hint: str) -> None:
    """Check that links are where the joints put them: a file's places (T, B, 3) against those of some links [m].

    Raises:
        InputError: they are not.
    """
    own = motion.links.position[:, links]
    off = np.linalg.norm(position - own, axis=2).mean(axis=0)
    if off.max() > MAX_LINK_ERROR_LEGS * motion.robot.rest[2]:
        k = int(off.argmax())
        name = motion.links.names[int(links[k])]
        raise InputError(f"{path}: {name} is {100 * off[k]:.0f} cm from where its joints put it, on average: {hint}")
