"""Reader of poses of the SMPL family (.npz), as AMASS publishes them: rotation vectors, and no skeleton.

The body model to which they belong is licensed and not needed: joints turn by the same angles on bones of our own.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.array_file import read_arrays
from sot.errors import InputError
from sot.motion.human.capture import Capture
from sot.motion.human.formats.text import RATE_RANGE_HZ

Array = NDArray[np.float64]

RATE_NAMES = ("mocap_framerate", "mocap_frame_rate")  # SMPL+H and SMPL-X
ROBOT_NAMES = ("joint_pos", "qpos", "dof_pos", "dof_positions", "dof")  # of files that hold a robot's joints
MAX_WAY_M = 1e5  # m, from the origin
MAX_TURN = 4.0 * np.pi  # rad, of a rotation vector: larger ones are degrees, or no rotations

# Joint, parent, offset [m] in the T-pose: X left, Y up, Z forward. Lengths are those of an average adult of 1.70 m by
# Drillis and Contini (1966). What is left is mirrored.
_JOINTS: tuple[tuple[str, int, tuple[float, float, float]], ...] = (
    ("Pelvis", -1, (0.0, 0.0, 0.0)),
    ("L_Hip", 0, (0.088, -0.07, 0.0)),
    ("R_Hip", 0, (-0.088, -0.07, 0.0)),
    ("Spine1", 0, (0.0, 0.11, 0.0)),
    ("L_Knee", 1, (0.0, -0.415, 0.0)),
    ("R_Knee", 2, (0.0, -0.415, 0.0)),
    ("Spine2", 3, (0.0, 0.13, 0.0)),
    ("L_Ankle", 4, (0.0, -0.415, 0.0)),
    ("R_Ankle", 5, (0.0, -0.415, 0.0)),
    ("Spine3", 6, (0.0, 0.06, 0.0)),
    ("L_Foot", 7, (0.03, -0.06, 0.13)),
    ("R_Foot", 8, (-0.03, -0.06, 0.13)),
    ("Neck", 9, (0.0, 0.21, 0.0)),
    ("L_Collar", 9, (0.07, 0.13, 0.0)),
    ("R_Collar", 9, (-0.07, 0.13, 0.0)),
    ("Head", 12, (0.0, 0.09, 0.03)),
    ("L_Shoulder", 13, (0.11, 0.03, 0.0)),
    ("R_Shoulder", 14, (-0.11, 0.03, 0.0)),
    ("L_Elbow", 16, (0.30, 0.0, 0.0)),
    ("R_Elbow", 17, (-0.30, 0.0, 0.0)),
    ("L_Wrist", 18, (0.25, 0.0, 0.0)),
    ("R_Wrist", 19, (-0.25, 0.0, 0.0)),
)
NAMES, PARENTS = tuple(name for name, _, _ in _JOINTS), tuple(parent for _, parent, _ in _JOINTS)
OFFSETS = np.array([offset for _, _, offset in _JOINTS])
_LEFT_FOOT, _RIGHT_FOOT, _HEAD = (NAMES.index(name) for name in ("L_Foot", "R_Foot", "Head"))
SIZE_RANGE = (0.75, 1.25)  # of a person, over those bones
SIZE_NOISE = 0.02  # m/s, of a standing foot: what is slower does not tell a size


def read_amass(path: str | Path) -> Capture:
    """Read poses of SMPL, SMPL+H or SMPL-X: `poses`, or `root_orient` and `pose_body`, with `trans` and a rate.

    The bones are an average adult's, in that size in which the feet that stand move least.

    Raises:
        InputError: what is missing, of a wrong shape, or not finite; or no such file.
    """
    path = Path(path)
    arrays = read_arrays(path, "AMASS poses")
    _check_human(path, arrays)
    rate = _rate(path, arrays)
    turns = _rotation_vectors(path, arrays)
    way = _numbers(path, arrays, "trans", 3)
    if len(way) != len(turns):
        raise InputError(f"{path}: 'trans' has {len(way)} frames, its poses have {len(turns)}")
    if len(turns) < 2:
        raise InputError(f"{path}: holds {len(turns)} frames; a motion needs at least two")
    if np.abs(way).max() > MAX_WAY_M:
        raise InputError(f"{path}: 'trans' leads {np.abs(way).max():.0e} m away: the file is damaged")
    if np.abs(turns).max() > MAX_TURN:
        raise InputError(f"{path}: its poses hold turns of {np.abs(turns).max():.0f} rad: are they degrees?")
    positions, rotations = _forward_kinematics(turns)
    size = _size(way, positions, rate)
    return Capture(
        name=path.stem,
        rate=rate,
        joints=NAMES,
        parents=PARENTS,
        positions=size * positions + way[:, None],
        rotations=rotations,
        zero_pose=size * _forward_kinematics(np.zeros((1, len(NAMES), 3)))[0][0],
    )


def _check_human(path: Path, arrays: dict[str, Array]) -> None:
    """Check that a file holds poses at all, and say what it holds otherwise."""
    if "poses" in arrays or "pose_body" in arrays:
        return
    if robot := [name for name in ROBOT_NAMES if name in arrays]:
        raise InputError(f"{path}: holds the joints of a robot ('{robot[0]}'), not a human's motion")
    held = ", ".join(sorted(arrays)[:20]) or "nothing"
    raise InputError(f"{path}: neither AMASS poses nor a motion of `sot retarget`; it holds {held[:300]}")


def _rate(path: Path, arrays: dict[str, Array]) -> float:
    given = [arrays[name] for name in RATE_NAMES if name in arrays]
    if not given:
        raise InputError(f"{path}: says no frame rate: add '{RATE_NAMES[0]}' [Hz]")
    value = given[0]
    if (
        value.size != 1
        or value.dtype.kind not in "iuf"
        or not RATE_RANGE_HZ[0] <= float(value.flat[0]) <= RATE_RANGE_HZ[1]
    ):
        raise InputError(
            f"{path}: its frame rate is not plausible; expected {RATE_RANGE_HZ[0]:g} to {RATE_RANGE_HZ[1]:g}"
        )
    return float(value.flat[0])


def _rotation_vectors(path: Path, arrays: dict[str, Array]) -> Array:
    """(T, J, 3) of the body's joints, root first [rad]."""
    width = 3 * len(NAMES)
    if "poses" in arrays:
        return _numbers(path, arrays, "poses", width, or_more=True)[:, :width].reshape(-1, len(NAMES), 3)
    root, body = _numbers(path, arrays, "root_orient", 3), _numbers(path, arrays, "pose_body", width - 3)
    if len(root) != len(body):
        raise InputError(f"{path}: 'root_orient' has {len(root)} frames, 'pose_body' has {len(body)}")
    return np.concatenate([root, body], axis=1).reshape(-1, len(NAMES), 3)


def _numbers(path: Path, arrays: dict[str, Array], name: str, width: int, or_more: bool = False) -> Array:
    """(T, width) finite numbers, or of more columns."""
    if name not in arrays:
        raise InputError(f"{path}: lacks '{name}': no whole AMASS file")
    values = arrays[name]
    fits = values.ndim == 2 and (values.shape[1] >= width if or_more else values.shape[1] == width)
    if not fits or values.dtype.kind not in "iuf":
        wanted = f"(frames, {width}{' or more' if or_more else ''})"
        raise InputError(f"{path}: '{name}' has shape {values.shape}, expected numbers {wanted}")
    if not np.isfinite(values).all():
        raise InputError(f"{path}: '{name}' holds something that is not a finite number")
    return values.astype(float)


def _forward_kinematics(turns: Array) -> tuple[Array, Array]:
    """Positions (T, J, 3) from the root [m] and rotations (T, J, 3, 3) of rotation vectors (T, J, 3)."""
    local = Rotation.from_rotvec(turns.reshape(-1, 3)).as_matrix().reshape(*turns.shape, 3)
    rotations, positions = local.copy(), np.zeros(turns.shape)
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            rotations[:, joint] = rotations[:, parent] @ local[:, joint]
            positions[:, joint] = positions[:, parent] + rotations[:, parent] @ OFFSETS[joint]
    return positions, rotations


def _size(way: Array, positions: Array, rate: float) -> float:
    """The size of the person over our bones, with which the lower foot stands stillest on its way (T, 3).

    A point at p from a root at w moves at ẇ + s ṗ in the size s; the least sum of squares over the feet that stand
    best gives s, led to 1 where legs hardly move.
    """
    up = np.mean(positions[:, _HEAD] - 0.5 * (positions[:, _LEFT_FOOT] + positions[:, _RIGHT_FOOT]), axis=0)
    feet = positions[:, [_LEFT_FOOT, _RIGHT_FOOT]]
    lower = np.argmin(feet @ up, axis=1)[:-1]
    moves = rate * np.diff(feet, axis=0)[np.arange(len(lower)), lower]
    root = rate * np.diff(way, axis=0)
    off = np.linalg.norm(root + moves, axis=1)
    stands = off <= np.median(off)
    noise = SIZE_NOISE**2 * np.count_nonzero(stands)
    size = (noise - np.sum((root * moves)[stands])) / (noise + np.sum((moves**2)[stands]))
    return float(np.clip(size, *SIZE_RANGE))
