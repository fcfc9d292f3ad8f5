"""Which links are the feet, and what of them lies on the floor: found from the lowest geometry, not from names."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from sot.errors import InputError
from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.tree import Tree

Array = NDArray[np.float64]

SOLE_DEPTH = 0.001  # share of the robot's height: what is no higher than that above the lowest point is sole
FLAT_SHARE = 0.5  # least share of a foot's outline that its sole covers, if the foot stands flat
LEVEL = 0.01  # share of the height by which the two feet may differ
SOLE_CORNERS = (4, 6, 8)  # numbers of corners that are tried
SOLE_SHARE = 0.97  # share of the sole's area that its corners should keep


@dataclass(frozen=True)
class Feet:
    """The two feet.

    Attributes:
        links: numbers of the links, in no order.
        pelvis: the link from which both legs go.
        toes: joints beyond the feet.
        height: of the whole robot [m].
    """

    links: tuple[int, int]
    pelvis: int
    toes: tuple[int, ...]
    height: float


def find_feet(tree: Tree) -> tuple[Feet, Evidence]:
    """The two lowest leaves of the tree, or what carries them if it stands on the floor, too (a foot with toes).

    Raises:
        InputError: there are no two legs.
    """
    every = tree.surface(tree.touching(tree.links))
    if not len(every):
        raise InputError("the model has no geometry: feet and soles cannot be found")
    height = float(np.ptp(every[:, 2]))
    leaves = [link for link in tree.links if not tree.children(link) and link != tree.base]
    lowest = {link: _lowest(tree, link) for link in tree.links}
    leaves.sort(key=lambda link: lowest[link])
    first = leaves[0] if leaves else tree.base
    second = next((leaf for leaf in leaves[1:] if _is_other_leg(tree, first, leaf)), None)
    if second is None:
        raise InputError("no two legs: the model has no second branch beside that of its lowest link")
    feet = [_standing(tree, leaf, lowest, LEVEL * height) for leaf in (first, second)]
    pelvis = tree.common_ancestor(*feet)
    legs = {link for foot in feet for link in (*tree.subtree(foot), *tree.ancestry(foot))}
    toes = tuple(j for foot in feet for link in tree.subtree(foot) if link != foot for j in tree.joints_of(link))
    apart = abs(lowest[feet[0]] - lowest[feet[1]])
    rest = [lowest[leaf] for leaf in leaves if leaf not in legs]
    above = min(rest) - max(lowest[foot] for foot in feet) if rest else np.inf
    sure = apart < LEVEL * height and above > 10.0 * LEVEL * height
    why = f"the two lowest ends of the tree, {1e3 * apart:.1f} mm apart in height"
    if np.isfinite(above):
        why += f"; the next lowest end is {above:.2f} m higher"
    names = " and ".join(tree.name(foot) for foot in feet)
    return (
        Feet((feet[0], feet[1]), pelvis, toes, height),
        Evidence("feet", names, why, Sureness.SURE if sure else Sureness.UNSURE),
    )


def _lowest(tree: Tree, link: int) -> float:
    points = tree.surface(tree.touching([link]))
    return float(points[:, 2].min()) if len(points) else float(tree.data.xpos[link][2])


def _is_other_leg(tree: Tree, first: int, second: int) -> bool:
    """Whether two leaves part in the upper half of the first one's way to the base: toes of one foot part below."""
    top = tree.common_ancestor(first, second)
    return 2 * len(tree.joints_between(tree.base, top)) < len(tree.joints_between(tree.base, first))


def _standing(tree: Tree, leaf: int, lowest: dict[int, float], tolerance: float) -> int:
    """A leaf, or the link farthest up from it that is as low."""
    foot = leaf
    for link in tree.ancestry(leaf)[1:]:
        if lowest[link] > lowest[leaf] + tolerance or not tree.surface(tree.touching([link])).size:
            break
        foot = link
    return foot


def sole(tree: Tree, foot: int, height: float) -> tuple[Array, float]:
    """Corners (n, 3) of what lies on the floor, counterclockwise, and the share of the foot that it covers."""
    points = tree.surface(tree.touching([foot]))
    floor = float(points[:, 2].min())
    low = points[points[:, 2] < floor + SOLE_DEPTH * height]
    hull, whole = _hull(low[:, :2]), _hull(points[:, :2])
    corners = _fewer(hull)
    return np.column_stack([corners, np.full(len(corners), floor)]), _area(hull) / max(_area(whole), 1e-12)


def _hull(points: Array) -> Array:
    """Corners (n, 2) of the convex hull, counterclockwise; fewer than three where it has no area."""
    try:
        return points[ConvexHull(points).vertices]
    except (QhullError, ValueError):
        return points[:1]


def _area(corners: Array) -> float:
    x, y = corners.T
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) if len(corners) > 2 else 0.0


def _fewer(hull: Array) -> Array:
    """As few corners of a polygon as keep nearly all of its area; it always contains them."""
    for count in SOLE_CORNERS:
        if len(hull) <= count:
            return hull
        kept = _largest(hull, count)
        if _area(kept) >= SOLE_SHARE * _area(hull):
            break
    return kept


def _largest(hull: Array, count: int) -> Array:
    """The polygon of some corners of another that is left when the corner that costs least area goes, and again."""
    kept = list(range(len(hull)))
    while len(kept) > count:
        areas = [_area(hull[[k for k in kept if k != out]]) for out in kept]
        kept.pop(int(np.argmax(areas)))
    return hull[kept]
