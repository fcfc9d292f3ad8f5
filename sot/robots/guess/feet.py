"""Which links are the feet, and what of them lies on the floor: found from the lowest geometry, not from names."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from sot.errors import InputError
from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.posed_model import PosedModel
from sot.robots.soles import FLATNESS_TOLERANCE

Array = NDArray[np.float64]

FLAT_SHARE = 0.5  # least share of a foot's outline that its sole covers, if the foot stands flat
MAX_FEET_HEIGHT_DIFFERENCE = 0.01  # share of the height by which the two feet may differ
SOLE_CORNERS = 6  # that a sole has at most
SOLE_SHARE = 0.97  # share of the sole's area that four of its corners keep at least, to be taken for it
RECTANGLE_SHARE = 0.85  # share of the sole's area that a rectangle keeps at least, to be taken for it
RECTANGLE_LEVELS = 41  # at which its sides are tried


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


def find_feet(posed: PosedModel) -> tuple[Feet, Evidence]:
    """The two lowest leaves of the tree, or what carries them if it stands on the floor, too (a foot with toes).

    Raises:
        InputError: there are no two legs.
    """
    every = posed.surface(posed.touching(posed.links))
    if not len(every):
        raise InputError("the model has no geometry: feet and soles cannot be found")
    height = float(np.ptp(every[:, 2]))
    leaves = [link for link in posed.links if not posed.children(link) and link != posed.base]
    lowest = {link: _lowest(posed, link) for link in posed.links}
    leaves.sort(key=lambda link: lowest[link])
    first = leaves[0] if leaves else posed.base
    second = next((leaf for leaf in leaves[1:] if _is_other_leg(posed, first, leaf)), None)
    if second is None:
        raise InputError("no two legs: the model has no second branch beside that of its lowest link")
    feet = [_standing(posed, leaf, lowest, MAX_FEET_HEIGHT_DIFFERENCE * height) for leaf in (first, second)]
    pelvis = posed.common_ancestor(*feet)
    legs = {link for foot in feet for link in (*posed.subtree(foot), *posed.ancestry(foot))}
    toes = tuple(j for foot in feet for link in posed.subtree(foot) if link != foot for j in posed.joints_of(link))
    apart = abs(lowest[feet[0]] - lowest[feet[1]])
    rest = [lowest[leaf] for leaf in leaves if leaf not in legs]
    above = min(rest) - max(lowest[foot] for foot in feet) if rest else np.inf
    sure = apart < MAX_FEET_HEIGHT_DIFFERENCE * height and above > 10.0 * MAX_FEET_HEIGHT_DIFFERENCE * height
    why = f"the two lowest ends of the tree, {1e3 * apart:.1f} mm apart in height"
    if np.isfinite(above):
        why += f"; the next lowest end is {above:.2f} m higher"
    names = " and ".join(posed.name(foot) for foot in feet)
    return (
        Feet((feet[0], feet[1]), pelvis, toes, height),
        Evidence("feet", names, why, Sureness.SURE if sure else Sureness.UNSURE),
    )


def _lowest(posed: PosedModel, link: int) -> float:
    points = posed.surface(posed.touching([link]))
    return float(points[:, 2].min()) if len(points) else float(posed.data.xpos[link][2])


def _is_other_leg(posed: PosedModel, first: int, second: int) -> bool:
    """Whether two leaves part in the upper half of the first one's way to the base: toes of one foot part below."""
    top = posed.common_ancestor(first, second)
    return 2 * len(posed.joints_between(posed.base, top)) < len(posed.joints_between(posed.base, first))


def _standing(posed: PosedModel, leaf: int, lowest: dict[int, float], tolerance: float) -> int:
    """A leaf, or the link farthest up from it that is as low."""
    foot = leaf
    for link in posed.ancestry(leaf)[1:]:
        if lowest[link] > lowest[leaf] + tolerance or not posed.surface(posed.touching([link])).size:
            break
        foot = link
    return foot


def sole(posed: PosedModel, foot: int) -> tuple[Array, float]:
    """Corners (n, 3) of what lies on the floor, counterclockwise, and the share of the foot that it covers."""
    points = posed.underside(posed.touching([foot]))
    floor = float(points[:, 2].min())
    low = points[points[:, 2] < floor + FLATNESS_TOLERANCE]
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
    """Few corners inside a polygon that keep nearly all of its area: four of its own, of a rectangle, or some more."""
    four, rectangle = _without_least(hull, 4), _rectangle(hull)
    if _area(four) >= SOLE_SHARE * _area(hull):
        return four
    if _area(rectangle) >= RECTANGLE_SHARE * _area(hull):
        return rectangle
    return _without_least(hull, SOLE_CORNERS)


def _without_least(hull: Array, count: int) -> Array:
    """Some corners of a polygon: without the one that costs least area, and again; both of a pair that is mirrored."""
    kept = hull
    while len(kept) > count:
        partners = _mirrored_corners(kept)
        pairs = [[k, partners[k]] if partners[k] != k else [k] for k in range(len(kept))]
        smaller = [np.delete(kept, pair, axis=0) for pair in pairs if len(kept) - len(pair) >= count]
        if not smaller:
            break
        kept = max(smaller, key=_area)
    return kept


def _mirrored_corners(corners: Array) -> list[int]:
    """The corner that mirrors each one about the middle of the foot's width; itself where there is none."""
    middle = 0.5 * (corners[:, 1].min() + corners[:, 1].max())
    other = corners * (1.0, -1.0) + (0.0, 2.0 * middle)
    apart = np.linalg.norm(other[:, None] - corners[None], axis=2)
    nearest = apart.argmin(axis=1)
    return [int(b) if apart[a, b] < FLATNESS_TOLERANCE else a for a, b in enumerate(nearest)]


def _rectangle(hull: Array) -> Array:
    """Corners (4, 2) of the largest rectangle along the axes inside a polygon, counterclockwise."""
    if len(hull) < 3:
        return hull
    levels = np.linspace(hull[:, 1].min(), hull[:, 1].max(), RECTANGLE_LEVELS)
    ends = np.array([_chord(hull, level) for level in levels])
    best, corners = -1.0, hull[:0]
    for a, low in enumerate(levels):
        for b in range(a + 1, len(levels)):
            back, front = max(ends[a, 0], ends[b, 0]), min(ends[a, 1], ends[b, 1])
            if (front - back) * (levels[b] - low) > best and front > back:
                best = (front - back) * (levels[b] - low)
                corners = np.array([(back, low), (front, low), (front, levels[b]), (back, levels[b])])
    return corners


def _chord(hull: Array, level: float) -> tuple[float, float]:
    """Where a polygon begins and ends along x at a level of y."""
    crossings = []
    for (x1, y1), (x2, y2) in zip(hull, np.roll(hull, -1, axis=0), strict=True):
        low, high = sorted((y1, y2))
        if low <= level <= high:
            crossings += [x1, x2] if high == low else [x1 + (x2 - x1) * (level - y1) / (y2 - y1)]
    return (min(crossings), max(crossings)) if crossings else (0.0, 0.0)
