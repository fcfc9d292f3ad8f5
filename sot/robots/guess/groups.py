"""Which joints are legs, chest, head and arms: from how the links hang together, and what is mirrored in the middle."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.feet import Feet
from sot.robots.guess.heading import Heading
from sot.robots.guess.posed_model import PosedModel

Array = NDArray[np.float64]

MAX_MIRROR_ERROR = 0.03  # share of the height: places on both sides of the middle differ by no more
MIN_OFFSET_FROM_MIDDLE = 0.01  # share of the height: what is nearer to the middle is in it
LEG_JOINTS, ARM_JOINTS, HEAD_JOINTS = 6, 7, 4  # that a limb has at most
MAX_ORNAMENT_MASS_SHARE = 0.05  # share of the head's mass: a joint that moves less moves eyes
FINGERS = ("finger", "thumb", "gripper", "jaw", "knuckle")


@dataclass(frozen=True)
class Body:
    """A humanoid's parts.

    Attributes:
        pelvis, chest: links from which the legs and the arms go.
        feet, hands: side -> link; a hand is the last link of an arm, all that it carries included.
        groups: group of the robot file -> joints, from the trunk outwards.
        locked: joints of no group.
        height: of the whole robot [m].
    """

    pelvis: int
    chest: int
    feet: Mapping[str, int]
    hands: Mapping[str, int]
    groups: Mapping[str, Sequence[int]]
    locked: Sequence[int]
    height: float


def find_body(posed: PosedModel, feet: Feet, heading: Heading) -> tuple[Body, list[Evidence]]:
    """The parts of a robot that looks along x, its model's configuration in place.

    Raises:
        InputError: it has no arms, or joints that are neither hinges nor slides.
    """
    outward = _Outward(posed, feet)
    sides = {"left": heading.left, "right": heading.right}
    legs = {side: posed.joints_between(feet.pelvis, foot)[:LEG_JOINTS] for side, foot in sides.items()}
    shoulders = _shoulders(posed, outward, feet)
    if shoulders is None:
        raise InputError("no arms: nothing that the trunk carries is there twice, left and right of the middle")
    chest, roots, reach = shoulders
    arms = {side: _chain(posed, outward, root, ARM_JOINTS) for side, root in roots.items()}
    trunk = posed.joints_between(feet.pelvis, chest)
    skull = _head(posed, outward, feet, chest, list(roots.values()))
    groups = {
        "left_leg": legs["left"],
        "right_leg": legs["right"],
        "chest": [j for j in trunk if posed.moves_about_one_axis(j)],
        "head": skull,
        "left_arm": arms["left"],
        "right_arm": arms["right"],
    }
    taken = {j for joints in groups.values() for j in joints}
    locked = [j for j in posed.joints if j not in taken]
    hands = {side: posed.link_of(joints[-1]) for side, joints in arms.items()}
    body = Body(feet.pelvis, chest, sides, hands, groups, locked, feet.height)
    return body, _evidence(posed, body, reach, set(feet.toes), coupled_joints(posed))


def coupled_joints(posed: PosedModel) -> set[int]:
    """Joints that a coupling of the model makes follow others."""
    model = posed.model
    kinds = model.eq_type == mujoco.mjtEq.mjEQ_JOINT
    return {int(j) for j in model.eq_obj1id[kinds]}


class _Outward:
    """The tree as it is seen from the pelvis: children lie farther from it."""

    def __init__(self, posed: PosedModel, feet: Feet) -> None:
        legs = {link for foot in feet.links for link in posed.way(feet.pelvis, foot)[1:]}
        legs |= {link for leg in legs for link in posed.subtree(leg)}
        self.children: dict[int, list[int]] = {}
        todo, seen = [feet.pelvis], {feet.pelvis, *legs}
        while todo:
            link = todo.pop()
            near = [*posed.children(link), *([posed.parent(link)] if link != posed.base else [])]
            self.children[link] = [other for other in near if other not in seen]
            seen.update(near)
            todo += self.children[link]

    def beyond(self, link: int) -> list[int]:
        """A link and all that lies farther out."""
        out = [link]
        for other in out:
            out += self.children[other]
        return out


def _shoulders(posed: PosedModel, outward: _Outward, feet: Feet) -> tuple[int, dict[str, int], float] | None:
    """The link with the two longest branches that mirror each other, the branches, and how far they reach [m]."""
    best: tuple[int, dict[str, int], float] | None = None
    for link, children in outward.children.items():
        branches = [b for b in children if posed.parent(b) == link]
        for left in branches:
            at = posed.axis(posed.joints_of(left)[0])[0]
            if at[1] < MIN_OFFSET_FROM_MIDDLE * feet.height:
                continue
            for right in branches:
                other = posed.axis(posed.joints_of(right)[0])[0]
                if right == left or np.linalg.norm(other - at * (1, -1, 1)) > MAX_MIRROR_ERROR * feet.height:
                    continue
                reach = _reach(posed, outward, left, at)
                if best is None or reach > best[2]:
                    best = link, {"left": left, "right": right}, reach
    return best


def _reach(posed: PosedModel, outward: _Outward, branch: int, start: Array) -> float:
    points = posed.surface(posed.touching(outward.beyond(branch)))
    ends = np.vstack([points, *(posed.data.xpos[link][None] for link in outward.beyond(branch))])
    return float(np.linalg.norm(ends - start, axis=1).max())


def _chain(posed: PosedModel, outward: _Outward, root: int, most: int) -> list[int]:
    """Joints from a link outwards until the way forks, a joint slides or follows another, or there are too many."""
    coupled, joints, link = coupled_joints(posed), list[int](), root
    while True:
        for joint in posed.joints_of(link):
            finger = any(word in posed.joint_name(joint).lower() for word in FINGERS)
            if len(joints) == most or joint in coupled or finger or not posed.moves_about_one_axis(joint):
                return joints
            joints.append(joint)
        if len(outward.children[link]) != 1:
            return joints
        link = outward.children[link][0]


def _head(posed: PosedModel, outward: _Outward, feet: Feet, chest: int, arms: Sequence[int]) -> list[int]:
    """Joints of the highest branch in the middle, without the eyes."""
    trunk = [chest, *posed.way(feet.pelvis, chest)]
    branches = [
        child
        for link in trunk
        for child in outward.children[link]
        if child not in arms and child not in trunk and posed.parent(child) == link
    ]
    middle = [b for b in branches if abs(posed.data.subtree_com[b][1]) < MIN_OFFSET_FROM_MIDDLE * feet.height]
    shoulders = np.mean([posed.axis(posed.joints_of(arm)[0])[0][2] for arm in arms])
    high = [b for b in middle if _top(posed, outward, b) > shoulders]
    if not high:
        return []
    head = max(high, key=lambda b: _top(posed, outward, b))
    joints = _chain(posed, outward, head, HEAD_JOINTS)
    return [j for j in joints if posed.mass(posed.link_of(j)) > MAX_ORNAMENT_MASS_SHARE * posed.mass(head)]


def _top(posed: PosedModel, outward: _Outward, branch: int) -> float:
    points = posed.surface(posed.touching(outward.beyond(branch)))
    return float(points[:, 2].max()) if len(points) else float(posed.data.xpos[branch][2])


def _evidence(posed: PosedModel, body: Body, reach: float, toes: set[int], coupled: set[int]) -> list[Evidence]:
    groups, said = body.groups, []
    for pair, whole in (("leg", LEG_JOINTS), ("arm", 1)):
        left, right = (groups[f"{side}_{pair}"] for side in ("left", "right"))
        counts = f"{len(left)} and {len(right)} joints, left and right"
        fits = len(left) == len(right) >= whole
        if pair == "leg":
            why = f"the joints between {posed.name(body.pelvis)}, which carries both, and the feet"
        else:
            why = f"the longest branches that mirror each other, {reach:.2f} m, from {posed.name(body.chest)}"
        said.append(Evidence(f"{pair}s", counts, why, Sureness.SURE if fits else Sureness.UNSURE))
    chest, head = groups["chest"], groups["head"]
    between = f"the joints between {posed.name(body.pelvis)} and {posed.name(body.chest)}"
    if body.pelvis == body.chest:
        between = f"legs and arms go from one link, {posed.name(body.chest)}"
    said.append(Evidence("chest", _named(posed, chest), between, Sureness.SURE))
    why = "the highest branch in the middle of the trunk" if head else "no branch in the middle above the shoulders"
    said.append(Evidence("head", _named(posed, head), why, Sureness.SURE if head else Sureness.LIKELY))
    hands = {link for hand in body.hands.values() for link in posed.subtree(hand)}
    kinds: dict[str, list[int]] = {}
    for joint in body.locked:
        if joint in toes:
            kind = "beyond the feet"
        elif joint in coupled:
            kind = "coupled with others by the model"
        elif posed.link_of(joint) in hands:
            kind = "fingers, beyond the arms"
        elif not posed.moves_about_one_axis(joint):
            kind = "not hinges"
        else:
            kind = "part of nothing that was recognised"
        kinds.setdefault(kind, []).append(joint)
    for kind, joints in kinds.items():
        sureness = Sureness.UNSURE if kind.startswith("part of") else Sureness.LIKELY
        said.append(Evidence("locked", _named(posed, joints), kind, sureness))
    return said


def _named(posed: PosedModel, joints: Sequence[int]) -> str:
    return ", ".join(posed.joint_name(j) for j in joints) or "none"
