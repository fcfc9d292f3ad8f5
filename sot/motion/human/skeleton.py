"""Who is who in a capture: any skeleton's joints under canonical names, and where its bodies face."""

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import numpy as np

from sot.errors import InputError
from sot.motion.human.capture import Capture
from sot.motion.human.human import SEGMENTS, SIDES, Human, nearest_rotations
from sot.motion.human.mending import on_level_floor, without_jumps
from sot.motion.human.plausibility import check_plausible
from sot.motion.human.postures import standing
from sot.toml_file import read_toml

LIMB_JOINTS = {"leg": ("hip", "knee", "ankle"), "arm": ("shoulder", "elbow", "wrist")}
JOINT_ABOVE_TIP = {"wrist": "elbow", "toe": "ankle"}  # an unnamed tip is the farthest joint below this one
CANONICAL_JOINTS = (
    "head",
    *(f"{s}_{j}" for s in SIDES for limb in LIMB_JOINTS.values() for j in limb),
    *(f"{s}_toe" for s in SIDES),
)
HEAD_HEIGHT_RANGE_M = (0.08, 0.30)  # from a human's head joint to the top of the head
AVERAGE_HEAD_HEIGHT_PER_LEG = 0.2  # over the leg's length
MIN_RECLINED_TILT = np.radians(60.0)  # tilt of a trunk from which on a head's direction to look is not level
AXIS_SNAP_COSINE = np.cos(np.radians(30.0))  # a head's lateral axis within 30° of one of the joint's axes is that axis

JointAliases = Mapping[str, list[str]]


def recognise(capture: Capture, mapping: str | Path | Mapping[str, str] | None = None) -> Human:
    """Name a capture's joints, calibrate its pelvis, chest and head, and mend what its tracker did wrong.

    Joint names are looked up in `skeletons/*.toml`, one file a naming convention, without regard to case, punctuation
    and a prefix that they share; the hierarchy must bear them out. `mapping` replaces the lookup: a TOML file, or its
    contents, with lines `canonical = "Their name"`.

    The rest follows from the hierarchy: the pelvis carries the hips, the chest carries the shoulders, the neck is the
    first joint from the chest to the head. Each of these bodies turns with its joint. The constant rotation from joint
    to body, Ramos (29), comes from the clip itself, since a file's zero pose often is no posture at all and a T-pose
    holds the head as nobody does: in that half of the frames that has the trunk most upright, Y of pelvis and chest
    lies along hips and shoulders and Z along the trunk, and the head is level and looks where the chest does, all on
    average.

    Frames that jump are bridged, a floor that drifts is levelled (`mending`), and who lies is turned upright
    (`postures`); the human's remarks say so.

    Raises:
        InputError: unknown names, names that contradict the hierarchy or the way the body faces, or a body that no
            human has.
    """
    joints = _joints_from_mapping(capture, mapping) if mapping is not None else _joints_from_conventions(capture)
    return standing(on_level_floor(check_plausible(without_jumps(_calibrated_human(capture, joints)))))


def naming_conventions() -> dict[str, JointAliases]:
    """Known naming conventions: name -> canonical joint -> the names it may have."""
    folder = files("sot.motion.human") / "skeletons"
    found = sorted((entry for entry in folder.iterdir() if entry.name.endswith(".toml")), key=lambda e: e.name)
    return {
        entry.name.removesuffix(".toml"): _checked_aliases(tomllib.loads(entry.read_text("utf-8")), entry.name)
        for entry in found
    }


def _checked_aliases(table: Mapping[str, object], where: str) -> JointAliases:
    names: dict[str, list[str]] = {}
    for joint, value in table.items():
        if joint not in CANONICAL_JOINTS:
            raise InputError(f"{where}: '{joint}' is no canonical joint; known are {', '.join(CANONICAL_JOINTS)}")
        aliases = value if isinstance(value, list) else [value]
        names[joint] = [alias for alias in aliases if isinstance(alias, str)]
        if not aliases or len(names[joint]) < len(aliases):
            raise InputError(f"{where}: '{joint}' needs a joint's name in quotes")
    return names


def _joints_from_mapping(capture: Capture, mapping: str | Path | Mapping[str, str]) -> dict[str, int]:
    if isinstance(mapping, str | Path):
        names, where = _checked_aliases(read_toml(Path(mapping), "a mapping of joints"), str(mapping)), str(mapping)
    else:
        names, where = _checked_aliases(mapping, "mapping"), "mapping"
    table = {name.lower(): index for index, name in enumerate(capture.joints)}
    joints: dict[str, int] = {}
    for joint, aliases in names.items():
        known = [table[alias.lower()] for alias in aliases if alias.lower() in table]
        if not known:
            has = ", ".join(capture.joints)
            raise InputError(f'{where}: {joint} = "{aliases[0]}" is no joint of {capture.name}, which has {has}')
        joints[joint] = known[0]
    joints = _with_unnamed_tips(capture, joints)
    if missing := [joint for joint in CANONICAL_JOINTS if joint not in joints]:
        raise InputError(f"{where}: leaves out {', '.join(missing)}")
    if wrong := _contradiction_in_hierarchy(capture, joints):
        raise InputError(f"{where}: {wrong}")
    return joints


def _joints_from_conventions(capture: Capture) -> dict[str, int]:
    table: dict[str, int] = {}
    for index, name in enumerate(capture.joints):
        table.setdefault(_plain_name(name), index)
    closest, reason = list(CANONICAL_JOINTS), ""
    for names in naming_conventions().values():
        for prefix in _possible_prefixes(table, names):
            joints = {
                joint: table[prefix + _plain_name(alias)]
                for joint, aliases in names.items()
                for alias in reversed(aliases)
                if prefix + _plain_name(alias) in table
            }
            joints = _with_unnamed_tips(capture, joints)
            missing = [joint for joint in CANONICAL_JOINTS if joint not in joints]
            wrong = "" if missing else _contradiction_in_hierarchy(capture, joints)
            if not missing and not wrong:
                return joints
            if len(missing) < len(closest):
                closest, reason = missing, wrong
    lacking = f"not found: {', '.join(closest)}" if closest else reason
    raise InputError(
        f"{capture.name}: unknown skeleton ({lacking}); write a mapping file with lines like"
        f' left_knee = "Their name" for {", ".join(CANONICAL_JOINTS)}; its joints are {", ".join(capture.joints)}'
    )


def _plain_name(name: str) -> str:
    return "".join(c for c in name.lower() if c.isalnum())


def _possible_prefixes(table: Mapping[str, int], names: JointAliases) -> list[str]:
    """Prefixes that all names of a file may share, read off the joints whose names end like a convention's head."""
    heads = [_plain_name(alias) for alias in names["head"]]
    found = {name.removesuffix(head) for name in table for head in heads if name.endswith(head)}
    return sorted(found | {""}, key=len)


def _with_unnamed_tips(capture: Capture, joints: dict[str, int]) -> dict[str, int]:
    """The joints with unnamed wrists and toes added: each is the farthest joint or end site below elbow or ankle."""
    for side in SIDES:
        for tip, base in JOINT_ABOVE_TIP.items():
            if f"{side}_{tip}" not in joints and f"{side}_{base}" in joints:
                farthest = _farthest_below(capture, joints[f"{side}_{base}"])
                if farthest is not None:
                    joints[f"{side}_{tip}"] = farthest
    return joints


def _farthest_below(capture: Capture, joint: int) -> int | None:
    below = [j for j in range(len(capture.joints)) if j != joint and joint in _joint_and_ancestors(capture, j)]
    first = capture.positions[0]
    return max(below, key=lambda j: float(np.linalg.norm(first[j] - first[joint])), default=None)


def _joint_and_ancestors(capture: Capture, joint: int) -> list[int]:
    """The joint itself, its parent, and so on to the root."""
    line = []
    while joint >= 0:
        line.append(joint)
        joint = capture.parents[joint]
    return line


def _common_ancestor(capture: Capture, one: int, other: int) -> int:
    above = set(_joint_and_ancestors(capture, other))
    return next(joint for joint in _joint_and_ancestors(capture, one) if joint in above)


def _contradiction_in_hierarchy(capture: Capture, joints: dict[str, int]) -> str:
    """Why the hierarchy rules these names out, in words; empty if it does not."""
    for side in SIDES:
        for limb in (*LIMB_JOINTS.values(), ("ankle", "toe")):
            for upper, lower in pairwise(limb):
                one, other = joints[f"{side}_{upper}"], joints[f"{side}_{lower}"]
                if one == other or one not in _joint_and_ancestors(capture, other):
                    names = capture.joints[other], capture.joints[one]
                    return f"{side}_{lower} ({names[0]}) is not below {side}_{upper} ({names[1]})"
    for name in ("hip", "shoulder"):
        pair = [joints[f"{side}_{name}"] for side in SIDES]
        if _common_ancestor(capture, *pair) in pair:
            return f"{capture.joints[pair[0]]} and {capture.joints[pair[1]]} cannot be the two {name}s"
    return ""


def _calibrated_human(capture: Capture, joints: dict[str, int]) -> Human:
    pelvis = _common_ancestor(capture, joints["left_hip"], joints["right_hip"])
    chest = _common_ancestor(capture, joints["left_shoulder"], joints["right_shoulder"])
    points = _canonical_points(capture, joints, chest)
    _check_points_apart(capture, points)
    trunk = points["neck"] - points["waist"]
    tilt = np.arctan2(np.linalg.norm(trunk[:, :2], axis=1), trunk[:, 2])
    upright = tilt <= np.median(tilt)
    level = np.broadcast_to([0.0, 0.0, 1.0], trunk.shape)
    target = {"pelvis": _frame_from_lateral_and_up(points["left_hip"] - points["right_hip"], trunk)}
    target["chest"] = _frame_from_lateral_and_up(points["left_shoulder"] - points["right_shoulder"], trunk)
    target["head"] = _frame_from_lateral_and_up(np.cross(level, target["chest"][:, :, 0]), level)
    reclined = (
        tilt > MIN_RECLINED_TILT
    )  # where nobody can tell where level is: the head is taken to go on along the trunk
    target["head"][reclined] = target["chest"][reclined]
    frames = {}
    for body, joint in (("pelvis", pelvis), ("chest", chest), ("head", joints["head"])):
        turns = capture.rotations[:, joint]
        seen = upright & np.isfinite(target[body]).all(axis=(1, 2))
        if not seen.any():
            raise InputError(
                f"{capture.name}: where its {body} faces cannot be told: hips or shoulders lie along its trunk"
            )
        to_body = nearest_rotations((turns.swapaxes(1, 2) @ target[body])[seen].mean(axis=0))
        frames[body] = turns @ (_with_snapped_lateral_axis(to_body) if body == "head" else to_body)
    ahead = sum(points[f"{side}_toe"] - points[f"{side}_ankle"] for side in SIDES)
    if np.sum(ahead * frames["pelvis"][:, :, 0]) < 0:
        raise InputError(f"{capture.name}: its toes point backwards; are left and right swapped in the joints' names?")

    human = Human(capture.name, capture.rate, points, frames)
    points["head_top"] = points["head"] + _head_height(capture, joints["head"], human.leg) * frames["head"][:, :, 2]
    return human


def _canonical_points(capture: Capture, joints: dict[str, int], chest: int) -> dict[str, np.ndarray]:
    """Canonical points (T, 3), but for the top of the head."""
    positions = capture.positions
    points = {name: positions[:, joint] for name, joint in joints.items()}
    points["waist"] = 0.5 * (points["left_hip"] + points["right_hip"])
    points["chest"] = positions[:, chest]
    between = _joint_and_ancestors(capture, joints["head"])[1:]
    between = between[: between.index(chest)] if chest in between else []
    # Some conversions drop a bone and leave the neck on the chest: take the next joint up. Others have no neck at all.
    bones = [np.linalg.norm(positions[0, j] - positions[0, chest]) for j in between]
    neck = next((j for j, bone in reversed(list(zip(between, bones, strict=True))) if bone > 0.03), None)
    points["neck"] = 0.5 * (points["left_shoulder"] + points["right_shoulder"]) if neck is None else positions[:, neck]
    return points


def _check_points_apart(capture: Capture, points: dict[str, np.ndarray]) -> None:
    segments = [ends for ends in SEGMENTS.values() if "head_top" not in ends]
    for one, other in (*segments, ("left_hip", "right_hip"), ("left_shoulder", "right_shoulder")):
        distance = np.linalg.norm(points[one] - points[other], axis=1)
        if distance.min() < 1e-3:
            raise InputError(f"{capture.name}: {one} and {other} coincide in frame {int(distance.argmin())}")


def _frame_from_lateral_and_up(lateral: np.ndarray, up: np.ndarray) -> np.ndarray:
    """(T, 3, 3) rotations with Y along `lateral` and Z as near as it can be to `up`; nan where these are parallel."""
    with np.errstate(invalid="ignore", divide="ignore"):
        y = lateral / np.linalg.norm(lateral, axis=1, keepdims=True)
        x = np.cross(y, up)
        x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x, y, np.cross(x, y)], axis=2)


def _with_snapped_lateral_axis(to_head: np.ndarray) -> np.ndarray:
    """The head's calibration with its lateral axis on the nearest axis of the joint, if that is near enough.

    Animators align a head joint with the head's plane of symmetry; yaw and roll become exact so.
    """
    y, z = to_head[:, 1], to_head[:, 2]
    axis = np.zeros(3)
    axis[np.argmax(np.abs(y))] = np.sign(y[np.argmax(np.abs(y))])
    return _frame_from_lateral_and_up(axis[None], z[None])[0] if axis @ y > AXIS_SNAP_COSINE else to_head


def _head_height(capture: Capture, head: int, leg: float) -> float:
    """From the head joint to its top [m]: the file's, where that is a human's."""
    top = _farthest_below(capture, head)
    height = 0.0 if top is None else float(np.linalg.norm(capture.positions[0, top] - capture.positions[0, head]))
    return height if HEAD_HEIGHT_RANGE_M[0] <= height <= HEAD_HEIGHT_RANGE_M[1] else AVERAGE_HEAD_HEIGHT_PER_LEG * leg
