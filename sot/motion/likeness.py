"""Measures of how much a robot's motion looks like a human's: angles of segments, heading, the path of the hands."""

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from sot.motion.human.human import SEGMENTS, SIDES

Array = NDArray[np.float64]
Points = Mapping[str, Array]

LEG_SEGMENTS = tuple(f"{side}_{part}" for side in SIDES for part in ("thigh", "shank"))
UPPER_SEGMENTS = tuple(name for name in SEGMENTS if name not in LEG_SEGMENTS)
HAND_CUTOFF_HZ = 6.0
MIN_HAND_PATH_ARMS = 1.0  # arm lengths that a human's hands have to go, both together, for a ratio to mean something


def segment_angles(human: Points, robot: Points) -> dict[str, Array]:
    """Angle (T,) between the same segment of two bodies [rad], both turned to one heading at each time.

    Args:
        human, robot: point -> (T, 3) positions at the same times, named as in SEGMENTS.
    """
    turn = hip_heading(human) - hip_heading(robot)
    cosine, sine = np.cos(turn), np.sin(turn)
    angles = {}
    for segment, (near, far) in SEGMENTS.items():
        a, b = _unit_direction(human, near, far), _unit_direction(robot, near, far)
        b = np.column_stack([cosine * b[:, 0] - sine * b[:, 1], sine * b[:, 0] + cosine * b[:, 1], b[:, 2]])
        angles[segment] = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1))
    return angles


def mean_segment_angle_deg(human: Points, robot: Points, segments: Collection[str] = tuple(SEGMENTS)) -> float:
    """Mean of `segment_angles` over time and some of the segments, by default all [deg]."""
    angles = segment_angles(human, robot)
    return float(np.degrees(np.mean([angles[name] for name in segments])))


def heading_difference_deg(human: Array, robot: Array) -> float:
    """Root mean square difference of two bodies' headings (T,) [rad] over time, a constant one left out [deg]."""
    off = np.exp(1j * (robot - human))
    return float(np.degrees(np.sqrt(np.mean(np.angle(off * np.conj(off.mean())) ** 2))))


def hip_heading(body: Points) -> Array:
    """Yaw (T,) of the line through the hips, from right to left, less a quarter turn [rad]."""
    across = body["left_hip"] - body["right_hip"]
    return np.arctan2(-across[:, 0], across[:, 1])


def hand_path_ratio(human: Points, robot: Points, rate: float) -> float | None:
    """Path length of the hands relative to the waist in arm lengths of their owner, robot over human.

    Both are low-passed at HAND_CUTOFF_HZ; None where the human's hands go less than MIN_HAND_PATH_ARMS.
    """
    there = _hand_path_in_arm_lengths(human, rate)
    return _hand_path_in_arm_lengths(robot, rate) / there if there >= MIN_HAND_PATH_ARMS else None


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


def _unit_direction(body: Points, near: str, far: str) -> Array:
    along = body[far] - body[near]
    return along / np.linalg.norm(along, axis=1, keepdims=True)
