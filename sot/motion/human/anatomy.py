"""How a human's joints cannot bend: recordings that were mirrored, or read in a wrong order of axes, are refused."""

import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.human.capture import Capture
from sot.motion.human.human import SIDES, Human

Array = NDArray[np.float64]

MIN_BEND = np.sin(np.radians(25.0))  # of a limb, from which on it shows where the limb bends
MIN_BENT_SHARE = 0.05  # of the frames of both sides, that have to show it
MIN_KNEE_COSINE = 0.5  # of a bent knee to the toes, seen along the shank, on average: a foot turns by less
MAX_HYPEREXTENSION = np.sin(np.radians(20.0))  # of an elbow, on average where it is bent
MIN_TRUNK_COSINE = -0.2  # of shoulders to hips, and of the head to the trunk, on average
MAX_STRETCH = 0.4  # of a bone, over its length, in nine tenths of the frames


def check_anatomy(human: Human, capture: Capture, joints: dict[str, int]) -> Human:
    """The human itself, if its knees and elbows bend as a human's do.

    capture: what it was recognised in; joints: its canonical joints there. Where its zero pose is a posture, that
    tells how forearms lie on upper arms.

    Raises:
        InputError: knees that bend to the side or backwards, elbows that bend backwards, a chest that faces
            backwards, a head below it, or bones that stretch.
    """
    wrong = (
        _stretching_bone(human)
        or _twisted_trunk(human)
        or _knees_off_toes(human)
        or ("" if capture.zero_pose is None else _hyperextended_elbows(capture, capture.zero_pose, joints))
    )
    if wrong:
        raise InputError(
            f"{human.name}: {wrong}: is the recording mirrored, are its axes in another order, or do other joints have"
            " these names?"
        )
    return human


def _stretching_bone(human: Human) -> str:
    points = human.points
    for side in SIDES:
        for upper, lower in (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist")):
            length = np.linalg.norm(points[f"{side}_{lower}"] - points[f"{side}_{upper}"], axis=1)
            shortest, middle, longest = np.percentile(length, [5.0, 50.0, 95.0])
            if longest - shortest > MAX_STRETCH * middle:
                return f"its {side} {upper} is between {shortest:.2f} and {longest:.2f} m from its {lower}"
    return ""


def _twisted_trunk(human: Human) -> str:
    points = human.points
    hips = _unit(points["left_hip"] - points["right_hip"])
    shoulders = _unit(points["left_shoulder"] - points["right_shoulder"])
    if np.mean(np.sum(hips * shoulders, axis=1)) < MIN_TRUNK_COSINE:
        return "its chest faces backwards"
    above = _unit(points["head"] - 0.5 * (points["left_shoulder"] + points["right_shoulder"]))
    if np.mean(np.sum(above * human.segment_direction("trunk"), axis=1)) < MIN_TRUNK_COSINE:
        return "its head is below its shoulders"
    return ""


def _knees_off_toes(human: Human) -> str:
    """Whether knees bend elsewhere than to where the toes point, seen along the shank."""
    points, knees, toes = human.points, [], []
    for side in SIDES:
        hip, knee, ankle, toe = (points[f"{side}_{joint}"] for joint in ("hip", "knee", "ankle", "toe"))
        along = _unit(ankle - knee)
        knees.append(_across(_unit(knee - hip), along))
        toes.append(_across(_unit(toe - ankle), along))
    bend, ahead = np.concatenate(knees), np.concatenate(toes)
    size = np.linalg.norm(bend, axis=1)
    bent = size > MIN_BEND
    if np.mean(bent) < MIN_BENT_SHARE:
        return ""
    product = np.sum(np.sum(bend * ahead, axis=1)[bent])
    if product < MIN_KNEE_COSINE * np.sum((size * np.linalg.norm(ahead, axis=1))[bent]):
        return "its knees do not bend to where its toes point"
    return ""


def _hyperextended_elbows(capture: Capture, pose: Array, joints: dict[str, int]) -> str:
    """Whether forearms turn backwards from upper arms, which the file's zero pose (J, 3) shows next to each other.

    Neither a forearm's own turn nor that of the upper arm matters: both are seen in the upper arm's own axes, and
    these in a zero pose in which the arms do not point ahead.
    """
    up = _unit(
        pose[joints["left_shoulder"]]
        + pose[joints["right_shoulder"]]
        - pose[joints["left_hip"]]
        - pose[joints["right_hip"]]
    )
    across = _unit(pose[joints["left_hip"]] - pose[joints["right_hip"]])
    ahead = np.cross(across, up)
    toes = sum(pose[joints[f"{side}_toe"]] - pose[joints[f"{side}_ankle"]] for side in SIDES)
    if abs(across @ up) > 0.3 or _unit(toes) @ ahead < 0.5:
        return ""  # no posture
    back = []
    for side in SIDES:
        shoulder, elbow, wrist = (joints[f"{side}_{joint}"] for joint in ("shoulder", "elbow", "wrist"))
        upper, lower = _unit(pose[elbow] - pose[shoulder]), _unit(pose[wrist] - pose[elbow])
        if abs(upper @ ahead) > 0.5 or upper @ lower < 0.9:
            return ""  # the zero pose does not show an arm that is straight and beside the body
        now = _unit(capture.positions[:, wrist] - capture.positions[:, elbow])
        back.append(-np.einsum("tji,tj->ti", capture.rotations[:, shoulder], now) @ (ahead - (ahead @ upper) * upper))
        bend = np.linalg.norm(
            np.cross(_unit(capture.positions[:, elbow] - capture.positions[:, shoulder]), now), axis=1
        )
        back[-1] = back[-1][bend > MIN_BEND]
    bent = np.concatenate(back)
    enough = len(bent) >= MIN_BENT_SHARE * len(SIDES) * capture.frames
    return "its elbows bend backwards" if enough and bent.mean() > MAX_HYPEREXTENSION else ""


def _across(vectors: Array, along: Array) -> Array:
    """The part (T, 3) of vectors across unit vectors."""
    part: Array = vectors - np.sum(vectors * along, axis=1, keepdims=True) * along
    return part


def _unit(vectors: Array) -> Array:
    unit: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
    return unit
