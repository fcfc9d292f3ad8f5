"""Who is who in a capture: any skeleton's joints under canonical names, and where its bodies face."""

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

from sot.errors import InputError
from sot.motion.human.anatomy import check_anatomy
from sot.motion.human.calibration import calibrate, common_ancestor, farthest_below, joint_and_ancestors
from sot.motion.human.capture import Capture
from sot.motion.human.human import SIDES, Human
from sot.motion.human.lost_frames import with_lost_frames_bridged
from sot.motion.human.mending import on_level_floor, without_jumps
from sot.motion.human.plausibility import check_plausible
from sot.motion.human.postures import standing
from sot.motion.human.unknown_skeleton import unknown_skeleton
from sot.toml_file import read_toml

LIMB_JOINTS = {"leg": ("hip", "knee", "ankle"), "arm": ("shoulder", "elbow", "wrist")}
JOINT_ABOVE_TIP = {"wrist": "elbow", "toe": "ankle"}  # an unnamed tip is the farthest joint below this one
CANONICAL_JOINTS = (
    "head",
    *(f"{s}_{j}" for s in SIDES for limb in LIMB_JOINTS.values() for j in limb),
    *(f"{s}_toe" for s in SIDES),
)

JointAliases = Mapping[str, list[str]]


def recognise(capture: Capture, mapping: str | Path | Mapping[str, str | list[str]] | None = None) -> Human:
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

    Frames that jump or were lost are bridged, a floor that drifts or slopes is levelled (`mending`), and who lies is
    turned upright (`postures`); the human's remarks say so.

    Raises:
        InputError: unknown names, names that contradict the hierarchy or the way the body faces, or a body that no
            human has, or that bends as none does.
    """
    joints = named_joints(capture, mapping)
    human = check_plausible(without_jumps(with_lost_frames_bridged(calibrate(capture, joints).human(capture))))
    return standing(on_level_floor(check_anatomy(human, capture, joints)))


def named_joints(capture: Capture, mapping: str | Path | Mapping[str, str | list[str]] | None = None) -> dict[str, int]:
    """Canonical joint -> joint of a capture, as `recognise` names them.

    Raises:
        UnknownSkeletonError: unknown names; it has a mapping to be completed.
        InputError: a mapping that does not fit, or names that contradict the hierarchy.
    """
    return _joints_from_mapping(capture, mapping) if mapping is not None else _joints_from_conventions(capture)


def read_mapping(path: Path) -> JointAliases:
    """Canonical joint -> the names it may have, as a mapping file (TOML) says.

    Raises:
        InputError: no such file, or something else than names of canonical joints in it.
    """
    return _checked_aliases(read_toml(path, "a mapping of joints"), str(path))


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


def _joints_from_mapping(capture: Capture, mapping: str | Path | Mapping[str, str | list[str]]) -> dict[str, int]:
    if isinstance(mapping, str | Path):
        names, where = read_mapping(Path(mapping)), str(mapping)
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
    closest, reason, partly = list(CANONICAL_JOINTS), "", dict[str, int]()
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
                closest, reason, partly = missing, wrong, joints
    aliases = {
        joint: [alias for names in naming_conventions().values() for alias in names.get(joint, [])]
        for joint in CANONICAL_JOINTS
    }
    raise unknown_skeleton(capture, aliases, partly, reason)


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
                farthest = farthest_below(capture, joints[f"{side}_{base}"])
                if farthest is not None:
                    joints[f"{side}_{tip}"] = farthest
    return joints


def _contradiction_in_hierarchy(capture: Capture, joints: dict[str, int]) -> str:
    """Why the hierarchy rules these names out, in words; empty if it does not."""
    for side in SIDES:
        for limb in (*LIMB_JOINTS.values(), ("ankle", "toe")):
            for upper, lower in pairwise(limb):
                one, other = joints[f"{side}_{upper}"], joints[f"{side}_{lower}"]
                if one == other or one not in joint_and_ancestors(capture, other):
                    names = capture.joints[other], capture.joints[one]
                    return f"{side}_{lower} ({names[0]}) is not below {side}_{upper} ({names[1]})"
    for name in ("hip", "shoulder"):
        pair = [joints[f"{side}_{name}"] for side in SIDES]
        if common_ancestor(capture, *pair) in pair:
            return f"{capture.joints[pair[0]]} and {capture.joints[pair[1]]} cannot be the two {name}s"
    return ""
