"""Soles: where their corners are, what a foot touches the floor with, and whether the two agree."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin
from scipy.spatial import ConvexHull, QhullError

from sot.robots.reading.solid import Solid
from sot.robots.reading.tree import Tree
from sot.robots.robot_file import FEET, RobotFile

Array = np.ndarray

FLATNESS_TOLERANCE = 1e-3
"""Height [m] by which corners of the soles may differ at rest, and a sole from what touches the floor."""
BOX_HEIGHT_RATIO = 0.1
"""Height of the box over a sole, of the sole's length."""


def own_solids(tree: Tree, link: int) -> list[tuple[int, Solid]]:
    """The solids that move with a link, each with the link that it is given in."""
    return [(k, solid) for k, owner in enumerate(tree.owners) if owner == link for solid in tree.links[k].solids]


def heights_over_shapes(
    tree: Tree, links: Mapping[str, int], places: Sequence[pin.SE3], corners: Mapping[str, Array], remarks: list[str]
) -> dict[str, float]:
    """Height of each sole above the lowest of its foot's shapes at rest [m]; 0 within the tolerance or without shapes.

    Args:
        tree: the robot.
        links: foot -> the link that it moves with.
        places: of all links at rest, in the world.
        corners: foot -> its sole's corners at rest, in the world (n, 3) [m].
        remarks: a sole that has to be moved, or that reaches beyond what touches the floor, is added to these.
    """
    heights = dict.fromkeys(FEET, 0.0)
    for foot in FEET:
        lowest = [_lowest(solid, places[k]) for k, solid in own_solids(tree, links[foot])]
        if not lowest:
            remarks.append(f"{foot} has no shape that collides: it touches the floor with a box over its sole")
            continue
        points = np.vstack(lowest)
        bottom = points[:, 2].min()
        above = float(corners[foot][:, 2].min() - bottom)
        if abs(above) > FLATNESS_TOLERANCE:
            side = "above" if above > 0 else "below"
            remarks.append(
                f"the sole of {foot} is {_mm(abs(above))} {side} the lowest of its shapes: it is moved there"
            )
            heights[foot] = above
        touching = points[points[:, 2] <= bottom + FLATNESS_TOLERANCE][:, :2]
        beyond = max(_outside(corner, touching) for corner in corners[foot][:, :2])
        if beyond > FLATNESS_TOLERANCE:
            remarks.append(f"the sole of {foot} reaches {_mm(beyond)} beyond what its shapes touch the floor with")
    return heights


def refuse_uneven(file: RobotFile, corners: Mapping[str, Array]) -> None:
    """Check that the soles are flat at rest and on one height.

    Args:
        file: of the robot.
        corners: foot -> its sole's corners at rest, in the world (n, 3) [m].

    Raises:
        InputError: a corner is higher than another by more than a millimetre.
    """
    for foot in FEET:
        if np.ptp(corners[foot][:, 2]) > FLATNESS_TOLERANCE:
            raise file.error(
                f"'soles.{foot}' is not flat: at rest its corners differ by {_mm(np.ptp(corners[foot][:, 2]))}"
            )
    apart = corners["left_foot"][:, 2].min() - corners["right_foot"][:, 2].min()
    if abs(apart) > FLATNESS_TOLERANCE:
        higher = FEET[0] if apart > 0 else FEET[1]
        raise file.error(
            f"at rest {higher} is {_mm(abs(apart))} above the other foot: both soles are to stand on the floor"
        )


def with_soles(tree: Tree, links: Mapping[str, int], places: Sequence[pin.SE3], corners: Mapping[str, Array]) -> Tree:
    """The tree in which what feet touch the floor with are boxes: the model's own, or else one over each sole.

    Args:
        tree: the robot.
        links: foot -> the link that it moves with.
        places: of all links at rest, in the world, whose axes are also the foot's.
        corners: foot -> its sole's corners at rest, in the world (n, 3) [m].
    """
    boxes: dict[int, list[Solid]] = {}
    dropped: set[str] = set()
    for foot in FEET:
        link, corner = links[foot], corners[foot]
        own = own_solids(tree, link)
        floor = corner[:, 2].min()
        length = float(np.ptp(corner[:, 0]))
        low = {solid.name: _lowest(solid, places[k]) for k, solid in own}
        bottom = min((points[:, 2].min() for points in low.values()), default=floor)
        touching = [s for _, s in own if low[s.name][:, 2].min() <= bottom + FLATNESS_TOLERANCE]
        if touching and all(solid.kind == "box" for solid in touching):
            continue
        height = BOX_HEIGHT_RATIO * length
        dropped |= {s.name for _, s in own if s.meshes is not None}
        dropped |= {s.name for _, s in own if low[s.name][:, 2].min() < floor + height}
        boxes[link] = [_box_over(f"{tree.links[link].name}_sole", corner, height, places[link])]
    return tree.changed(
        lambda k, link: replace(
            link, solids=(*(solid for solid in link.solids if solid.name not in dropped), *boxes.get(k, ()))
        )
    )


def _lowest(solid: Solid, place: pin.SE3) -> Array:
    """Points of a solid that may touch the floor, in the world (n, 3)."""
    return solid.lowest_points(place.rotation[2]) @ place.rotation.T + place.translation


def _box_over(name: str, corners: Array, height: float, place: pin.SE3) -> Solid:
    low, high = corners.min(axis=0), corners.max(axis=0)
    high[2] = low[2] + height
    return Solid(name, "box", (high - low) / 2, place.actInv(pin.SE3(np.eye(3), (low + high) / 2)))


def _outside(point: Array, others: Array) -> float:
    """How far a point of the plane is outside the convex hull of others [m]."""
    try:
        planes = ConvexHull(others).equations
    except (QhullError, ValueError):
        return float(np.linalg.norm(others - point, axis=1).min())
    return float((planes[:, :2] @ point + planes[:, 2]).max())


def _mm(length: float) -> str:
    return f"{1e3 * length:.1f} mm"


def front(corners: Array) -> Array:
    """Flags (nc,) of a sole's corners (nc, 3), x ahead, that are in its front half."""
    flags: Array = corners[:, 0] > 0.5 * (corners[:, 0].min() + corners[:, 0].max())
    return flags
