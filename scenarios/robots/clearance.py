"""Which parts of a robot are so near at rest that nobody watches them."""

from collections.abc import Iterator

import mujoco
import numpy as np

from scenarios.robots.findings import Finding, Severity
from sot.proximity import NEIGHBOUR_DISTANCE
from sot.robots.guess.tree import Tree
from sot.robots.robot import Robot

MANY = 6  # pairs that are named


def clearance_findings(robot: Robot, tree: Tree) -> Iterator[Finding]:
    """Parts of different limbs, or of a limb and the trunk beyond its root, that are nearer than what is watched.

    Args:
        robot: the robot.
        tree: of its physics, at rest.
    """
    part = {}
    for group in ("left_leg", "right_leg", "left_arm", "right_arm"):
        for k in robot.groups[group]:
            joint = mujoco.mj_name2id(tree.model, mujoco.mjtObj.mjOBJ_JOINT, robot.joints[k])
            part[tree.link_of(joint)] = group
    pairs = []
    for k, first in enumerate(tree.links):
        for second in tree.links[:k]:
            ways = part.get(first, "trunk"), part.get(second, "trunk")
            if ways[0] == ways[1] or len(tree.joints_between(first, second)) <= 3:
                continue
            apart = _distance(tree, first, second)
            if apart < NEIGHBOUR_DISTANCE:
                pairs.append((apart, f"{tree.name(second)} and {tree.name(first)} {1e3 * apart:.0f} mm"))
    if pairs:
        pairs.sort()
        named = ", ".join(words for _, words in pairs[:MANY]) + (
            f" and {len(pairs) - MANY} more" if pairs[MANY:] else ""
        )
        what = f"pairs are nearer than {1e3 * NEIGHBOUR_DISTANCE:.0f} mm at rest: nothing keeps them apart in the dance"
        remedy = "hold arms and legs farther apart in 'rest', unless they are made to touch"
        yield Finding(Severity.WARNS, what, named, remedy)


def _distance(tree: Tree, first: int, second: int) -> float:
    ends, apart = np.zeros(6), 1.0
    for a in tree.touching([first]):
        for b in tree.touching([second]):
            apart = min(apart, mujoco.mj_geomDistance(tree.model, tree.data, a, b, apart, ends))
    return apart
