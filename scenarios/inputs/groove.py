"""The clip that ships with the project: a short dance on planted feet.

`python -m scenarios.inputs.groove FILE` writes it.

Hips, trunk, head and arms follow the beat through smooth functions of time; the legs follow from the hips by inverse
kinematics, so that the feet do not move at all. It starts and ends at rest.
"""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from scenarios.inputs.synthetic_human import (
    ANKLE_FROM_MIDDLE_M,
    ANKLE_HEIGHT_M,
    SHANK_M,
    SIDES,
    THIGH_M,
    bvh_text,
    leg_angles,
)
from sot.smooth import minimum_jerk

RATE_HZ = 50.0  # Hz
BEAT_S = 0.6  # s
BEATS = 20
HIP_DROP_AT_REST_M = 0.015  # m, by which the knees are bent at rest


def write_groove(path: Path) -> None:
    """Write the clip to a file."""
    path.write_text(groove_bvh(), encoding="ascii", newline="\n")


def groove_bvh() -> str:
    """The clip as the text of a .bvh file, in centimetres, Y up."""
    beat = np.arange(round(BEATS * BEAT_S * RATE_HZ) + 1) / (BEAT_S * RATE_HZ)
    hips, angles = _hip_way_and_angles(beat)
    return bvh_text(hips, angles, RATE_HZ)


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
    for side, sign in SIDES.items():
        for joint, (y, x, z) in _arm_angles(beat, sign, swing, wave, twist, cycle).items():
            angles[side + joint] = turned(sign * y, x, sign * z)
        ankle = np.array([sign * ANKLE_FROM_MIDDLE_M, ANKLE_HEIGHT_M, 0.0])
        angles.update({side + joint: angle for joint, angle in leg_angles(hips, angles["Hips"], sign, ankle).items()})
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


if __name__ == "__main__":
    write_groove(Path(sys.argv[1]))
