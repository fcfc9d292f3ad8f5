"""Eight positions of the upper body, Dariush 2009 and Bin Hammam 2015: a human reduced to what a camera sees of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sot.errors import InputError
from sot.motion.human.human import SIDES, Human

Array = np.ndarray
Points = Mapping[str, Array]

KEY_POINTS = ("waist", *(f"{side}_{joint}" for joint in ("shoulder", "elbow", "wrist") for side in SIDES), "head")
"""Names of the key points, all of them points of a `Human` and of a robot."""
POINT_GROUPS = {
    "shoulders": KEY_POINTS[1:3],
    "elbows": KEY_POINTS[3:5],
    "wrists": KEY_POINTS[5:7],
    "hands": KEY_POINTS[5:7],
}
"""Words for a left and a right key point; who says hands means wrists."""
HIP_BREADTH_PER_LEG, ANKLE_HEIGHT_PER_LEG, TOE_LENGTH_PER_LEG = 0.24, 0.1, 0.2
"""Proportions of the legs that stand below a waist of which nothing else is known, over the length of a leg."""
HEAD_TOP_PER_TRUNK = 0.3
"""Distance of the top of the head from the head's key point, over the length of the trunk."""
LEG_PER_TRUNK = 1.6
"""Length of thigh and shank over that of the trunk (waist to middle of the shoulders), of an average human."""


def parse_key_points(text: str) -> tuple[str, ...]:
    """Names of the key points that a list like "waist,hands,head" asks for, in the order of KEY_POINTS.

    Raises:
        InputError: a name that is none, or none at all.
    """
    wanted: set[str] = set()
    for word in (part.strip() for part in text.split(",")):
        if word not in POINT_GROUPS and word not in KEY_POINTS:
            known = ", ".join(dict.fromkeys((*KEY_POINTS, *POINT_GROUPS)))
            raise InputError(f"'{word}' is no key point: choose some of {known}")
        wanted |= set(POINT_GROUPS.get(word, (word,)))
    return tuple(name for name in KEY_POINTS if name in wanted)


def key_points_of(human: Human, names: Sequence[str] = KEY_POINTS) -> dict[str, Array]:
    """Positions of key points of a human, name -> (T, 3) in its world [m]."""
    return {name: human.points[name] for name in names}


@dataclass(frozen=True)
class UpperBodyLengths:
    """Lengths of the links between the eight key points, the same on both sides.

    Attributes:
        trunk: from the waist to the middle of the shoulders [m].
        breadth: distance of the shoulders [m].
        head: from the middle of the shoulders to the head [m].
        upper_arm, forearm: means of both sides [m].
    """

    trunk: float
    breadth: float
    head: float
    upper_arm: float
    forearm: float

    @staticmethod
    def of(points: Points) -> "UpperBodyLengths":
        """Medians over all frames of eight key points, each (T, 3) or (3,), of a human or of a robot."""

        def length(near: Array, far: Array) -> float:
            return float(np.median(np.linalg.norm(np.asarray(far) - near, axis=-1)))

        def mean_length(near: str, far: str) -> float:
            return float(np.mean([length(points[f"{side}_{near}"], points[f"{side}_{far}"]) for side in SIDES]))

        middle = _middle_of_shoulders(points)
        return UpperBodyLengths(
            trunk=length(points["waist"], middle),
            breadth=length(points["left_shoulder"], points["right_shoulder"]),
            head=length(middle, points["head"]),
            upper_arm=mean_length("shoulder", "elbow"),
            forearm=mean_length("elbow", "wrist"),
        )

    def applied_to(self, points: Points) -> dict[str, Array]:
        """Key points with these lengths and the directions of others, link by link from the waist, which stays.

        Args:
            points: The eight key points, each (T, 3) or (3,).
        """

        def along(near: Array, far: Array, length: float) -> Array:
            way = far - near
            return length * way / np.linalg.norm(way, axis=-1, keepdims=True)

        own_middle = _middle_of_shoulders(points)
        middle = points["waist"] + along(points["waist"], own_middle, self.trunk)
        half = 0.5 * along(points["right_shoulder"], points["left_shoulder"], self.breadth)
        scaled = {"waist": points["waist"], "left_shoulder": middle + half, "right_shoulder": middle - half}
        for side in SIDES:
            shoulder, elbow, wrist = (points[f"{side}_{joint}"] for joint in ("shoulder", "elbow", "wrist"))
            scaled[f"{side}_elbow"] = scaled[f"{side}_shoulder"] + along(shoulder, elbow, self.upper_arm)
            scaled[f"{side}_wrist"] = scaled[f"{side}_elbow"] + along(elbow, wrist, self.forearm)
        scaled["head"] = middle + along(own_middle, points["head"], self.head)
        return {name: scaled[name] for name in KEY_POINTS}


def human_from_key_points(points: Points, rate: float, name: str = "key points", leg: float | None = None) -> Human:
    """A human of eight key points, of which the rest is assumed: both legs stand below the waist.

    The chest lies along the shoulders and the trunk. The head faces where the chest does. The pelvis is upright, and
    turned as the chest is. The feet stand side by side below the waist, knees bent forward as its height asks.

    Args:
        points: The key points, each (T, 3) in a world whose Z is up [m]; T may be 1.
        rate: Frames per second [Hz].
        name: Of the clip.
        leg: Length of thigh and shank [m]; an average human's of this trunk unless given.

    Raises:
        InputError: Some of the eight are missing.
    """
    if missing := [key for key in KEY_POINTS if key not in points]:
        raise InputError(f"{name}: a human takes all eight key points; missing: {', '.join(missing)}")
    lengths = UpperBodyLengths.of(points)
    leg = LEG_PER_TRUNK * lengths.trunk if leg is None else leg
    waist, neck = points["waist"], _middle_of_shoulders(points)
    lateral = points["left_shoulder"] - points["right_shoulder"]
    chest = _frames(lateral, neck - waist)
    pelvis = _frames(lateral * [1.0, 1.0, 0.0], np.broadcast_to([0.0, 0.0, 1.0], lateral.shape))
    head = _frames(lateral, points["head"] - neck)
    whole = {key: np.asarray(points[key], dtype=float) for key in KEY_POINTS}
    whole |= {"neck": neck, "chest": 0.5 * (waist + neck)}
    whole["head_top"] = whole["head"] + HEAD_TOP_PER_TRUNK * lengths.trunk * head[:, :, 2]
    forward, left, up = (pelvis[:, :, axis] for axis in range(3))
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        hip = waist + 0.5 * sign * HIP_BREADTH_PER_LEG * leg * left
        reach = np.clip(hip[:, 2:] - ANKLE_HEIGHT_PER_LEG * leg, 0.1 * leg, leg)
        ankle = hip - reach * up
        knee = hip - 0.5 * reach * up + np.sqrt(np.maximum(0.25 * (leg**2 - reach**2), 0.0)) * forward
        toe = ankle + TOE_LENGTH_PER_LEG * leg * forward
        whole |= {f"{side}_hip": hip, f"{side}_knee": knee, f"{side}_ankle": ankle, f"{side}_toe": toe}
    return Human(name, rate, whole, {"pelvis": pelvis, "chest": chest, "head": head})


def _middle_of_shoulders(points: Points) -> Array:
    return 0.5 * (np.asarray(points["left_shoulder"]) + points["right_shoulder"])


def _frames(lateral: Array, up: Array) -> Array:
    """Rotations (T, 3, 3) to the world with Y along `lateral` (T, 3) and Z as near as it can be to `up` (T, 3)."""
    y = lateral / np.linalg.norm(lateral, axis=1, keepdims=True)
    x = np.cross(y, up)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x, y, np.cross(x, y)], axis=2)
