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
from sot.robots.guess.tree import Tree

Array = NDArray[np.float64]

MIRRORED = 0.03  # share of the height: places on both sides of the middle differ by no more
OFF_MIDDLE = 0.01  # share of the height: what is nearer to the middle is in it
LEG_JOINTS, ARM_JOINTS, HEAD_JOINTS = 6, 7, 4  # that a limb has at most
LIGHT = 0.05  # share of the head's mass: a joint that moves less moves eyes
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


def find_body(tree: Tree, feet: Feet, heading: Heading) -> tuple[Body, list[Evidence]]:
    """The parts of a robot that looks along x, its model's configuration in place.

    Raises:
        InputError: it has no arms, or joints that are neither hinges nor slides.
    """
    outward = _Outward(tree, feet)
    sides = {"left": heading.left, "right": heading.right}
    legs = {side: tree.joints_between(feet.pelvis, foot)[:LEG_JOINTS] for side, foot in sides.items()}
    shoulders = _shoulders(tree, outward, feet)
    if shoulders is None:
        raise InputError("no arms: nothing that the trunk carries is there twice, left and right of the middle")
    chest, roots, reach = shoulders
    arms = {side: _chain(tree, outward, root, ARM_JOINTS) for side, root in roots.items()}
    trunk = tree.joints_between(feet.pelvis, chest)
    skull = _head(tree, outward, feet, chest, list(roots.values()))
    groups = {
        "left_leg": legs["left"],
        "right_leg": legs["right"],
        "chest": [j for j in trunk if tree.moves_about_one_axis(j)],
        "head": skull,
        "left_arm": arms["left"],
        "right_arm": arms["right"],
    }
    taken = {j for joints in groups.values() for j in joints}
    locked = [j for j in tree.joints if j not in taken]
    hands = {side: tree.link_of(joints[-1]) for side, joints in arms.items()}
    body = Body(feet.pelvis, chest, sides, hands, groups, locked, feet.height)
    return body, _evidence(tree, body, reach, set(feet.toes), coupled_joints(tree))


def coupled_joints(tree: Tree) -> set[int]:
    """Joints that a coupling of the model makes follow others."""
    model = tree.model
    kinds = model.eq_type == mujoco.mjtEq.mjEQ_JOINT
    return {int(j) for j in model.eq_obj1id[kinds]}


class _Outward:
    """The tree as it is seen from the pelvis: children lie farther from it."""

    def __init__(self, tree: Tree, feet: Feet) -> None:
        legs = {link for foot in feet.links for link in tree.way(feet.pelvis, foot)[1:]}
        legs |= {link for leg in legs for link in tree.subtree(leg)}
        self.children: dict[int, list[int]] = {}
        todo, seen = [feet.pelvis], {feet.pelvis, *legs}
        while todo:
            link = todo.pop()
            near = [*tree.children(link), *([tree.parent(link)] if link != tree.base else [])]
            self.children[link] = [other for other in near if other not in seen]
            seen.update(near)
            todo += self.children[link]

    def beyond(self, link: int) -> list[int]:
        """A link and all that lies farther out."""
        out = [link]
        for other in out:
            out += self.children[other]
        return out


def _shoulders(tree: Tree, outward: _Outward, feet: Feet) -> tuple[int, dict[str, int], float] | None:
    """The link with the two longest branches that mirror each other, the branches, and how far they reach [m]."""
    best: tuple[int, dict[str, int], float] | None = None
    for link, children in outward.children.items():
        branches = [b for b in children if tree.parent(b) == link]
        for left in branches:
            at = tree.axis(tree.joints_of(left)[0])[0]
            if at[1] < OFF_MIDDLE * feet.height:
                continue
            for right in branches:
                other = tree.axis(tree.joints_of(right)[0])[0]
                if right == left or np.linalg.norm(other - at * (1, -1, 1)) > MIRRORED * feet.height:
                    continue
                reach = _reach(tree, outward, left, at)
                if best is None or reach > best[2]:
                    best = link, {"left": left, "right": right}, reach
    return best


def _reach(tree: Tree, outward: _Outward, branch: int, start: Array) -> float:
    points = tree.surface(tree.touching(outward.beyond(branch)))
    ends = np.vstack([points, *(tree.data.xpos[link][None] for link in outward.beyond(branch))])
    return float(np.linalg.norm(ends - start, axis=1).max())


def _chain(tree: Tree, outward: _Outward, root: int, most: int) -> list[int]:
    """Joints from a link outwards until the way forks, a joint slides or follows another, or there are too many."""
    coupled, joints, link = coupled_joints(tree), list[int](), root
    while True:
        for joint in tree.joints_of(link):
            finger = any(word in tree.joint_name(joint).lower() for word in FINGERS)
            if len(joints) == most or joint in coupled or finger or not tree.moves_about_one_axis(joint):
                return joints
            joints.append(joint)
        if len(outward.children[link]) != 1:
            return joints
        link = outward.children[link][0]


def _head(tree: Tree, outward: _Outward, feet: Feet, chest: int, arms: Sequence[int]) -> list[int]:
    """Joints of the highest branch in the middle, without the eyes."""
    trunk = [chest, *tree.way(feet.pelvis, chest)]
    branches = [
        child
        for link in trunk
        for child in outward.children[link]
        if child not in arms and child not in trunk and tree.parent(child) == link
    ]
    middle = [b for b in branches if abs(tree.data.subtree_com[b][1]) < OFF_MIDDLE * feet.height]
    shoulders = np.mean([tree.axis(tree.joints_of(arm)[0])[0][2] for arm in arms])
    high = [b for b in middle if _top(tree, outward, b) > shoulders]
    if not high:
        return []
    head = max(high, key=lambda b: _top(tree, outward, b))
    joints = _chain(tree, outward, head, HEAD_JOINTS)
    return [j for j in joints if tree.mass(tree.link_of(j)) > LIGHT * tree.mass(head)]


def _top(tree: Tree, outward: _Outward, branch: int) -> float:
    points = tree.surface(tree.touching(outward.beyond(branch)))
    return float(points[:, 2].max()) if len(points) else float(tree.data.xpos[branch][2])


def _evidence(tree: Tree, body: Body, reach: float, toes: set[int], coupled: set[int]) -> list[Evidence]:
    groups, said = body.groups, []
    for pair, whole in (("leg", LEG_JOINTS), ("arm", 1)):
        left, right = (groups[f"{side}_{pair}"] for side in ("left", "right"))
        counts = f"{len(left)} and {len(right)} joints, left and right"
        fits = len(left) == len(right) >= whole
        if pair == "leg":
            why = f"the joints between {tree.name(body.pelvis)}, which carries both, and the feet"
        else:
            why = f"the longest branches that mirror each other, {reach:.2f} m, from {tree.name(body.chest)}"
        said.append(Evidence(f"{pair}s", counts, why, Sureness.SURE if fits else Sureness.UNSURE))
    chest, head = groups["chest"], groups["head"]
    between = f"the joints between {tree.name(body.pelvis)} and {tree.name(body.chest)}"
    said.append(Evidence("chest", _named(tree, chest), between, Sureness.SURE))
    why = "the highest branch in the middle of the trunk" if head else "no branch in the middle above the shoulders"
    said.append(Evidence("head", _named(tree, head), why, Sureness.SURE if head else Sureness.LIKELY))
    hands = {link for hand in body.hands.values() for link in tree.subtree(hand)}
    kinds: dict[str, list[int]] = {}
    for joint in body.locked:
        if joint in toes:
            kind = "beyond the feet"
        elif joint in coupled:
            kind = "coupled with others by the model"
        elif tree.link_of(joint) in hands:
            kind = "fingers, beyond the arms"
        elif not tree.moves_about_one_axis(joint):
            kind = "not hinges"
        else:
            kind = "part of nothing that was recognised"
        kinds.setdefault(kind, []).append(joint)
    for kind, joints in kinds.items():
        sureness = Sureness.UNSURE if kind.startswith("part of") else Sureness.LIKELY
        said.append(Evidence("locked", _named(tree, joints), kind, sureness))
    return said


def _named(tree: Tree, joints: Sequence[int]) -> str:
    return ", ".join(tree.joint_name(j) for j in joints) or "none"
