"""Markers on the skin under the names of a marker set, and the joints inside, by published regressions."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from sot.motion.human.human import SIDES

Array = NDArray[np.float64]
Places = Mapping[str, Array]
"""Marker -> (T, 3) [m]."""

HARRINGTON_M = ((-0.24, -0.0099), (0.33, 0.0073), (-0.30, -0.0109))
"""Hip joint from the middle of the front of the pelvis, Harrington 2007: forward, factor of the pelvis's depth and
constant [m]; outward and up, of its breadth."""
SHOULDER_DROP = 0.17  # of the breadth of the shoulders, from the acromion down to the joint: Rab 2002
HALF_BREADTH_PER_LEG = {"knee": 0.065, "ankle": 0.045, "elbow": 0.05}  # from a marker on the outside to the joint
BEND_WEIGHT = 5.0  # of the plane in which a limb bends, against the body's own sides where it is straight
HEAD_JOINT_SHARE = 0.6  # of the way from the middle of the shoulders to that of the head's markers
BODIES = ("pelvis", "chest", "head")
LANDMARKS = (
    "left_front_waist",
    "right_front_waist",
    "back_waist",
    *(f"{side}_{joint}" for side in SIDES for joint in ("shoulder", "elbow", "wrist", "knee", "ankle", "toe")),
)
MIN_BODY_MARKERS = 3


@dataclass(frozen=True)
class MarkerSet:
    """Which markers of a set are where.

    Attributes:
        name: of the set.
        markers: landmark or body -> names that its markers may have.
    """

    name: str
    markers: Mapping[str, Sequence[str]]

    def chosen(self, labels: Sequence[str]) -> dict[str, list[str]]:
        """Landmark or body -> those labels that are its markers."""
        table = {label.lower(): label for label in labels}
        found = {
            place: [table[name.lower()] for name in names if name.lower() in table]
            for place, names in self.markers.items()
        }
        return {place: names for place, names in found.items() if names}

    def missing(self, labels: Sequence[str]) -> list[str]:
        """Markers that are needed and not there, by their usual names."""
        chosen = self.chosen(labels)
        lacking = [self.markers[place][0] for place in LANDMARKS if place not in chosen]
        for body in BODIES:
            have = chosen.get(body, [])
            more = [name for name in self.markers[body] if name not in have]
            lacking += more[: max(0, MIN_BODY_MARKERS - len(have))]
        return list(dict.fromkeys(lacking))


def marker_sets() -> list[MarkerSet]:
    """The known sets, each from a file of `markers/`."""
    folder = files("sot.motion.human") / "markers"
    found = sorted((entry for entry in folder.iterdir() if entry.name.endswith(".toml")), key=lambda e: e.name)
    return [MarkerSet(e.name.removesuffix(".toml"), tomllib.loads(e.read_text("utf-8"))) for e in found]


def joint_centres(chosen: Mapping[str, Sequence[str]], places: Places) -> dict[str, Array]:
    """Joint -> (T, 3) of the markers that a set chose, by their places without gaps."""
    seen = {place: np.mean([places[name] for name in names], axis=0) for place, names in chosen.items()}
    joints = _hips(seen)
    breadth = np.linalg.norm(seen["left_shoulder"] - seen["right_shoulder"], axis=1, keepdims=True)
    waist = 0.5 * (joints["left_hip"] + joints["right_hip"])
    up = _unit(0.5 * (seen["left_shoulder"] + seen["right_shoulder"]) - waist)
    across = _unit(seen["left_shoulder"] - seen["right_shoulder"])
    pelvis_across = _unit(joints["left_hip"] - joints["right_hip"])
    knee = np.mean([np.linalg.norm(seen[f"{s}_knee"] - joints[f"{s}_hip"], axis=1) for s in SIDES])
    shank = np.mean([np.linalg.norm(seen[f"{s}_ankle"] - seen[f"{s}_knee"], axis=1) for s in SIDES])
    leg = float(knee + shank)
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        shoulder = seen[f"{side}_shoulder"] - SHOULDER_DROP * breadth * up
        wrist, hip = seen[f"{side}_wrist"], joints[f"{side}_hip"]
        arm = _unit(seen[f"{side}_elbow"] - shoulder)
        beside_arm = sign * (_dot(arm, up) * across - _dot(arm, across) * up)
        arm_inward = sign * np.cross(arm, _unit(wrist - seen[f"{side}_elbow"]))
        leg_inward = -sign * np.cross(
            _unit(seen[f"{side}_knee"] - hip), _unit(seen[f"{side}_ankle"] - seen[f"{side}_knee"])
        )
        inward = {
            "elbow": BEND_WEIGHT * arm_inward + beside_arm,
            "knee": BEND_WEIGHT * leg_inward - sign * pelvis_across,
            "ankle": BEND_WEIGHT * leg_inward - sign * pelvis_across,
        }
        joints |= {f"{side}_shoulder": shoulder, f"{side}_wrist": wrist, f"{side}_toe": seen[f"{side}_toe"]}
        for joint, direction in inward.items():
            outer, inner = seen[f"{side}_{joint}"], seen.get(f"{side}_{joint}_inner")
            depth = HALF_BREADTH_PER_LEG[joint] * leg
            joints[f"{side}_{joint}"] = outer + depth * _unit(direction) if inner is None else 0.5 * (outer + inner)
    return joints | _spine(seen, joints)


def _hips(seen: Places) -> dict[str, Array]:
    left, right, back = seen["left_front_waist"], seen["right_front_waist"], seen["back_waist"]
    middle = 0.5 * (left + right)
    breadth = np.linalg.norm(left - right, axis=1, keepdims=True)
    depth = np.linalg.norm(middle - back, axis=1, keepdims=True)
    across = _unit(left - right)
    ahead = _unit((middle - back) - _dot(middle - back, across) * across)
    up = np.cross(ahead, across)
    (x, x0), (y, y0), (z, z0) = HARRINGTON_M
    inside = middle + (x * depth + x0) * ahead + (z * breadth + z0) * up
    beside = (y * breadth + y0) * across
    return {"left_hip": inside + beside, "right_hip": inside - beside}


def _spine(seen: Places, joints: Places) -> dict[str, Array]:
    shoulders = 0.5 * (joints["left_shoulder"] + joints["right_shoulder"])
    waist = 0.5 * (joints["left_hip"] + joints["right_hip"])
    spine = {
        "pelvis": waist,
        "chest": 0.5 * (waist + shoulders),
        "head": shoulders + HEAD_JOINT_SHARE * (seen["head"] - shoulders),
    }
    return spine | ({"neck": seen["neck"]} if "neck" in seen else {})


def body_rotations(markers: Sequence[Array]) -> Array:
    """Rotations (T, 3, 3) of a body whose markers are at places (T, 3): the best fit of their mean shape, Kabsch."""
    cloud = np.stack(markers, axis=1)
    cloud = cloud - cloud.mean(axis=1, keepdims=True)
    shape = cloud[0]
    for _ in range(2):  # the first frame's shape, then the mean of all
        u, _, vt = np.linalg.svd(np.einsum("tki,kj->tij", cloud, shape))
        u[:, :, 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
        rotations: Array = u @ vt
        shape = np.einsum("tji,tkj->tki", rotations, cloud).mean(axis=0)
    return rotations


def _unit(vectors: Array) -> Array:
    unit: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-9)
    return unit


def _dot(a: Array, b: Array) -> Array:
    product: Array = np.sum(a * b, axis=1, keepdims=True)
    return product
