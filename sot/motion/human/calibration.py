"""Where the bodies of a capture face: constant rotations from its joints to pelvis, chest and head, Ramos (29)."""

from dataclasses import dataclass

import numpy as np

from sot.errors import InputError
from sot.motion.human.capture import Capture
from sot.motion.human.human import SEGMENTS, SIDES, Human, nearest_rotations

HEAD_HEIGHT_RANGE_M = (0.08, 0.30)  # from a human's head joint to the top of the head
AVERAGE_HEAD_HEIGHT_PER_LEG = 0.2  # over the leg's length
MIN_RECLINED_TILT = np.radians(60.0)  # tilt of a trunk from which on a head's direction to look is not level
AXIS_SNAP_COSINE = np.cos(np.radians(30.0))  # a head's lateral axis within 30° of one of the joint's axes is that axis
MIN_NECK_BONE_M = 0.03  # from the chest's joint: a nearer joint is no neck


@dataclass(frozen=True)
class Calibration:
    """Which joints of a tree are a human's, and how its bodies sit on them; holds for every frame of one person.

    Attributes:
        joints: canonical joint -> joint of the tree.
        pelvis, chest: joints that carry the hips and the shoulders.
        neck: joint at the neck, None if the middle of the shoulders stands for it.
        to_body: pelvis, chest, head -> (3, 3) rotation from the body to its joint.
        head_height: from the head's joint to the top of the head [m].
    """

    joints: dict[str, int]
    pelvis: int
    chest: int
    neck: int | None
    to_body: dict[str, np.ndarray]
    head_height: float

    def human(self, capture: Capture) -> Human:
        """The human in a capture of the same tree, of any number of frames."""
        points = canonical_points(capture.positions, self.joints, self.chest, self.neck)
        on = {"pelvis": self.pelvis, "chest": self.chest, "head": self.joints["head"]}
        frames = {body: capture.rotations[:, joint] @ self.to_body[body] for body, joint in on.items()}
        points["head_top"] = points["head"] + self.head_height * frames["head"][:, :, 2]
        return Human(capture.name, capture.rate, points, frames, remarks=capture.remarks)


def calibrate(capture: Capture, joints: dict[str, int]) -> Calibration:
    """The calibration of a capture's joints from its own frames; see `skeleton.recognise`.

    Raises:
        InputError: points that coincide, bodies that face nowhere, or toes that point backwards.
    """
    pelvis = common_ancestor(capture, joints["left_hip"], joints["right_hip"])
    chest = common_ancestor(capture, joints["left_shoulder"], joints["right_shoulder"])
    neck = _neck_joint(capture, joints["head"], chest)
    points = canonical_points(capture.positions, joints, chest, neck)
    _check_points_apart(capture, points)
    trunk = points["neck"] - points["waist"]
    tilt = np.arctan2(np.linalg.norm(trunk[:, :2], axis=1), trunk[:, 2])
    upright = tilt <= np.median(tilt)
    to_body = {}
    target = upright_frames(points, tilt)
    for body, joint in (("pelvis", pelvis), ("chest", chest), ("head", joints["head"])):
        turns = capture.rotations[:, joint]
        seen = upright & np.isfinite(target[body]).all(axis=(1, 2))
        if not seen.any():
            raise InputError(
                f"{capture.name}: where its {body} faces cannot be told: hips or shoulders lie along its trunk"
            )
        turn = nearest_rotations((turns.swapaxes(1, 2) @ target[body])[seen].mean(axis=0))
        to_body[body] = _with_snapped_lateral_axis(turn) if body == "head" else turn
    across = points["left_hip"] - points["right_hip"]
    ahead = sum(  # of the shanks, whatever trunk and thighs do
        np.sum(
            (points[f"{side}_toe"] - points[f"{side}_ankle"])
            * np.cross(across, points[f"{side}_knee"] - points[f"{side}_ankle"])
        )
        for side in SIDES
    )
    if ahead < 0:
        raise InputError(f"{capture.name}: its toes point backwards; are left and right swapped in the joints' names?")
    leg = Human(capture.name, capture.rate, points, {}).leg
    return Calibration(joints, pelvis, chest, neck, to_body, _head_height(capture, joints["head"], leg))


def upright_frames(points: dict[str, np.ndarray], tilt: np.ndarray) -> dict[str, np.ndarray]:
    """Frames (T, 3, 3) of pelvis, chest and head as points alone show them: Y of pelvis and chest along hips and
    shoulders, Z along the trunk, the head level and looking where the chest does.

    tilt: (T,) of the trunk [rad].
    """
    trunk = points["neck"] - points["waist"]
    level = np.broadcast_to([0.0, 0.0, 1.0], trunk.shape)
    target = {"pelvis": _frame_from_lateral_and_up(points["left_hip"] - points["right_hip"], trunk)}
    target["chest"] = _frame_from_lateral_and_up(points["left_shoulder"] - points["right_shoulder"], trunk)
    target["head"] = _frame_from_lateral_and_up(np.cross(level, target["chest"][:, :, 0]), level)
    reclined = (
        tilt > MIN_RECLINED_TILT
    )  # where nobody can tell where level is: the head is taken to go on along the trunk
    target["head"][reclined] = target["chest"][reclined]
    return target


def canonical_points(
    positions: np.ndarray, joints: dict[str, int], chest: int, neck: int | None
) -> dict[str, np.ndarray]:
    """Canonical points (T, 3), but for the top of the head, of joints at positions (T, J, 3)."""
    points = {name: positions[:, joint] for name, joint in joints.items()}
    points["waist"] = 0.5 * (points["left_hip"] + points["right_hip"])
    points["chest"] = positions[:, chest]
    points["neck"] = 0.5 * (points["left_shoulder"] + points["right_shoulder"]) if neck is None else positions[:, neck]
    return points


def _neck_joint(capture: Capture, head: int, chest: int) -> int | None:
    """The first joint from the chest to the head, None if there is none."""
    between = joint_and_ancestors(capture, head)[1:]
    between = between[: between.index(chest)] if chest in between else []
    # Some conversions drop a bone and leave the neck on the chest: take the next joint up. Others have no neck at all.
    first = capture.positions[0]
    bones = [np.linalg.norm(first[j] - first[chest]) for j in between]
    return next((j for j, bone in reversed(list(zip(between, bones, strict=True))) if bone > MIN_NECK_BONE_M), None)


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
    top = farthest_below(capture, head)
    height = 0.0 if top is None else float(np.linalg.norm(capture.positions[0, top] - capture.positions[0, head]))
    return height if HEAD_HEIGHT_RANGE_M[0] <= height <= HEAD_HEIGHT_RANGE_M[1] else AVERAGE_HEAD_HEIGHT_PER_LEG * leg


def farthest_below(capture: Capture, joint: int) -> int | None:
    """The joint below another that is farthest from it in the first frame; None if nothing is below."""
    below = [j for j in range(len(capture.joints)) if j != joint and joint in joint_and_ancestors(capture, j)]
    first = capture.positions[0]
    return max(below, key=lambda j: float(np.linalg.norm(first[j] - first[joint])), default=None)


def joint_and_ancestors(capture: Capture, joint: int) -> list[int]:
    """The joint itself, its parent, and so on to the root."""
    line = []
    while joint >= 0:
        line.append(joint)
        joint = capture.parents[joint]
    return line


def common_ancestor(capture: Capture, one: int, other: int) -> int:
    """The lowest joint that two joints hang off, one of them perhaps."""
    above = set(joint_and_ancestors(capture, other))
    return next(joint for joint in joint_and_ancestors(capture, one) if joint in above)
