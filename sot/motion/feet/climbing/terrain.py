"""Surfaces of a scene that a robot may step on, and the footholds of a human who climbs laid onto them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.feet.climbing.tread import check_tread
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import Foothold, Step
from sot.polygon import Polygon
from sot.robots.surface import FLOOR, Surface

Array = NDArray[np.float64]

EDGE_MARGIN = 0.01  # leg lengths, from a sole to the edges of what it stands on, and to what is higher beside it
HEIGHT_PRICE = 10.0  # of a rise that differs from the human's, over that of a way that does
MAX_RISE_ERROR = 0.5  # of a human's rise, by which the scene's may differ
MIN_RISE_LEGS = 0.06  # leg lengths: less is level
MAX_PUSHES = 4  # times that a sole is moved onto its surface and out of what is higher
ROUNDING = 1e-9  # m


@dataclass(frozen=True)
class MissingRise:
    """A step up or down of a human that the scene has no surface for.

    Attributes:
        time: when the step lands [s].
        rise: of the step, in the robot's size [m].
    """

    time: float
    rise: float


@dataclass(frozen=True)
class _Candidate:
    """A foothold, what it cost to come there, the candidate before it, by number, and whether the rise is missing."""

    foothold: Foothold
    cost: float = 0.0
    before: int = 0
    missing: bool = False


class Terrain:
    """The floor and surfaces of the world above it, level or sloping.

    Args:
        surfaces: above the floor.
        reach: of the robot that steps on them.

    Raises:
        InputError: a surface moves, is too steep or has no edges.
    """

    def __init__(self, surfaces: Sequence[Surface], reach: LegReach) -> None:
        for surface in surfaces:
            check_tread(surface)
            if not len(surface.corners):
                raise InputError(f"{surface.name} is no tread: it has no edges")
        self._outlines = {surface: Polygon.hull(surface.corners_at_point[:, :2]) for surface in surfaces}
        self._reach, self._margin = reach, EDGE_MARGIN * reach.leg_length

    def laid(
        self, stands: Mapping[str, Sequence[Foothold]], steps: Sequence[Step], levels: Mapping[str, Sequence[float]]
    ) -> tuple[dict[str, list[Foothold]], list[MissingRise]]:
        """Footholds of the level floor on these surfaces, and the rises that there is no surface for.

        Each foothold is as far from the one that landed before it as it is on the level floor, as nearly as soles that
        stand wholly on their surfaces can be, and as much higher as the surfaces are. Of all ways over the surfaces
        it is the one with the least squares (dynamic programming over footholds, a surface each). Where there is no
        surface as high as the human's within reach, the foot stays at the height of the one that landed before it.

        Args:
            stands: foot -> footholds before, between and after its steps; the first ones are on the floor.
            steps: in order of time.
            levels: foot -> height of what the human's foot stands on at each of its footholds, in the robot's size [m].
        """
        found, missing = {foot: [own[0]] for foot, own in stands.items()}, list[MissingRise]()
        if not steps:
            return found, missing
        last, level = stands[steps[0].foot][0], levels[steps[0].foot][0]
        now, rows, rises = dict.fromkeys(stands, 0), [[_Candidate(last)]], []
        for step in steps:
            now[step.foot] += 1
            wanted, height = stands[step.foot][now[step.foot]], levels[step.foot][now[step.foot]]
            way = np.array([wanted.x - last.x, wanted.y - last.y])
            rises.append(height - level)
            rows.append(self._candidates(step.foot, wanted.heading, rows[-1], way, rises[-1]))
            last, level = wanted, height
        for step, one, rise in zip(steps, _cheapest(rows), rises, strict=True):
            passed = self._highest_between(step.foot, found[step.foot][-1], one.foothold)
            found[step.foot].append(replace(one.foothold, passed=passed))
            if one.missing:
                missing.append(MissingRise(step.land, rise))
        return found, missing

    def _candidates(
        self, foot: str, heading: float, before: Sequence[_Candidate], way: Array, rise: float
    ) -> list[_Candidate]:
        """For each surface that has room for a sole, its best foothold after one of those before it."""
        found = []
        tolerance = max(MAX_RISE_ERROR * abs(rise), MIN_RISE_LEGS * self._reach.leg_length)
        for surface in (FLOOR, *self._outlines):
            reached = []
            for index, one in enumerate(before):
                wanted = np.array([one.foothold.x, one.foothold.y]) + way
                place = self._place_on(surface, foot, heading, wanted)
                if place is None:
                    continue
                up = float(surface.height_at(place)) - one.foothold.height
                far = float(np.hypot(place[0] - one.foothold.x, place[1] - one.foothold.y))
                missing = abs(up - rise) > tolerance
                if abs(up) > ROUNDING and (missing or far > max(self._reach.max_stride, float(np.hypot(*way)))):
                    continue
                cost = one.cost + float(np.sum((place - wanted) ** 2)) + (HEIGHT_PRICE * (up - rise)) ** 2
                foothold = Foothold(float(place[0]), float(place[1]), heading, surface)
                reached.append(_Candidate(foothold, cost, index, missing))
            if reached:
                found.append(min(reached, key=lambda one: one.cost))
        return found

    def _place_on(self, surface: Surface, foot: str, heading: float, wanted: Array) -> Array | None:
        """Where the ankle is near a wanted place (2,) with the sole wholly on a surface and off all higher ones; None
        where that has no room."""
        sole = self._turned_sole(foot, heading, surface)
        inner, place = None, wanted
        if surface in self._outlines:
            inner = _shrunk(self._outlines[surface], sole, self._margin)
            if not len(inner.vertices):
                return None
        higher = [one for other, one in self._outlines.items() if _rises_above(other, surface)]
        for _ in range(MAX_PUSHES):
            before = place
            if inner is not None and inner.margin(place) < -ROUNDING:
                place = inner.nearest_point(place)
            for outline in higher:
                place = _pushed_out(outline, sole, place, self._margin)
            if place is before:
                return place
        return None

    def _highest_between(self, foot: str, here: Foothold, there: Foothold) -> float:
        """Height of the highest surface that a sole comes over from one foothold to another [m]."""
        swept = np.vstack(
            [np.add(self._turned_sole(foot, one.heading, one.surface), (one.x, one.y)) for one in (here, there)]
        )
        heights = [
            min(float(one.height_at(swept).max()), float(one.corners_at_point[:, 2].max()))
            for one, outline in self._outlines.items()
            if _gap(outline, swept) < 0.0
        ]
        return max(heights, default=0.0)

    def _turned_sole(self, foot: str, heading: float, surface: Surface) -> Array:
        """Corners of a sole (n, 2), seen from above, about the point below the ankle, at a heading [rad]."""
        cosine, sine = np.cos(heading), np.sin(heading)
        corners: Array = self._reach.soles[foot] @ np.array([[cosine, sine], [-sine, cosine]])
        return corners @ pin.exp3(surface.tilt)[:2, :2].T if surface.tilt.any() else corners


def _rises_above(other: Surface, surface: Surface) -> bool:
    """Whether a surface has a corner above the plane of another one."""
    corners = other.corners_at_point
    return bool((corners[:, 2] > surface.height_at(corners[:, :2]) + ROUNDING).any())


def _cheapest(rows: Sequence[Sequence[_Candidate]]) -> list[_Candidate]:
    """The candidates of the way that costs least, without the first."""
    index, chosen = min(range(len(rows[-1])), key=lambda k: rows[-1][k].cost), list[_Candidate]()
    for row in reversed(rows[1:]):
        chosen.append(row[index])
        index = row[index].before
    return chosen[::-1]


def _shrunk(outline: Polygon, sole: Array, margin: float) -> Polygon:
    """Where the origin of a sole (n, 2) may be for all of it to be within an outline, a margin from its edges [m]."""
    return replace(outline, offsets=outline.offsets - margin - (sole @ outline.normals.T).max(axis=0))


def _pushed_out(outline: Polygon, sole: Array, place: Array, margin: float) -> Array:
    """A place (2,) of a sole (n, 2), moved by the least over an edge of an outline that the sole is over or near."""
    if _gap(outline, sole + place) > margin - ROUNDING:
        return place
    beyond = outline.normals @ place + (sole @ outline.normals.T).min(axis=0) - outline.offsets
    nearest = int(beyond.argmax())
    moved: Array = place + (margin - beyond[nearest]) * outline.normals[nearest]
    return moved


def _gap(outline: Polygon, points: Array) -> float:
    """How far the convex hull of points (n, 2) is beyond an outline, along an edge of either; negative if they meet."""
    hull = Polygon.hull(points)
    beyond = (points @ outline.normals.T).min(axis=0) - outline.offsets
    aside = (outline.vertices @ hull.normals.T).min(axis=0) - hull.offsets
    return float(max(beyond.max(), aside.max()))
