"""Measures of how much a robot's motion looks like a human's: angles of segments, and the path of the hands."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from sot.motion.human.human import SEGMENTS, SIDES

Array = NDArray[np.float64]
Points = Mapping[str, Array]

LEG_SEGMENTS = tuple(f"{side}_{part}" for side in SIDES for part in ("thigh", "shank"))
HAND_CUTOFF_HZ = 6.0


def segment_angles(human: Points, robot: Points) -> dict[str, Array]:
    """Angle (T,) between the same segment of two bodies [rad], both turned to one heading at each time.

    Args:
        human, robot: point -> (T, 3) positions at the same times, named as in SEGMENTS.
    """
    turn = _heading(human) - _heading(robot)
    cosine, sine = np.cos(turn), np.sin(turn)
    angles = {}
    for segment, (near, far) in SEGMENTS.items():
        a, b = _unit_direction(human, near, far), _unit_direction(robot, near, far)
        b = np.column_stack([cosine * b[:, 0] - sine * b[:, 1], sine * b[:, 0] + cosine * b[:, 1], b[:, 2]])
        angles[segment] = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1))
    return angles


def mean_segment_angle_deg(human: Points, robot: Points, upper_body_only: bool = False) -> float:
    """Mean of `segment_angles` over time and segments [deg], with `upper_body_only` without the legs."""
    angles = segment_angles(human, robot)
    return float(
        np.degrees(np.mean([angle for name, angle in angles.items() if not (upper_body_only and name in LEG_SEGMENTS)]))
    )


def hand_path_ratio(human: Points, robot: Points, rate: float) -> float:
    """Path length of the hands relative to the waist in arm lengths of their owner, robot over human.

    Both are low-passed at HAND_CUTOFF_HZ; 1 where the human's hands rest.
    """
    there = _hand_path_in_arm_lengths(human, rate)
    return _hand_path_in_arm_lengths(robot, rate) / there if there > 0.0 else 1.0


def _hand_path_in_arm_lengths(body: Points, rate: float) -> float:
    sos = butter(2, HAND_CUTOFF_HZ, fs=rate, output="sos") if 0.5 * rate > HAND_CUTOFF_HZ else None
    total = 0.0
    for side in SIDES:
        shoulder, elbow, wrist = (body[f"{side}_{joint}"] for joint in ("shoulder", "elbow", "wrist"))
        arm = np.median(np.linalg.norm(elbow - shoulder, axis=1) + np.linalg.norm(wrist - elbow, axis=1))
        hand = wrist - body["waist"]
        if sos is not None:
            hand = sosfiltfilt(sos, hand, axis=0, padlen=min(len(hand) - 1, round(rate)))
        total += float(np.linalg.norm(np.diff(hand, axis=0), axis=1).sum() / arm)
    return total


def _heading(body: Points) -> Array:
    """Yaw (T,) of the line through the hips, from right to left, less a quarter turn [rad]."""
    across = body["left_hip"] - body["right_hip"]
    return np.arctan2(-across[:, 0], across[:, 1])


def _unit_direction(body: Points, near: str, far: str) -> Array:
    along = body[far] - body[near]
    return along / np.linalg.norm(along, axis=1, keepdims=True)
