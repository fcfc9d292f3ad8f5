"""What every reader of a robot's motion checks: shapes, finite numbers, quaternions, names, ranges, and who is upright.

Most of these files carry no names: an order of joints or of a quaternion's parts that is not the expected one shows
in angles that no joint can have and in robots that are upside down.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.exchange.robot_motion import Array, RobotMotion
from sot.robots.robot import Robot

MIN_FRAMES = 2
MAX_RATE_HZ = 10_000.0
QUATERNION_TOLERANCE = 0.02  # of a quaternion's length, off 1
MAX_RANGE_EXCESS_RAD = 0.5  # of a joint's angle beyond its range, median over the frames that are beyond it
MAX_BEYOND_RANGE_SHARE = 0.2  # of the frames, that may have a joint so far beyond its range
MIN_UPRIGHT_COSINE = 0.0  # of the base's axis to the vertical, median: less is upside down
HEIGHT_RANGE = (0.1, 3.0)  # of the base, median, over its height at rest


def motion_of_columns(
    path: Path,
    robot: Robot,
    rate: float,
    position: Array,
    xyzw: Array,
    angles: Array,
    joints: Sequence[str] | None = None,
) -> RobotMotion:
    """The motion in a file's columns.

    Args:
        path: The file, for errors and as the motion's name.
        robot: Whose motion it is said to be.
        rate: Frames per second [Hz].
        position: (T, 3) of the base [m].
        xyzw: (T, 4) quaternion of the base.
        angles: (T, n) of the joints [rad].
        joints: Their names (n,), where the file has any; in the robot's own order otherwise.

    Raises:
        InputError: what cannot be that robot's motion.
    """
    rate = checked_rate(path, rate)
    position, xyzw, angles = (
        numbers(path, name, values) for name, values in (("root", position), ("rotation", xyzw), ("joints", angles))
    )
    if position.ndim != 2 or xyzw.ndim != 2 or angles.ndim != 2 or position.shape[1] != 3 or xyzw.shape[1] != 4:
        shapes = f"{position.shape}, {xyzw.shape}, {angles.shape}"
        raise InputError(f"{path}: root, quaternion and joints have shapes {shapes}, expected (T, 3), (T, 4), (T, n)")
    if not len(position) == len(xyzw) == len(angles):
        raise InputError(
            f"{path}: {len(position)} root positions, {len(xyzw)} rotations and {len(angles)} rows of joints: expected"
            " as many of each"
        )
    if len(position) < MIN_FRAMES:
        raise InputError(f"{path}: {len(position)} frames are no motion: needs {MIN_FRAMES} or more")
    angles = _in_robot_order(path, robot, angles, joints)
    length = np.linalg.norm(xyzw, axis=1)
    if (np.abs(length - 1.0) > QUATERNION_TOLERANCE).any():
        frame = int(np.abs(length - 1.0).argmax())
        raise InputError(f"{path}: the root's quaternion in frame {frame} has length {length[frame]:.3g}, expected 1")
    q = np.hstack([position, _continuous(xyzw / length[:, None]), angles])
    _check_posture(path, robot, q)
    return RobotMotion.of_configurations(robot, path.stem, rate, q)


def checked_rate(path: Path, rate: object) -> float:
    """The frame rate [Hz] that a file gives as a number, or as an array of one.

    Raises:
        InputError: it is none.
    """
    try:
        values = np.asarray(rate, dtype=float).ravel()
    except (TypeError, ValueError):
        values = np.array([])
    if values.size != 1 or not 0.0 < values[0] <= MAX_RATE_HZ:
        raise InputError(f"{path}: its frame rate is no number between 0 and {MAX_RATE_HZ:g} Hz")
    return float(values[0])


def given_rate(path: Path, rate: float | None) -> float:
    """The frame rate of a file that holds none [Hz]: whoever knows the file has to tell.

    Raises:
        InputError: nobody did.
    """
    if rate is None:
        raise InputError(f"{path}: the file does not say its frame rate: name it with --fps")
    return checked_rate(path, rate)


def numbers(path: Path, name: str, values: object) -> Array:
    """An array of a file as finite numbers.

    Raises:
        InputError: it is none.
    """
    try:
        found = np.asarray(values)
        if found.dtype.kind not in "fiub":
            raise TypeError
        found = found.astype(float)
    except (TypeError, ValueError):
        raise InputError(f"{path}: '{name}' holds something that is not a number") from None
    if not np.isfinite(found).all():
        raise InputError(f"{path}: '{name}' holds something that is not a finite number")
    return found


def _in_robot_order(path: Path, robot: Robot, angles: Array, joints: Sequence[str] | None) -> Array:
    if joints is None:
        if angles.shape[1] != robot.na:
            raise InputError(f"{path}: {angles.shape[1]} joints, but {robot.label} has {robot.na}: another robot's?")
        return angles
    names = [str(name) for name in joints]
    if len(names) != angles.shape[1]:
        raise InputError(f"{path}: {len(names)} names for {angles.shape[1]} joints")
    if missing := [name for name in robot.joints if name not in names]:
        raise InputError(f"{path}: lacks {', '.join(missing[:5])} of {robot.label}: another robot's?")
    if len(set(names)) < len(names):
        raise InputError(f"{path}: a joint is named twice")
    return angles[:, [names.index(name) for name in robot.joints]]


def _continuous(xyzw: Array) -> Array:
    """Quaternions (T, 4) of the same rotations without changes of sign from one frame to the next."""
    flips = np.sum(xyzw[1:] * xyzw[:-1], axis=1) < 0.0
    signs = np.concatenate([[1.0], np.cumprod(np.where(flips, -1.0, 1.0))])
    return signs[:, None] * xyzw


def _check_posture(path: Path, robot: Robot, q: Array) -> None:
    """Refuse what no robot does and a wrong order or unit makes."""
    beyond = np.maximum(q[:, 7:] - robot.upper, robot.lower - q[:, 7:]) > MAX_RANGE_EXCESS_RAD
    share = beyond.mean(axis=0)
    if share.max(initial=0.0) > MAX_BEYOND_RANGE_SHARE:
        k = int(share.argmax())
        raise InputError(
            f"{path}: {robot.joints[k]} is beyond its range by more than {np.degrees(MAX_RANGE_EXCESS_RAD):.0f} deg in"
            f" {100 * share[k]:.0f} % of the frames: joints in another order, in degrees, or of another robot?"
        )
    up = Rotation.from_quat(q[:, 3:7]).as_matrix()[:, 2, 2]
    if np.median(up) < MIN_UPRIGHT_COSINE:
        raise InputError(
            f"{path}: {robot.label} is upside down most of the time: is the quaternion's order another (wxyz, xyzw)?"
        )
    height = float(np.median(q[:, 2])) / float(robot.rest[2])
    if not HEIGHT_RANGE[0] <= height <= HEIGHT_RANGE[1]:
        raise InputError(
            f"{path}: its root is {np.median(q[:, 2]):.3g} m high, that of {robot.label} stands at"
            f" {robot.rest[2]:.2f} m: another unit, or another robot?"
        )
