"""The robot at rest: its angles, which way it looks, and the axes of its points."""

from collections.abc import Mapping, Sequence
from math import atan2, degrees, pi

import numpy as np
import pinocchio as pin

from sot.robots.reading.mjcf import KeyFrame
from sot.robots.robot_file import FEET, SIDED, RobotFile
from sot.toml_file import nearest

Array = np.ndarray

UPRIGHT_POINTS = ("waist", "chest", "neck", "head", "head_top", *FEET, "left_toe", "right_toe")
"""Points whose axes are the world's at rest; the others' are those of their frames in the model."""
RANGE_TOLERANCE = 1e-3
"""Angle [rad] by which the rest may be outside a range: it is moved into it."""
HEADING_TOLERANCE = 0.2
"""Angle [rad] by which the robot's left side may be off a multiple of a quarter turn."""
UPRIGHTNESS = 0.7
"""Least cosine of the angle between the vertical and the line from the feet to the head."""


def rest_angles(
    file: RobotFile, key_frames: Mapping[str, KeyFrame], names: Sequence[str], lower: Array, upper: Array
) -> tuple[Array, Array]:
    """Rotation of the base (3, 3) and angles (na,) [rad] at rest: a key frame of the model, or a table of angles.

    Args:
        file: of the robot.
        key_frames: of the model.
        names: of the joints.
        lower, upper: their ranges (na,) [rad].

    Raises:
        InputError: there is no such key frame or joint, or an angle is outside its range.
    """
    rest = file.get("rest", str, dict)
    rotation, angles = np.eye(3), dict.fromkeys(names, 0.0)
    if isinstance(rest, str):
        if rest not in key_frames:
            raise file.error(
                f"'rest' names the key frame '{rest}', which the model does not have{nearest(rest, key_frames)}"
            )
        rotation, given = key_frames[rest]
        angles |= {name: given[name] for name in names}
    else:
        angles |= file.by_joint("rest", names, rest)
    q = np.array([angles[name] for name in names])
    beyond = np.maximum(q - upper, lower - q)
    outside = [
        f"'{name}' at {angle:.3g} of {low:.3g} to {high:.3g} rad"
        for name, angle, low, high, far in zip(names, q, lower, upper, beyond, strict=True)
        if not far <= RANGE_TOLERANCE
    ]
    if outside:
        raise file.error(f"'rest' has joints outside their ranges: {', '.join(outside)}")
    return rotation, np.clip(q, lower, upper)


def standing_rotation(file: RobotFile, rotation: Array, positions: Mapping[str, Array], remarks: list[str]) -> Array:
    """Rotation of the base (3, 3) at rest in which the robot stands upright and looks along +X.

    A robot that looks elsewhere is turned about the vertical by quarter turns.

    Args:
        file: of the robot.
        rotation: of the base at rest, as the model has it.
        positions: of the points at rest, in the base (3,) [m].
        remarks: a turn is added to these.

    Raises:
        InputError: it does not stand, looks at no side, or its left is on its right.
    """
    at = {name: rotation @ position for name, position in positions.items()}
    height = at["head"] - 0.5 * (at["left_foot"] + at["right_foot"])
    if not height[2] > UPRIGHTNESS * np.linalg.norm(height):
        raise file.error("the robot does not stand at rest: the head is not above the feet; turn the base in the model")
    left = sum((at[f"left_{point}"] - at[f"right_{point}"] for point in SIDED), np.zeros(3))
    yaw = atan2(-left[0], left[1])  # of the left side, from +Y
    quarters = round(yaw / (pi / 2))
    if abs(yaw - quarters * pi / 2) > HEADING_TOLERANCE:
        raise file.error(
            f"the robot's left side looks {degrees(yaw):.0f}° away from +Y at rest: turn its base in the model, or is "
            "a point on the wrong side?"
        )
    turn = pin.utils.rotate("z", -quarters * pi / 2) if quarters else np.eye(3)
    ahead = sum(
        (turn @ (at[f"{s}_toe"] - at[f"{s}_ankle"]) for s in ("left", "right") if f"{s}_toe" in at), np.zeros(3)
    )
    if ahead[0] < 0.0:
        raise file.error("the toes look backwards where the left side is at +Y: are left and right swapped?")
    if quarters:
        remarks.append(
            f"the robot's left side is {abs(degrees(yaw)):.0f}° from +Y in its model: it is turned to look along +X"
        )
    return np.rint(turn) @ rotation
