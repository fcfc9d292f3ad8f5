"""Where a robot's operational points are: where the axes of joints meet, not where links have their origins."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.feet import sole
from sot.robots.guess.groups import Body
from sot.robots.guess.posed_model import PosedModel

Array = NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])
ROOT_JOINTS = 3  # that a hip or a shoulder has at most
CROSSING = np.sin(np.deg2rad(30.0))  # axes at less than this angle do not meet anywhere for certain
TOGETHER = 0.05  # share of the limb's length: axes that near to a point go through it
FAR = 0.25  # share of the limb's length: an axis that far from hip or shoulder is the knee's or the elbow's
FOREARM = 0.6  # share of forearm and hand that is forearm, if no joint says where the wrist is
NECK_RISE = 0.06  # share of the height: a neck that does not turn, above the shoulders
HEAD_SHARE = 0.35  # of neck and head that is neck, if the head does not turn


@dataclass(frozen=True)
class Point:
    """A place (3,) in the world [m], and the link that carries it."""

    link: int
    at: Array


@dataclass(frozen=True)
class Points:
    """All operational points by name, and the joints that bend a limb: side and limb -> knee or elbow."""

    places: Mapping[str, Point]
    bends: Mapping[str, int]


def find_points(posed: PosedModel, body: Body) -> tuple[Points, list[Evidence]]:
    """Points of a robot in its model's configuration, looking along x."""
    places, bends, evidence = dict[str, Point](), dict[str, int](), list[Evidence]()
    for limb, what in (("leg", "hips, knees, ankles"), ("arm", "shoulders, elbows, wrists")):
        said = []
        for side in ("left", "right"):
            bends[f"{side}_{limb}"], why, sureness = (_leg if limb == "leg" else _arm)(posed, body, side, places)
            said.append((sureness, why))
        middle = " and ".join(posed.joint_name(bends[f"{side}_{limb}"]) for side in ("left", "right"))
        found = f"{what.split(', ')[1]} turn about {middle}"
        evidence.append(Evidence(what, found, said[0][1], max(said, key=lambda each: list(Sureness).index(each[0]))[0]))
    _trunk(posed, body, places, evidence)
    return Points(places, bends), evidence


def meeting(posed: PosedModel, joints: Sequence[int], size: float) -> tuple[Array, list[int], float]:
    """Where the axes of joints meet (3,): the two that pass nearest to each other, and all others that pass there;
    these joints; and their largest distance from it [m]."""
    axes = {j: posed.axis(j) for j in joints}
    pairs = [
        (_distance(axes[a], axes[b]), a, b)
        for k, a in enumerate(joints)
        for b in joints[k + 1 :]
        if np.linalg.norm(np.cross(axes[a][1], axes[b][1])) > CROSSING
    ]
    if not pairs:
        return axes[joints[-1]][0], [joints[-1]], 0.0
    _, *pair = min(pairs)
    point = _nearest([axes[j] for j in pair])
    used = [j for j in joints if j in pair or _off(axes[j], point) < TOGETHER * size]
    point = _nearest([axes[j] for j in used])
    return point, used, max(_off(axes[j], point) for j in used)


def _distance(first: tuple[Array, Array], second: tuple[Array, Array]) -> float:
    normal = np.cross(first[1], second[1])
    return abs(float((second[0] - first[0]) @ normal)) / float(np.linalg.norm(normal))


def _off(axis: tuple[Array, Array], point: Array) -> float:
    return float(np.linalg.norm(np.cross(axis[1], point - axis[0])))


def _nearest(axes: Sequence[tuple[Array, Array]]) -> Array:
    """The point with the least sum of squared distances from axes: Σ (I − a aᵀ)(x − p) = 0."""
    away = [np.eye(3) - np.outer(way, way) for _, way in axes]
    x: Array = np.linalg.solve(
        np.sum(away, axis=0), np.sum([a @ at for a, (at, _) in zip(away, axes, strict=True)], axis=0)
    )
    return x


def _on_axis(axis: tuple[Array, Array], start: Array, end: Array) -> Array:
    """The point of an axis that is nearest to the line through two others."""
    line = (end - start) / max(float(np.linalg.norm(end - start)), 1e-12)
    at, way = axis
    if np.linalg.norm(np.cross(way, line)) < CROSSING:  # along it: abreast of the middle
        return at + way * float(way @ (0.5 * (start + end) - at))
    across = np.eye(3) - np.outer(line, line)
    return at + way * float((start - at) @ across @ way) / float(way @ across @ way)


def _in_middle(axis: tuple[Array, Array]) -> Array:
    """The point of an axis that is in the middle of the robot, if the axis goes through it."""
    at, way = axis
    return at - way * at[1] / way[1] if abs(way[1]) > CROSSING else at


def _limb(posed: PosedModel, joints: Sequence[int], end: Array) -> tuple[Array, int, list[int], float]:
    """Where a limb starts; the number among its joints of the one that bends it; the joints that meet at its start; by
    how much they miss each other [m]."""
    size = float(np.linalg.norm(end - posed.axis(joints[0])[0]))
    start, used, off = meeting(posed, joints[:ROOT_JOINTS], size)
    after = 1 + joints.index(used[-1])
    middle = next((k for k in range(after, len(joints)) if _off(posed.axis(joints[k]), start) > FAR * size), None)
    if middle is None:
        middle = min(after, len(joints) - 1)
    return start, middle, used, off


def _leg(posed: PosedModel, body: Body, side: str, places: dict[str, Point]) -> tuple[int, str, Sureness]:
    joints, foot = list(body.groups[f"{side}_leg"]), body.feet[side]
    corners, _ = sole(posed, foot)
    hip, knee, used, off = _limb(posed, joints, posed.axis(joints[-1])[0])
    below = joints[knee + 1 :]
    ankle, _, miss = meeting(posed, below, body.height) if below else (posed.data.xpos[foot].copy(), [], 0.0)
    places[f"{side}_hip"] = Point(posed.link_of(used[0]), hip)
    places[f"{side}_knee"] = Point(posed.link_of(joints[knee]), _on_axis(posed.axis(joints[knee]), hip, ankle))
    places[f"{side}_ankle"] = Point(foot, ankle)
    floor, front = corners[0, 2], corners[:, 0].max()
    places[f"{side}_foot"] = Point(foot, np.array([ankle[0], ankle[1], floor]))
    places[f"{side}_toe"] = Point(foot, np.array([front, ankle[1], floor]))
    hips = ", ".join(posed.joint_name(j) for j in used)
    why = (
        f"hip where the axes of {hips} meet ({1e3 * off:.0f} mm off), ankle where those below the knee do "
        f"({1e3 * miss:.0f} mm off)"
    )
    return joints[knee], why, Sureness.SURE if knee == 3 and len(below) == 2 else Sureness.UNSURE


def _arm(posed: PosedModel, body: Body, side: str, places: dict[str, Point]) -> tuple[int, str, Sureness]:
    joints, hand = list(body.groups[f"{side}_arm"]), body.hands[side]
    carried = posed.subtree(hand)
    skin = posed.surface(posed.touching(carried))
    if not len(skin):
        skin = posed.data.xpos[hand][None]
    first = posed.axis(joints[0])[0]
    tip = skin[np.argmax(np.linalg.norm(skin - first, axis=1))]
    shoulder, elbow, used, off = _limb(posed, joints, tip)
    beyond = joints[elbow + 1 :]
    hinge = posed.axis(joints[elbow])
    if len(beyond) > 1:
        wrist, _, _ = meeting(posed, beyond, body.height)
        why, sureness = f"wrist where the axes of {', '.join(posed.joint_name(j) for j in beyond)} meet", Sureness.SURE
    else:
        start = _on_axis(hinge, shoulder, tip)
        at = posed.axis(beyond[0])[0] if beyond else start
        told = float(np.linalg.norm(at - start)) > FAR * float(np.linalg.norm(tip - start))
        wrist = at if told else start + FOREARM * (tip - start)
        why, sureness = "the wrist by human proportions: no two joints beyond the elbow", Sureness.LIKELY
    places[f"{side}_shoulder"] = Point(posed.link_of(used[0]), shoulder)
    places[f"{side}_elbow"] = Point(posed.link_of(joints[elbow]), _on_axis(hinge, shoulder, wrist))
    places[f"{side}_wrist"] = Point(hand, wrist)
    places[f"{side}_hand"] = Point(hand, _palm(skin, places[f"{side}_elbow"].at, wrist))
    meet = ", ".join(posed.joint_name(j) for j in used)
    return joints[elbow], f"shoulder where the axes of {meet} meet ({1e3 * off:.0f} mm off); {why}", sureness


def _palm(skin: Array, elbow: Array, wrist: Array) -> Array:
    """Half-way from the wrist to the end of what the hand's link carries, straight on from the forearm."""
    way = (wrist - elbow) / max(float(np.linalg.norm(wrist - elbow)), 1e-12)
    reach = max(float(((skin - wrist) @ way).max()), 0.0)
    return wrist + 0.5 * reach * way


def _trunk(posed: PosedModel, body: Body, places: dict[str, Point], evidence: list[Evidence]) -> None:
    hips, shoulders = (
        0.5 * (places[f"left_{name}"].at + places[f"right_{name}"].at) * (1, 0, 1) for name in ("hip", "shoulder")
    )
    places["waist"] = Point(body.pelvis, hips)
    chest, head = list(body.groups["chest"]), list(body.groups["head"])
    if len(chest) > 1:
        middle = meeting(posed, chest, body.height)[0]
        why = f"where the axes of {', '.join(posed.joint_name(j) for j in chest)} meet"
    elif chest:
        middle = _on_axis(posed.axis(chest[0]), hips, shoulders)
        why = f"on the axis of {posed.joint_name(chest[0])}"
    else:
        middle, why = 0.5 * (hips + shoulders), "half-way up the trunk, which has no joint"
    places["chest"] = Point(body.chest, middle)
    evidence.append(Evidence("waist, chest", "in the middle between the hips", f"chest {why}", Sureness.SURE))
    if head:
        carried = posed.link_of(head[-1])
        nape = meeting(posed, head, body.height)[0] if len(head) > 1 else _in_middle(posed.axis(head[0]))
        skull = _in_middle(posed.axis(head[-1]))
        why, sureness = f"where {posed.joint_name(head[0])} and {posed.joint_name(head[-1])} turn", Sureness.SURE
        skin = posed.surface(posed.seen(posed.subtree(carried)))
    else:
        carried = body.chest
        nape = shoulders + NECK_RISE * body.height * UP
        why, sureness = "by human proportions: the head does not turn", Sureness.LIKELY
        skin = posed.surface(posed.seen([body.chest]))
        skull = nape
    top = float(skin[:, 2].max()) if len(skin) else nape[2] + NECK_RISE * body.height
    top = max(top, nape[2] + 0.5 * NECK_RISE * body.height)
    if not head:
        skull = nape + HEAD_SHARE * (top - nape[2]) * UP
    places["neck"] = Point(body.chest, nape)
    places["head"] = Point(carried, skull)
    places["head_top"] = Point(carried, np.array([skull[0], skull[1], top]))
    evidence.append(Evidence("neck, head", f"head's top {top - nape[2]:.2f} m above the neck", why, sureness))
