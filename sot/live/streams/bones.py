"""Bones of a humanoid avatar, as VMC and Rokoko name them, and a clip's joints as such bones."""

from collections.abc import Mapping

from sot.live.frame import Skeleton
from sot.motion.human.calibration import calibrate
from sot.motion.human.capture import Capture
from sot.motion.human.skeleton import named_joints

LIMB_BONES = {
    "UpperLeg": ("hip", "Hips"),
    "LowerLeg": ("knee", "UpperLeg"),
    "Foot": ("ankle", "LowerLeg"),
    "Toes": ("toe", "Foot"),
    "UpperArm": ("shoulder", "Chest"),
    "LowerArm": ("elbow", "UpperArm"),
    "Hand": ("wrist", "LowerArm"),
}
"""Bone of a limb -> canonical joint at its upper end, and its parent."""


def bones_of_clip(capture: Capture) -> tuple[Skeleton, list[int]]:
    """Bones that a clip's joints can play, under Unity's names, and the joint of each.

    Raises:
        InputError: the clip's skeleton is not known.
    """
    calibration = calibrate(capture, named_joints(capture))
    joint_of = {"Hips": calibration.pelvis, "Chest": calibration.chest}
    parent_of = {"Chest": "Hips"}
    if calibration.neck is not None:
        joint_of["Neck"], parent_of["Neck"] = calibration.neck, "Chest"
    joint_of["Head"], parent_of["Head"] = calibration.joints["head"], "Neck" if "Neck" in joint_of else "Chest"
    for side in ("Left", "Right"):
        for bone, (joint, parent) in LIMB_BONES.items():
            joint_of[side + bone] = calibration.joints[f"{side.lower()}_{joint}"]
            parent_of[side + bone] = parent if parent in joint_of else side + parent
    return skeleton_of(parent_of, list(joint_of)), list(joint_of.values())


def skeleton_of(parent_of: Mapping[str, str], bones: list[str]) -> Skeleton:
    """Skeleton of bones, each after its parent; a bone whose parent is not among them hangs off that one's parent."""

    def parent(bone: str) -> int:
        above = parent_of.get(bone)
        while above is not None and above not in bones:
            above = parent_of.get(above)
        return -1 if above is None else bones.index(above)

    return Skeleton(tuple(bones), tuple(parent(bone) for bone in bones))
