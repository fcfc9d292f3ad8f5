"""What the links of a tree collide with: primitives as the file has them, and one solid about all meshes of a link."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from sot.robots.reading.solid import Mesh, Solid, fitted_solid
from sot.robots.reading.tree import Tree, unique_name

COINCIDENCE_DISTANCE = 1e-6  # m, joints this close turn about one point


def with_solids(tree: Tree, shapes: Mapping[int, Sequence[Solid | Mesh]]) -> Tree:
    """The tree with the solids that its links collide with.

    All meshes of links that move together become one solid. The meshes between joints that turn about one point, the
    housing of a hip or a shoulder, cannot help overlapping with the links on both sides and become none.

    Args:
        tree: the links without solids.
        shapes: link -> what the file has it collide with.
    """
    in_owner = _places_in_owners(tree)
    housings = _housings(tree)
    solids: dict[int, list[Solid]] = {k: [] for k in range(len(tree.links))}
    meshes: dict[int, list[Mesh]] = {}
    names: list[str] = []
    for k, parts in shapes.items():
        for part in parts:
            owner = tree.owners[k]
            if isinstance(part, Solid):
                names.append(unique_name(part.name or f"{tree.links[k].name}_{len(solids[k])}", names))
                solids[k].append(replace(part, name=names[-1]))
            elif owner not in housings:
                meshes.setdefault(owner, []).append(part.moved(in_owner[k]))
    for owner, parts_of_owner in meshes.items():
        names.append(unique_name(f"{tree.links[owner].name}_meshes", names))
        solids[owner].append(fitted_solid(names[-1], parts_of_owner))
    return tree.changed(lambda k, link: replace(link, solids=tuple(solids[k])))


def _places_in_owners(tree: Tree) -> list[pin.SE3]:
    """The place of each link in the link that it moves with."""
    places: list[pin.SE3] = []
    for k, link in enumerate(tree.links):
        places.append(pin.SE3.Identity() if tree.owners[k] == k else places[link.parent] * link.placement)
    return places


def _housings(tree: Tree) -> set[int]:
    """Links whose joint turns about a point of the joint of the next link."""
    housings = set()
    for link in tree.links:
        parent = tree.owners[link.parent] if link.parent >= 0 else 0
        before = tree.links[parent]
        if link.joints and before.joints and link.parent == parent:
            anchor = link.placement.act(link.joints[0].anchor)
            if np.linalg.norm(anchor - before.joints[-1].anchor) < COINCIDENCE_DISTANCE:
                housings.add(parent)
    return housings
