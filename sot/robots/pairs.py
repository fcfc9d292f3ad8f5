"""The one list of pairs of shapes that may collide: in physics, in the controller and in plans."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pinocchio as pin

from sot.robots.reading.tree import Tree

LIMBS = ("left_arm", "right_arm", "left_leg", "right_leg")
BASE_JOINT = 1
TOUCHING_DISTANCE = 0.005
"""Pairs that are nearer at rest [m] are neighbours in the tree, or made to touch: they do not count."""


def geometry_of(tree: Tree, model: pin.Model) -> pin.GeometryModel:
    """All solids of a robot as shapes of its Pinocchio model, without pairs."""
    geometry = pin.GeometryModel()
    for link in tree.links:
        frame = model.frames[model.getFrameId(link.name, pin.FrameType.BODY)]
        for solid in link.solids:
            place = frame.placement * solid.placement
            geometry.addGeometryObject(pin.GeometryObject(solid.name, frame.parentJoint, place, solid.coal()))
    return geometry


def collision_pairs(
    tree: Tree, model: pin.Model, geometry: pin.GeometryModel, rest: np.ndarray, groups: Mapping[str, Sequence[int]]
) -> tuple[list[tuple[int, int]], np.ndarray]:
    """Pairs of shapes that may collide, and their distances at rest (n,) [m].

    A limb may collide with all that is not of it; legs not with the base, which they overlap by design: within a limb
    and at its root the joints' ranges are what keeps links apart. Left out are pairs that the model's file lets pass
    through each other, of a link and the one that carries it, and of what touches at rest.

    Args:
        tree, model, geometry: the robot and its shapes.
        rest: configuration (nq,).
        groups: joint group -> numbers of its joints.
    """
    solids = [solid for link in tree.links for solid in link.solids]
    links = {solid.name: tree.links[tree.owners[k]].name for k, link in enumerate(tree.links) for solid in link.solids}
    own_links = {solid.name: link.name for link in tree.links for solid in link.solids}
    parents = {link.name: tree.links[tree.owners[link.parent]].name for link in tree.links if link.parent >= 0}
    geometry = geometry.copy()
    for first, second in _limb_pairs(model, geometry, groups):
        a, b = solids[first], solids[second]
        meant = a.contype & b.conaffinity or b.contype & a.conaffinity
        excluded = frozenset((own_links[a.name], own_links[b.name])) in tree.excluded
        one, other = links[a.name], links[b.name]
        if meant and not excluded and parents.get(one) != other and parents.get(other) != one:
            geometry.addCollisionPair(pin.CollisionPair(first, second))
    results = geometry.createData()
    pin.computeDistances(model, model.createData(), geometry, results, rest)
    distances = np.array([result.min_distance for result in results.distanceResults])
    apart = np.flatnonzero(distances >= TOUCHING_DISTANCE).tolist()
    pairs = [(int(geometry.collisionPairs[k].first), int(geometry.collisionPairs[k].second)) for k in apart]
    return pairs, distances[apart]


def _limb_pairs(
    model: pin.Model, geometry: pin.GeometryModel, groups: Mapping[str, Sequence[int]]
) -> Iterator[tuple[int, int]]:
    """Indices of pairs of shapes that belong to different parts of the body, at least one of them to a limb."""
    limbs = {2 + joint: limb for limb in LIMBS for joint in groups[limb]}
    owners = [_part(model, limbs, shape.parentJoint) for shape in geometry.geometryObjects]
    for second, b in enumerate(owners):
        for first, a in enumerate(owners[:second]):
            if a != b and {a, b} & set(LIMBS) and not ("base" in (a, b) and {a, b} & {"left_leg", "right_leg"}):
                yield first, second


def _part(model: pin.Model, limbs: Mapping[int, str], joint: int) -> str:
    """The limb that a joint or one before it belongs to; else the base, or the trunk on it."""
    if joint <= BASE_JOINT:
        return "base"
    return next((limbs[k] for k in reversed(model.supports[joint].tolist()) if k in limbs), "trunk")


def remark_on_pairs(geometry: pin.GeometryModel, groups: Mapping[str, Sequence[int]], remarks: list[str]) -> None:
    """Say which limbs nothing keeps from the rest of the body, since no shape of theirs is to collide with it."""
    paired = {k for pair in geometry.collisionPairs for k in (pair.first, pair.second)}
    watched = {geometry.geometryObjects[k].parentJoint for k in paired}
    bare = [limb for limb in LIMBS if groups[limb] and not watched & {2 + joint for joint in groups[limb]}]
    if bare:
        limbs = ", ".join(limb.replace("_", " ") for limb in bare)
        remarks.append(f"no shape is to collide with the rest of the body, and nothing keeps from it: {limbs}")
