"""A guessed robot at rest as a picture (SVG): shapes, axes, points and soles, from front, side and above."""

from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from sot.robots.guess import Guess
from sot.whole_file import atomic_write

Array = NDArray[np.float64]

HIGH, WIDE = 760.0, 620.0  # of the views from the front and the side [px]
SOLES_WIDE = 420.0  # of the view from above [px]
EDGE, HEAD = 30.0, 60.0  # around a view, and above all of them [px]
LABEL_GAP = 10.0  # between the robot and the labels [px]
LABELS = 105.0  # kept free at either side for labels [px]
LINE = 15.0  # least height between labels [px]
AXIS = 0.045  # half the length of a drawn axis, share of the robot's height
COLOURS = {
    "left_leg": "#1f77b4",
    "right_leg": "#17becf",
    "chest": "#9467bd",
    "head": "#8c564b",
    "left_arm": "#2ca02c",
    "right_arm": "#bcbd22",
    "locked": "#999999",
}
FONT = "font-family='Helvetica, Arial, sans-serif'"


@dataclass(frozen=True)
class View:
    """A projection of the world: which directions are right and up on the page, and where the page's origin is."""

    title: str
    right: Array
    up: Array
    scale: float
    origin: Array

    def __call__(self, points: Array) -> Array:
        """Places on the page (n, 2) [px] of points (n, 3) [m]."""
        return self.origin + self.scale * np.column_stack([points @ self.right, -(points @ self.up)])

    @property
    def towards(self) -> Array:
        """Direction to who looks."""
        return np.cross(self.right, self.up)


def draw(found: Guess, path: Path) -> None:
    """Draw a robot at rest into a file (`.svg`), which appears under its name once it is complete.

    Raises:
        OSError: the file cannot be written.
    """
    x, y, z = np.eye(3)
    posed = found.posed
    outline = posed.surface([*posed.touching(posed.links), *posed.seen(posed.links)])
    low, high = outline.min(axis=0), outline.max(axis=0)
    middle = 0.5 * (low + high)
    scale = min(HIGH / (high[2] - low[2]), (WIDE - 2 * LABELS) / max(high[0] - low[0], high[1] - low[1]))
    bottom = HEAD + EDGE + HIGH
    places = found.points_at_rest()
    soles = found.soles_at_rest()

    def view(title: str, right: Array, left: float) -> View:
        centre = np.array([left + 0.5 * WIDE - scale * middle @ right, bottom + scale * low[2]])
        return View(title, right, z, scale, centre)

    front = view("from the front: its left is on the right", y, 0.0)
    side = view("from its right: it looks to the right", x, WIDE)
    corners = np.vstack([*soles.values(), [places["left_ankle"], places["right_ankle"]]])
    size, centre = np.ptp(corners, axis=0), 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    zoom = min((SOLES_WIDE - 2 * EDGE) / size[1], 0.6 * HIGH / size[0])
    at = np.array([2 * WIDE + 0.5 * SOLES_WIDE + zoom * centre[1], HEAD + EDGE + 0.35 * HIGH + zoom * centre[0]])
    above = View("soles, from above", -y, x, zoom, at)
    parts = [_text(EDGE, 24.0, f"{found.path.name} at rest, as guessed", 16)]
    for each in (front, side):
        widest = float(np.abs(outline @ each.right - middle @ each.right).max())
        parts += [*_shapes(found, each), *_soles(soles, each), *_axes(found, each)]
        parts += _points(places, each, float(each(middle[None])[0, 0]), scale * widest + LABEL_GAP)
    parts += _from_above(found, places, soles, above)
    parts += _legend(2 * WIDE + EDGE, HEAD + 0.75 * HIGH)
    width, height = 2 * WIDE + SOLES_WIDE, bottom + EDGE
    text = (
        f"<svg xmlns='http://www.w3.org/2000/svg' width='{width:.0f}' height='{height:.0f}' "
        f"viewBox='0 0 {width:.0f} {height:.0f}'>\n<rect width='100%' height='100%' fill='white'/>\n"
        + "\n".join(parts)
        + "\n</svg>\n"
    )
    with atomic_write(path) as place:
        place.write_text(text, encoding="utf-8")


def _shapes(found: Guess, view: View) -> Iterator[str]:
    """What is seen in grey, nearer shapes over farther ones, and outlines of what can touch."""
    posed = found.posed
    left = view(np.zeros((1, 3)))[0]
    yield _text(left[0] - 150.0, HEAD - 8.0, view.title, 12)
    seen = posed.seen(posed.links)
    seen.sort(key=lambda g: float(posed.data.geom_xpos[g] @ view.towards))
    for geom in seen:
        yield _hull(view(posed.surface([geom])), "fill='#dfe3e8' stroke='#aab' stroke-width='0.6' fill-opacity='0.75'")
    for link in posed.links:
        for geom in posed.touching([link]):
            yield _hull(view(posed.surface([geom])), "fill='none' stroke='#e8833a' stroke-width='0.8'")


def _soles(soles: dict[str, Array], view: View) -> Iterator[str]:
    for corners in soles.values():
        yield _polygon(view(corners), "fill='#d62728' fill-opacity='0.4' stroke='#d62728' stroke-width='2'")


def _axes(found: Guess, view: View) -> Iterator[str]:
    posed, body = found.posed, found.body
    half = AXIS * body.height
    for group, joints in (*body.groups.items(), ("locked", body.locked)):
        for joint in joints:
            at, way = posed.axis(joint)
            ends = view(np.array([at - half * way, at + half * way]))
            yield (
                f"<line x1='{ends[0, 0]:.1f}' y1='{ends[0, 1]:.1f}' x2='{ends[1, 0]:.1f}' y2='{ends[1, 1]:.1f}' "
                f"stroke='{COLOURS[group]}' stroke-width='2.2'><title>{escape(posed.joint_name(joint))}</title></line>"
                f"<circle cx='{ends[1, 0]:.1f}' cy='{ends[1, 1]:.1f}' r='2.4' fill='{COLOURS[group]}'/>"
            )


def _points(places: dict[str, Array], view: View, middle: float, spread: float) -> Iterator[str]:
    """Points, each with a line to its name in a column that is `spread` to the left or the right of the middle [px]."""
    on_page = {name: view(at[None])[0] for name, at in places.items()}
    columns: dict[int, list[tuple[float, str]]] = {-1: [], 1: []}
    for name, at in on_page.items():
        is_right = name.startswith("left_") if abs(view.right[1]) > 0.5 else not name.startswith("right_")
        if abs(view.right[1]) > 0.5 and not name.startswith(("left_", "right_")):
            is_right = True
        columns[1 if is_right else -1].append((float(at[1]), name))
    for side, labels in columns.items():
        column, level = middle + side * spread, -np.inf
        for y, name in sorted(labels):
            level = max(level + LINE, y)
            at = on_page[name]
            yield (
                f"<line x1='{at[0]:.1f}' y1='{at[1]:.1f}' x2='{column:.1f}' y2='{level:.1f}' stroke='#888' "
                f"stroke-width='0.6'/><circle cx='{at[0]:.1f}' cy='{at[1]:.1f}' r='3.2' fill='black'/>"
            )
            yield _text(column + side * 3.0, level + 3.5, name, 11, "start" if side > 0 else "end")


def _from_above(found: Guess, places: dict[str, Array], soles: dict[str, Array], view: View) -> Iterator[str]:
    yield _text(2 * WIDE + EDGE, HEAD - 8.0, view.title, 12)
    posed = found.posed
    for side, foot in found.body.feet.items():
        for geom in posed.touching([foot]):
            yield _hull(view(posed.surface([geom])), "fill='none' stroke='#e8833a' stroke-width='1'")
        yield from _soles({side: soles[side]}, view)
        for name in (f"{side}_foot", f"{side}_toe", f"{side}_ankle"):
            at = view(places[name][None])[0]
            yield f"<circle cx='{at[0]:.1f}' cy='{at[1]:.1f}' r='3.2' fill='black'/>"
            if not name.endswith("ankle"):
                yield _text(at[0] + 6.0, at[1] + 4.0, name, 11)
    com = posed.data.subtree_com[posed.base]
    at = view(com[None])[0]
    yield f"<path d='M{at[0] - 7:.1f} {at[1]:.1f}h14m-7 -7v14' stroke='#d62728' stroke-width='2' fill='none'/>"
    yield _text(at[0] + 9.0, at[1] + 4.0, "centre of mass", 11)


def _legend(left: float, top: float) -> Iterator[str]:
    rows = [*((colour, f"axes of {group}") for group, colour in COLOURS.items())]
    rows += [("#d62728", "soles"), ("#e8833a", "what can touch"), ("#aab", "what is seen")]
    for k, (colour, words) in enumerate(rows):
        y = top + 16.0 * k
        yield f"<rect x='{left:.1f}' y='{y - 8.0:.1f}' width='18' height='6' fill='{colour}'/>"
        yield _text(left + 24.0, y, words, 11)


def _hull(points: Array, style: str) -> str:
    if len(points) < 3:
        return ""
    try:
        return _polygon(points[ConvexHull(points).vertices], style)
    except QhullError:
        return _polygon(points, style)


def _polygon(points: Array, style: str) -> str:
    return f"<polygon points='{' '.join(f'{x:.1f},{y:.1f}' for x, y in points.tolist())}' {style}/>"


def _text(x: float, y: float, words: str, size: int, anchor: str = "start") -> str:
    return f"<text x='{x:.1f}' y='{y:.1f}' {FONT} font-size='{size}' text-anchor='{anchor}'>{escape(words)}</text>"
