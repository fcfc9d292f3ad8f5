"""The clip that ships with the project: a short dance on planted feet.

`python -m scenarios.inputs.groove FILE` writes it.

Hips, trunk, head and arms follow the beat through smooth functions of time; the legs follow from the hips by inverse
kinematics, so that the feet do not move at all. It starts and ends at rest.
"""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from sot.smooth import minimum_jerk

RATE_HZ = 50.0  # Hz
BEAT_S = 0.6  # s
BEATS = 20
ANKLE_FROM_MIDDLE_M = 0.13  # m, of each ankle from the middle
TOES_OUT_DEG = 10.0  # deg
THIGH_M, SHANK_M, ANKLE_HEIGHT_M = 0.43, 0.42, 0.09  # m
HIP_FROM_MIDDLE_M = 0.09  # m, of each hip from the middle
HIP_DROP_AT_REST_M = 0.015  # m, by which the knees are bent at rest

# Joint, parent, offset [m] in the T-pose: X left, Y up, Z forward. The left side is mirrored to the right.
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
    ("Arm", "Shoulder", (0.15, 0.0, 0.0)),
    ("ForeArm", "Arm", (0.29, 0.0, 0.0)),
    ("Hand", "ForeArm", (0.25, 0.0, 0.0)),
    ("Hand_end", "Hand", (0.17, 0.0, 0.0)),
    ("UpLeg", "Hips", (HIP_FROM_MIDDLE_M, 0.0, 0.0)),
    ("Leg", "UpLeg", (0.0, -THIGH_M, 0.0)),
    ("Foot", "Leg", (0.0, -SHANK_M, 0.0)),
    ("ToeBase", "Foot", (0.0, 0.02 - ANKLE_HEIGHT_M, 0.14)),
    ("ToeBase_end", "ToeBase", (0.0, 0.0, 0.06)),
)
_SIDES = {"Left": 1.0, "Right": -1.0}
_CHANNELS = "Yrotation Xrotation Zrotation"  # and Euler angles "YXZ"


def write_groove(path: Path) -> None:
    """Write the clip to a file."""
    path.write_text(groove_bvh(), encoding="ascii", newline="\n")


def groove_bvh() -> str:
    """The clip as the text of a .bvh file, in centimetres, Y up."""
    beat = np.arange(round(BEATS * BEAT_S * RATE_HZ) + 1) / (BEAT_S * RATE_HZ)
    hips, angles = _hip_way_and_angles(beat)
    joints = _joint_offsets()
    hierarchy = _hierarchy_lines(joints, "Hips", 0)
    names = [line.split()[1] for line in hierarchy if line.split()[0] in ("ROOT", "JOINT")]
    columns = [100.0 * hips] + [np.degrees(angles.get(name, np.zeros((len(beat), 3)))) for name in names]
    rows = [" ".join(f"{value:.3f}" for value in row) for row in np.concatenate(columns, axis=1) + 0.0]
    head = ["HIERARCHY", *hierarchy, "MOTION", f"Frames: {len(rows)}", f"Frame Time: {1 / RATE_HZ:g}"]
    return "\n".join([*head, *rows, ""])


def _joint_offsets() -> list[tuple[str, str, tuple[float, float, float]]]:
    joints = list(_SPINE)
    own = {name for name, _, _ in _LEFT}
    for side, sign in _SIDES.items():
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


def _ramp_between(beat: np.ndarray, start: float, end: float) -> np.ndarray:
    """Minimum-jerk ramp from 0 at beat `start` to 1 at beat `end`."""
    return minimum_jerk((beat - start) / (end - start))


def _on_between(beat: np.ndarray, start: float, end: float) -> np.ndarray:
    """1 between two beats and 0 outside; it rises and falls over a beat and a half around each."""
    return _ramp_between(beat, start - 0.75, start + 0.75) - _ramp_between(beat, end - 0.75, end + 0.75)


def _hip_way_and_angles(beat: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Hip positions (T, 3) [m] and joint angles, name -> (T, 3) about Y, X, Z [rad]."""
    dancing = _on_between(beat, 2.0, BEATS - 2.5)
    sway, swing, wave, twist = (
        dancing,
        _on_between(beat, 2.0, 7.0),
        _on_between(beat, 7.0, 13.0),
        _on_between(beat, 13.0, BEATS - 2.5),
    )

    def cycle(beats: float, late: float = 0.0) -> np.ndarray:
        """A sine of so many beats that lags by so many."""
        return np.sin(2.0 * np.pi * (beat - late) / beats)

    bounce = 0.5 - 0.5 * cycle(1.0, 0.25)
    hips = np.stack(
        [
            sway * 0.055 * cycle(4.0),
            ANKLE_HEIGHT_M + THIGH_M + SHANK_M - HIP_DROP_AT_REST_M - dancing * (0.045 + 0.035 * bounce),
            sway * 0.012 * cycle(2.0, 0.5),
        ],
        axis=1,
    )

    def turned(y: np.ndarray, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        return np.radians(np.stack([y, x, z], axis=1))

    torso_turn = swing * 9.0 * cycle(2.0) + wave * 5.0 * cycle(4.0, 1.0) + twist * 16.0 * cycle(4.0, 0.5)
    lean = -swing * 4.0 * cycle(4.0) - wave * 6.0 * cycle(4.0, 0.5) - twist * 3.0 * cycle(4.0)
    bow = dancing * (3.0 + 2.0 * bounce)
    angles = {
        "Hips": turned(-0.35 * torso_turn, dancing * 2.0 * bounce, sway * 3.0 * cycle(4.0)),
        **{f"Spine{i}": turned(0.45 * torso_turn, 0.4 * bow, 0.45 * lean) for i in ("", "1", "2")},
        "Neck": turned(-0.4 * torso_turn, -0.5 * bow, -0.4 * lean),
        "Head": turned(-0.5 * torso_turn, dancing * (6.0 * bounce - 4.0), -0.5 * lean),
    }
    for side, sign in _SIDES.items():
        for joint, (y, x, z) in _arm_angles(beat, sign, swing, wave, twist, cycle).items():
            angles[side + joint] = turned(sign * y, x, sign * z)
        angles.update({side + joint: angle for joint, angle in _leg_angles(hips, angles["Hips"], sign).items()})
    return hips, angles


def _arm_angles(
    beat: np.ndarray,
    sign: float,
    swing: np.ndarray,
    wave: np.ndarray,
    twist: np.ndarray,
    cycle: Callable[..., np.ndarray],
) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Angles about Y, X, Z of a left arm [deg]: Z raises it from the T-pose, -Y brings it or its forearm forward."""
    side = 0.5 - 0.5 * sign  # the right arm comes later
    still = np.zeros_like(beat)
    phase = 2.0 * side  # half a cycle of four beats, so that the arms take turns
    travel = [cycle(4.0, late if sign > 0 else 1.4 - late) for late in (0.4, 0.0, -0.4)]  # along one arm to the other
    rest = -76.0
    raised = (
        rest
        + swing * (26.0 + 10.0 * cycle(2.0, side))
        + wave * (70.0 + 22.0 * travel[0])
        + twist * (92.0 + 42.0 * cycle(4.0, 0.5 + phase))
    )
    forward = -(swing * (28.0 + 26.0 * cycle(2.0, 0.2 + side)) + wave * 12.0 + twist * (34.0 + 14.0 * cycle(2.0, side)))
    bent = -(14.0 + swing * (48.0 + 18.0 * cycle(2.0, 0.4 + side)) + wave * 8.0 + twist * (40.0 + 24.0 * cycle(2.0)))
    return {
        "Arm": (forward, still, raised),
        "ForeArm": (bent, still, wave * 26.0 * travel[1]),
        "Hand": (still, still, wave * 22.0 * travel[2]),
    }


def _leg_angles(hips: np.ndarray, pelvis: np.ndarray, sign: float) -> dict[str, np.ndarray]:
    """Joint angles (T, 3) [rad] that hold one foot flat on its spot under hips (T, 3) and pelvis angles (T, 3)."""
    base = Rotation.from_euler("YXZ", pelvis)
    foot = Rotation.from_euler("Y", sign * np.radians(TOES_OUT_DEG))
    down = np.array([sign * ANKLE_FROM_MIDDLE_M, ANKLE_HEIGHT_M, 0.0]) - (
        hips + base.apply([sign * HIP_FROM_MIDDLE_M, 0.0, 0.0])
    )
    distance = np.linalg.norm(down, axis=1)
    down /= distance[:, None]
    lateral = foot.apply([1.0, 0.0, 0.0]) - down * (down @ foot.apply([1.0, 0.0, 0.0]))[:, None]
    lateral /= np.linalg.norm(lateral, axis=1, keepdims=True)
    straight = Rotation.from_matrix(np.stack([lateral, -down, np.cross(lateral, -down)], axis=2))
    hip = np.arccos((THIGH_M**2 + distance**2 - SHANK_M**2) / (2 * THIGH_M * distance))
    knee = np.pi - np.arccos((THIGH_M**2 + SHANK_M**2 - distance**2) / (2 * THIGH_M * SHANK_M))
    thigh = straight * Rotation.from_euler("X", -hip[:, None])
    shank = thigh * Rotation.from_euler("X", knee[:, None])
    turns = {"UpLeg": base.inv() * thigh, "Leg": thigh.inv() * shank, "Foot": shank.inv() * foot}
    return {joint: turn.as_euler("YXZ") for joint, turn in turns.items()}


if __name__ == "__main__":
    write_groove(Path(sys.argv[1]))
