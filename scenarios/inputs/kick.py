"""A clip of ours on one leg at a time: a kick to the height of the hips, then a foot held at the height of a knee.

`python -m scenarios.inputs.kick FILE` writes it.

The weight shifts over the left foot, the right leg is raised bent, stretched forward at the height of the hips, and put
down; then over the right foot, while the left one is held beside its knee. It starts and ends at rest.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.inputs.synthetic_human import (
    ANKLE_FROM_MIDDLE_M,
    ANKLE_HEIGHT_M,
    HIP_FROM_MIDDLE_M,
    SHANK_M,
    SIDES,
    THIGH_M,
    bvh_text,
    leg_angles,
)
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

RATE_HZ, DURATION_S = 50.0, 14.0
HIP_DROP_M = 0.03  # m, by which the knees are bent at rest
WEIGHT_SHIFT_M = 0.11  # m, of the hips over the foot that stands
KICK_UP_S, KICK_DOWN_S, KICK_HELD_S = 1.3, 1.3, 0.3
KICK_START_S, HOLD_START_S = 1.8, 6.8
HOLD_UP_S, HELD_S = 1.0, 3.0
SHIFT_S = 1.2  # s, before a foot leaves the floor
KICKING_LEG_M, FOLDED_LEG_M = 0.83, 0.66  # m, from hip to ankle: at the height of the kick, and on the way there
LEAN_BACK_DEG = 14.0  # deg, of the trunk in the kick
HELD_KNEE_FORWARD_M = 0.20  # m, by which the held foot is ahead of its hip


def write_kick(path: Path) -> None:
    """Write the clip to a file."""
    path.write_text(kick_bvh(), encoding="ascii", newline="\n")


def kick_bvh() -> str:
    """The clip as the text of a .bvh file, in centimetres, Y up."""
    t = np.arange(round(DURATION_S * RATE_HZ) + 1) / RATE_HZ
    kick = _there_and_back(t, KICK_START_S, KICK_UP_S, KICK_HELD_S, KICK_DOWN_S)
    hold = _there_and_back(t, HOLD_START_S, HOLD_UP_S, HELD_S, HOLD_UP_S)
    kick_end = KICK_START_S + KICK_UP_S + KICK_HELD_S + KICK_DOWN_S
    hold_end = HOLD_START_S + 2.0 * HOLD_UP_S + HELD_S
    left, right = (
        _there_and_back(t, start - SHIFT_S, SHIFT_S, end - start, SHIFT_S)
        for start, end in ((KICK_START_S, kick_end), (HOLD_START_S, hold_end))
    )
    hips = np.zeros((len(t), 3))
    hips[:, 0] = WEIGHT_SHIFT_M * (left - right)
    hips[:, 1] = ANKLE_HEIGHT_M + THIGH_M + SHANK_M - HIP_DROP_M
    pelvis = np.zeros((len(t), 3))
    pelvis[:, 1] = -np.radians(0.3 * LEAN_BACK_DEG) * kick
    angles = {"Hips": pelvis}
    for spine in ("Spine", "Spine1", "Spine2"):
        angles[spine] = np.radians(-0.23 * LEAN_BACK_DEG) * np.column_stack([0.0 * t, kick, 0.0 * t])
    for side, sign in SIDES.items():
        stand = np.array([sign * ANKLE_FROM_MIDDLE_M, ANKLE_HEIGHT_M, 0.0])
        ankle = np.tile(stand, (len(t), 1))
        pitch = np.zeros(len(t))
        if side == "Right":
            ankle += _kicking_ankle(hips, stand, kick)
            pitch = -np.radians(50.0) * kick
        else:
            ankle += hold[:, None] * (np.array([sign * HIP_FROM_MIDDLE_M, SHANK_M, HELD_KNEE_FORWARD_M]) - stand)
            ankle[:, 0] += hold * hips[:, 0]
            ankle[:, 1] += hold * ANKLE_HEIGHT_M
            pitch = np.radians(15.0) * hold
        angles |= {side + joint: angle for joint, angle in leg_angles(hips, pelvis, sign, ankle, pitch).items()}
        out = 14.0 * np.maximum(kick, hold)
        angles[side + "Arm"] = np.radians(np.column_stack([0.0 * t - sign * 8.0, 0.0 * t, sign * (out - 72.0)]))
        angles[side + "ForeArm"] = np.radians(np.column_stack([0.0 * t - sign * 20.0, 0.0 * t, 0.0 * t]))
    return bvh_text(hips, angles, RATE_HZ)


def _there_and_back(t: Array, start: float, up: float, held: float, down: float) -> Array:
    """0, from `start` on to 1 within `up`, held there, and back within `down` [s]."""
    return minimum_jerk((t - start) / up) - minimum_jerk((t - start - up - held) / down)


def _kicking_ankle(hips: Array, stand: Array, kick: Array) -> Array:
    """The way (T, 3) of an ankle from where it stands, to the height of the hip in front of it: folded half-way [m]."""
    hip = hips - [HIP_FROM_MIDDLE_M, 0.0, 0.0]
    down = stand - hip
    length = np.linalg.norm(down, axis=1)
    folded = 4.0 * kick * (1.0 - kick)
    reach = (1.0 - kick) * length + kick * KICKING_LEG_M
    reach -= folded * (0.5 * (length + KICKING_LEG_M) - FOLDED_LEG_M)
    raised = 0.5 * np.pi * kick
    forward = np.column_stack([0.0 * raised, -np.cos(raised), np.sin(raised)])
    aside = down * [1.0, 0.0, 0.0] * (1.0 - kick)[:, None]
    return hip + aside + np.sqrt(reach**2 - aside[:, 0] ** 2)[:, None] * forward - stand


if __name__ == "__main__":
    write_kick(Path(sys.argv[1]))
