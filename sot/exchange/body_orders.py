"""The orders in which simulators number a robot's bodies and joints: files that carry no names depend on them."""

import numpy as np
from numpy.typing import NDArray

from sot.robots.robot import Robot

Indices = NDArray[np.intp]


def breadth_first_links(robot: Robot) -> Indices:
    """Indices (B,) of the links level by level from the base, as Isaac Lab (PhysX) numbers them.

    MuJoCo numbers them depth first, which is the order of `Robot.tree`.
    """
    links = robot.tree.links
    depth = np.zeros(len(links), dtype=int)
    for k, link in enumerate(links):
        depth[k] = 0 if link.parent < 0 else depth[link.parent] + 1
    place = np.zeros(len(links), dtype=int)
    order: list[int] = []
    for level in range(depth.max(initial=0) + 1):
        members = np.flatnonzero(depth == level).tolist()
        members.sort(key=lambda k: (place[links[k].parent] if links[k].parent >= 0 else 0, k))
        for k in members:
            place[k] = len(order)
            order.append(k)
    return np.array(order, dtype=np.intp)


def breadth_first_joints(robot: Robot) -> Indices:
    """Indices (na,) into `Robot.joints` of the joints level by level from the base, as Isaac Lab numbers them."""
    numbers = {name: k for k, name in enumerate(robot.joints)}
    links = robot.tree.links
    names = [hinge.name for k in breadth_first_links(robot) for hinge in links[k].joints]
    return np.array([numbers[name] for name in names], dtype=np.intp)
