"""How good a robot's motion is by the figures that others publish of theirs: LIMMT's score, slides, penetration, jerk.

They need a motion's configurations only, so that a file that came in and what was danced are measured alike.
"""

from itertools import pairwise

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.motion.human.human import SIDES
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Figures = dict[str, float | None]

RATE_HZ = 50.0  # at which a motion is looked at; a slower one at its own
FOOT_HEIGHT_M, SLIDING_SPEED = 0.05, 0.1  # a lower foot that is faster along the floor slides [m, m/s]
PENETRATION_M = 0.01  # that counts
AIRBORNE_TIME_S = 1.0  # longer without a foot near the floor, that counts
AIRBORNE_HEIGHT_M = 0.05  # of both feet
WEIGHTS = {
    "foot_sliding": 1.70,
    "joint_speed": 44.22,
    "self_collision": 0.17,
    "penetration": 216.62,
    "airborne": 24.19,
}
"""Points of 100 that LIMMT's filter takes off for a flaw in all frames; 0.28 for jerk, whose bound is not published."""
KEYS = (
    *("limmt_score", "foot_sliding", "joint_speed", "self_collision", "penetration", "airborne"),
    *("foot_speed_m_s", "penetration_max_m", "self_penetration_max_m", "jerk_rad_s3"),
)
LIMB_POINTS = ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")
KEY_BODIES = ("waist", "chest", *(f"{side}_{point}" for side in SIDES for point in LIMB_POINTS))
"""The fourteen bodies that mjlab's trackers follow, by the points of this project that are on them."""


def motion_quality(robot: Robot, q: Array, rate: float) -> Figures:
    """Figures of a motion; shares are of its frames.

    Args:
        robot: Who moves.
        q: (T, nq) configurations.
        rate: Of them, per second [Hz].

    Returns:
        "limmt_score", of 100; the shares that it is made of: "foot_sliding", "joint_speed" (beyond a limit),
        "self_collision", "penetration" (of the floor, by more than 1 cm), "airborne" (for longer than 1 s);
        "foot_speed_m_s", mean speed along the floor of feet lower than 5 cm; "penetration_max_m",
        "self_penetration_max_m", greatest depths; "jerk_rad_s3", mean absolute third derivative of joint angles.
    """
    step = max(1, round(rate / RATE_HZ))
    q, rate = q[::step], rate / step
    if len(q) < 4:
        return dict.fromkeys(KEYS)
    feet, lowest, depth = _feet_and_depths(robot, q)
    speed = np.linalg.norm(np.diff(feet[:, :, :2], axis=0), axis=2) * rate
    low = feet[:-1, :, 2] < FOOT_HEIGHT_M
    joints = np.abs(np.diff(q[:, 7:], axis=0)) * rate
    sunk = np.maximum(-lowest, 0.0)
    shares = {
        "foot_sliding": _share((low & (speed > SLIDING_SPEED)).any(axis=1)),
        "joint_speed": _share((joints > robot.velocity).any(axis=1)),
        "self_collision": _share(depth > 0.0),
        "penetration": _share(sunk > PENETRATION_M),
        "airborne": _share(_lasting(feet[:, :, 2].min(axis=1) > AIRBORNE_HEIGHT_M, AIRBORNE_TIME_S * rate)),
    }
    jerk = np.diff(q[:, 7:], n=3, axis=0) * rate**3
    return {
        "limmt_score": max(0.0, 100.0 - sum(WEIGHTS[name] * share for name, share in shares.items())),
        **shares,
        "foot_speed_m_s": float(speed[low].mean()) if low.any() else None,
        "penetration_max_m": float(sunk.max()),
        "self_penetration_max_m": float(max(0.0, depth.max())),
        "jerk_rad_s3": float(np.abs(jerk).mean()),
    }


def key_body_errors(robot: Robot, wanted: Array, done: Array) -> tuple[float, float]:
    """mjlab's MPKPE and R-MPKPE [m]: mean distance of the key bodies from their reference over frames and bodies, in
    the world, and with the reference moved along the floor and turned to where the robot's chest is and faces.

    Args:
        robot: Who moves.
        wanted, done: (T, nq) configurations of the reference and of the robot at the same times.
    """
    (ours, our_chest), (theirs, their_chest) = (_key_bodies(robot, q) for q in (done, wanted))
    chest = KEY_BODIES.index("chest")
    turn = our_chest @ their_chest.swapaxes(1, 2)
    yaw = Rotation.from_rotvec(
        np.column_stack([np.zeros((len(turn), 2)), np.arctan2(turn[:, 1, 0], turn[:, 0, 0])])
    ).as_matrix()
    anchor = ours[:, chest].copy()
    anchor[:, 2] = theirs[:, chest, 2]
    moved = anchor[:, None] + np.einsum("tij,tbj->tbi", yaw, theirs - theirs[:, chest : chest + 1])
    return float(np.linalg.norm(theirs - ours, axis=2).mean()), float(np.linalg.norm(moved - ours, axis=2).mean())


def _feet_and_depths(robot: Robot, q: Array) -> tuple[Array, Array, Array]:
    """Positions (T, 2, 3) of the middles of the soles, height (T,) of the lowest corner of the soles, and how deep (T,)
    the robot's shapes that may collide are in one another, negative where they are apart [m]."""
    data, results = robot.model.createData(), robot.shapes.createData()
    frames = [robot.point(foot) for foot in robot.feet]
    feet, lowest, depth = np.empty((len(q), len(frames), 3)), np.empty(len(q)), np.empty(len(q))
    for k, configuration in enumerate(q):
        pin.framesForwardKinematics(robot.model, data, configuration)
        corners = [
            robot.sole(foot) @ data.oMf[frame].rotation.T + data.oMf[frame].translation
            for foot, frame in zip(robot.feet, frames, strict=True)
        ]
        feet[k] = [corner.mean(axis=0) for corner in corners]
        lowest[k] = min(corner[:, 2].min() for corner in corners)
        pin.computeDistances(robot.model, data, robot.shapes, results, configuration)
        depth[k] = max((-found.min_distance for found in results.distanceResults), default=-np.inf)
    return feet, lowest, depth


def _key_bodies(robot: Robot, q: Array) -> tuple[Array, Array]:
    """Positions (T, B, 3) of the key bodies, and rotations (T, 3, 3) of the chest."""
    data, frames = robot.model.createData(), [robot.point(name) for name in KEY_BODIES]
    places, chest = np.empty((len(q), len(frames), 3)), np.empty((len(q), 3, 3))
    for k, configuration in enumerate(q):
        pin.framesForwardKinematics(robot.model, data, configuration)
        places[k] = [data.oMf[frame].translation for frame in frames]
        chest[k] = data.oMf[robot.point("chest")].rotation
    return places, chest


def _lasting(flags: Flags, shortest: float) -> Flags:
    """The frames in runs of True that are longer than a number of frames."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    kept = np.zeros_like(flags)
    for first, last in pairwise(edges.tolist()):
        if flags[first] and last - first > shortest:
            kept[first:last] = True
    return kept


def _share(flags: Flags | np.bool_) -> float:
    return float(np.mean(flags))
