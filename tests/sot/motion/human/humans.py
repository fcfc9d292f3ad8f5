"""A made-up dancer for tests: a human of eighteen points that sways, turns and waves its arms."""

import numpy as np
from scipy.spatial.transform import Rotation

from sot.motion.human.human import Human

RATE = 40.0
LENGTHS = {
    "hip": 0.09,
    "thigh": 0.38,
    "shank": 0.37,
    "neck": 0.5,
    "head": 0.08,
    "top": 0.15,
    "shoulder": 0.17,
    "arm": 0.25,
}


def dancer(duration: float = 3.0, speed: float = 1.0) -> Human:
    """A human that dances on the spot for some seconds, its joints moving `speed` times as fast."""
    t = np.arange(round(duration * RATE) + 1) / RATE
    wave = speed * 2.0 * np.pi * t
    count = len(t)
    heading = Rotation.from_euler("z", (0.15 * np.sin(0.5 * wave))[:, None])
    pelvis = heading * Rotation.from_euler("y", (0.05 * np.sin(wave))[:, None])
    chest = pelvis * Rotation.from_euler("ZY", np.column_stack([0.2 * np.sin(0.7 * wave), 0.15 + 0.1 * np.sin(wave)]))
    head = chest * Rotation.from_euler("z", (0.2 * np.sin(wave))[:, None])
    up, left = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])

    def along(direction: np.ndarray, length: float) -> np.ndarray:
        return length * np.broadcast_to(direction, (count, 3))

    points = {
        "waist": np.column_stack([0.02 * np.sin(wave), 0.03 * np.sin(0.5 * wave), 0.80 - 0.03 * (1 - np.cos(wave))])
    }
    points["chest"] = points["waist"] + chest.apply(along(up, 0.5 * LENGTHS["neck"]))
    points["neck"] = points["waist"] + chest.apply(along(up, LENGTHS["neck"]))
    points["head"] = points["neck"] + chest.apply(along(up, LENGTHS["head"]))
    points["head_top"] = points["head"] + head.apply(along(up, LENGTHS["top"]))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        hip = points["waist"] + pelvis.apply(along(sign * left, LENGTHS["hip"]))
        ankle = np.tile([0.0, sign * 0.1, 0.08], (count, 1))
        points |= {f"{side}_hip": hip, f"{side}_ankle": ankle, f"{side}_knee": _knee(hip, ankle)}
        points[f"{side}_toe"] = ankle + np.array([0.15, 0.0, -0.06])
        shoulder = points["neck"] + chest.apply(along(sign * left, LENGTHS["shoulder"]))
        swing = np.column_stack([-0.6 - 0.4 * np.sin(wave), sign * (0.4 + 0.2 * np.sin(0.6 * wave))])
        upper = chest * Rotation.from_euler("YX", swing)
        lower = upper * Rotation.from_euler("y", (-0.8 - 0.4 * np.sin(wave + sign))[:, None])
        elbow = shoulder + upper.apply(along(-up, LENGTHS["arm"]))
        points |= {f"{side}_shoulder": shoulder, f"{side}_elbow": elbow}
        points[f"{side}_wrist"] = elbow + lower.apply(along(-up, LENGTHS["arm"]))
    frames = {"pelvis": pelvis.as_matrix(), "chest": chest.as_matrix(), "head": head.as_matrix()}
    return Human("dancer", RATE, points, frames)


def _knee(hip: np.ndarray, ankle: np.ndarray) -> np.ndarray:
    """Where a knee bends forward between hip and ankle."""
    way = ankle - hip
    length = np.linalg.norm(way, axis=1, keepdims=True)
    along = (LENGTHS["thigh"] ** 2 - LENGTHS["shank"] ** 2 + length**2) / (2 * length)
    out = np.sqrt(np.maximum(LENGTHS["thigh"] ** 2 - along**2, 0.0))
    forward = np.array([1.0, 0.0, 0.0]) - way * way[:, :1] / length**2
    return hip + way / length * along + forward / np.linalg.norm(forward, axis=1, keepdims=True) * out


def walker(steps: int = 6, stride: float = 0.3, period: float = 0.8) -> Human:
    """A human that walks along X: its feet take turns, each to a place a stride ahead of the other."""
    duration = period * (steps + 1)
    t = np.arange(round(duration * RATE) + 1) / RATE
    count = len(t)
    up, left = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
    feet = {side: np.tile([0.0, sign * 0.1, 0.08], (count, 1)) for side, sign in (("left", 1.0), ("right", -1.0))}
    for k in range(steps):
        track, last = feet["left" if k % 2 == 0 else "right"], k == steps - 1
        start = period * (k + 0.5)
        share = np.clip((t - start) / (0.7 * period), 0.0, 1.0)
        ease = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        track[:, 0] += ease * stride * (1.0 if k == 0 or last else 2.0)
        track[:, 2] += 0.12 * np.sin(np.pi * share) ** 2
    middle = 0.5 * (feet["left"] + feet["right"])
    heading = np.broadcast_to(np.eye(3), (count, 3, 3)).copy()
    points = {"waist": np.column_stack([middle[:, 0], middle[:, 1], np.full(count, 0.78)])}
    points["chest"], points["neck"] = points["waist"] + 0.25 * up, points["waist"] + 0.5 * up
    points["head"], points["head_top"] = points["neck"] + 0.08 * up, points["neck"] + 0.23 * up
    for side, sign in (("left", 1.0), ("right", -1.0)):
        hip = points["waist"] + sign * LENGTHS["hip"] * left
        points |= {f"{side}_hip": hip, f"{side}_ankle": feet[side], f"{side}_knee": _knee(hip, feet[side])}
        points[f"{side}_toe"] = feet[side] + np.array([0.15, 0.0, -0.06])
        shoulder = points["neck"] + sign * LENGTHS["shoulder"] * left
        elbow = shoulder - LENGTHS["arm"] * up
        wrist = elbow + LENGTHS["arm"] * np.array([0.6, 0.0, -0.8])
        points |= {f"{side}_shoulder": shoulder, f"{side}_elbow": elbow, f"{side}_wrist": wrist}
    return Human("walker", RATE, points, {"pelvis": heading, "chest": heading, "head": heading})
