"""A human of our own, joint by joint, for clips that are made and not recorded: its skeleton, its limbs, its file.

Axes of the file: X left, Y up, Z forward.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

THIGH_M, SHANK_M, ANKLE_HEIGHT_M = 0.43, 0.42, 0.09  # m
HIP_FROM_MIDDLE_M = 0.09  # m, of each hip from the middle
ANKLE_FROM_MIDDLE_M = 0.13  # m, of each ankle from the middle
TOES_OUT_DEG = 10.0  # deg
UPPER_ARM_M, FOREARM_M, PALM_FROM_WRIST_M = 0.29, 0.25, 0.08  # m
SHOULDER_FROM_MIDDLE_M = 0.18  # m
SIDES = {"Left": 1.0, "Right": -1.0}

# Joint, parent, offset [m] in the T-pose. The left side is mirrored to the right.
_SPINE = (
    ("Hips", "", (0.0, 0.0, 0.0)),
    ("Spine", "Hips", (0.0, 0.10, 0.0)),
    ("Spine1", "Spine", (0.0, 0.12, 0.0)),
    ("Spine2", "Spine1", (0.0, 0.12, 0.0)),
    ("Neck", "Spine2", (0.0, 0.22, 0.0)),
    ("Head", "Neck", (0.0, 0.10, 0.015)),
    ("Head_end", "Head", (0.0, 0.17, 0.0)),
)
_LEFT = (
    ("Shoulder", "Spine2", (0.03, 0.16, 0.0)),
    ("Arm", "Shoulder", (SHOULDER_FROM_MIDDLE_M - 0.03, 0.0, 0.0)),
    ("ForeArm", "Arm", (UPPER_ARM_M, 0.0, 0.0)),
    ("Hand", "ForeArm", (FOREARM_M, 0.0, 0.0)),
    ("Hand_end", "Hand", (0.17, 0.0, 0.0)),
    ("UpLeg", "Hips", (HIP_FROM_MIDDLE_M, 0.0, 0.0)),
    ("Leg", "UpLeg", (0.0, -THIGH_M, 0.0)),
    ("Foot", "Leg", (0.0, -SHANK_M, 0.0)),
    ("ToeBase", "Foot", (0.0, 0.02 - ANKLE_HEIGHT_M, 0.14)),
    ("ToeBase_end", "ToeBase", (0.0, 0.0, 0.06)),
)
_CHANNELS = "Yrotation Xrotation Zrotation"  # and Euler angles "YXZ"


def bvh_text(hips: Array, angles: Mapping[str, Array], rate: float) -> str:
    """A clip as the text of a .bvh file, in centimetres, Y up.

    Args:
        hips: Positions (T, 3) [m].
        angles: Joint -> angles (T, 3) about Y, X, Z [rad]; a joint left out does not turn.
        rate: Frames per second [Hz].
    """
    hierarchy = _hierarchy_lines(_joint_offsets(), "Hips", 0)
    names = [line.split()[1] for line in hierarchy if line.split()[0] in ("ROOT", "JOINT")]
    columns = [100.0 * hips] + [np.degrees(angles.get(name, np.zeros((len(hips), 3)))) for name in names]
    rows = [" ".join(f"{value:.3f}" for value in row) for row in np.concatenate(columns, axis=1) + 0.0]
    head = ["HIERARCHY", *hierarchy, "MOTION", f"Frames: {len(rows)}", f"Frame Time: {1 / rate:g}"]
    return "\n".join([*head, *rows, ""])


def leg_angles(
    hips: Array,
    pelvis: Array,
    sign: float,
    ankle: Array,
    foot_pitch: Array | float = 0.0,
    foot_heading: Array | float = 0.0,
) -> dict[str, Array]:
    """Joint angles (T, 3) [rad] of one leg whose ankle is at a place.

    Args:
        hips: Positions (T, 3) [m].
        pelvis: Angles of the hips (T, 3) about Y, X, Z [rad].
        sign: 1 for the left leg, -1 for the right one.
        ankle: Its place (3,) or (T, 3) [m].
        foot_pitch: How far the toes point down [rad], (T,).
        foot_heading: About Y, from which the toes point out [rad], (T,).
    """
    base = Rotation.from_euler("YXZ", pelvis)
    toes_out = np.broadcast_to(foot_heading, len(hips)) + sign * np.radians(TOES_OUT_DEG)
    foot = Rotation.from_euler("YX", np.column_stack([toes_out, np.broadcast_to(foot_pitch, len(hips))]))
    heading = Rotation.from_euler("Y", toes_out[:, None])
    down = ankle - (hips + base.apply([sign * HIP_FROM_MIDDLE_M, 0.0, 0.0]))
    distance = np.linalg.norm(down, axis=1)
    down = down / distance[:, None]
    across = heading.apply([1.0, 0.0, 0.0])
    lateral = across - down * (down[:, None] @ across[:, :, None])[:, 0]
    lateral /= np.linalg.norm(lateral, axis=1, keepdims=True)
    straight = Rotation.from_matrix(np.stack([lateral, -down, np.cross(lateral, -down)], axis=2))
    hip = np.arccos((THIGH_M**2 + distance**2 - SHANK_M**2) / (2 * THIGH_M * distance))
    knee = np.pi - np.arccos((THIGH_M**2 + SHANK_M**2 - distance**2) / (2 * THIGH_M * SHANK_M))
    thigh = straight * Rotation.from_euler("X", -hip[:, None])
    shank = thigh * Rotation.from_euler("X", knee[:, None])
    turns = {"UpLeg": base.inv() * thigh, "Leg": thigh.inv() * shank, "Foot": shank.inv() * foot}
    return {joint: turn.as_euler("YXZ") for joint, turn in turns.items()}


def arm_angles(hips: Array, torso: Mapping[str, Array], sign: float, palm: Array, elbow_way: Array) -> dict[str, Array]:
    """Joint angles (T, 3) [rad] of one arm whose palm is at a place, the hand in line with the forearm.

    Args:
        hips: Positions (T, 3) [m].
        torso: Angles (T, 3) about Y, X, Z of the hips and the three joints of the spine [rad].
        sign: 1 for the left arm, -1 for the right one.
        palm: Places (T, 3) [m]; where the arm is too short, it points there.
        elbow_way: Direction (3,) to which the elbow points.
    """
    chest, place = Rotation.identity(len(hips)), hips
    offsets = {name: np.array(offset) for name, _, offset in _SPINE}
    for joint in ("Hips", "Spine", "Spine1", "Spine2"):
        place = place + chest.apply(offsets[joint])
        chest = chest * Rotation.from_euler("YXZ", torso[joint])
    shoulder = place + chest.apply([sign * SHOULDER_FROM_MIDDLE_M, 0.16, 0.0])
    lower = FOREARM_M + PALM_FROM_WRIST_M
    reach = palm - shoulder
    distance = np.linalg.norm(reach, axis=1)
    along = reach / distance[:, None]
    distance = np.clip(distance, abs(UPPER_ARM_M - lower) + 1e-3, UPPER_ARM_M + lower - 1e-3)
    aside = elbow_way - along * (along @ elbow_way)[:, None]
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    cosine = (UPPER_ARM_M**2 + distance**2 - lower**2) / (2 * UPPER_ARM_M * distance)
    elbow = UPPER_ARM_M * (cosine[:, None] * along + np.sqrt(1.0 - cosine**2)[:, None] * aside)
    upper, fore = elbow / UPPER_ARM_M, (distance[:, None] * along - elbow) / lower
    axis = np.cross(upper, fore)
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)

    def turn(direction: Array) -> Rotation:
        x = sign * direction
        return Rotation.from_matrix(np.stack([x, np.cross(axis, x), axis], axis=2))

    angles = {"Arm": chest.inv() * turn(upper), "ForeArm": turn(upper).inv() * turn(fore)}
    return {joint: rotation.as_euler("YXZ") for joint, rotation in angles.items()}


def _joint_offsets() -> list[tuple[str, str, tuple[float, float, float]]]:
    joints = list(_SPINE)
    own = {name for name, _, _ in _LEFT}
    for side, sign in SIDES.items():
        for name, parent, (x, y, z) in _LEFT:
            joints.append((side + name, side + parent if parent in own else parent, (sign * x, y, z)))
    return joints


def _hierarchy_lines(joints: list[tuple[str, str, tuple[float, float, float]]], name: str, depth: int) -> list[str]:
    """The lines of a joint and all below it."""
    offset = next(o for n, _, o in joints if n == name)
    children = [n for n, parent, _ in joints if parent == name]
    pad = "  " * depth
    title = "End Site" if not children else f"{'JOINT' if depth else 'ROOT'} {name}"
    lines = [f"{pad}{title}", f"{pad}{{", f"{pad}  OFFSET " + " ".join(f"{100 * x:.2f}" for x in offset)]
    if children:
        channels = f"3 {_CHANNELS}" if depth else f"6 Xposition Yposition Zposition {_CHANNELS}"
        lines.append(f"{pad}  CHANNELS {channels}")
    for child in children:
        lines += _hierarchy_lines(joints, child, depth + 1)
    return [*lines, f"{pad}}}"]
