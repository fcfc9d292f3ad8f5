"""Curves and bars as a picture (SVG) that any browser shows: panels in a grid, each with its axes and a legend."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from pathlib import Path

import numpy as np

from sot.whole_file import atomic_write

Array = np.ndarray

PANEL_WIDTH_PX, PANEL_HEIGHT_PX = 380.0, 210.0  # of a panel, in pixels
MARGIN_LEFT_PX, MARGIN_RIGHT_PX, MARGIN_TOP_PX, MARGIN_BOTTOM_PX = 62.0, 14.0, 28.0, 34.0  # around its axes
TITLE_HEIGHT_PX = 34.0  # above all panels, for the title
LANES_WIDTH_PX, LANE_HEIGHT_PX = 1000.0, 22.0  # of a picture of lanes, and of each lane
CURVE_SAMPLES = 1500  # of a curve, more than there are pixels
TICKS_PER_AXIS = 5
FIELD_COLORS = (
    "#fffbe6",
    "#fee9b0",
    "#fdcf7d",
    "#fbae56",
    "#f58a41",
    "#e6653a",
    "#cc4440",
    "#a62a4a",
    "#7a1a4c",
    "#4a1040",
)
LETTER_WIDTH_PX = 5.0  # pixels that a letter of a legend takes
FONT = "font-family='Helvetica, Arial, sans-serif'"


@dataclass(frozen=True)
class Curve:
    """A line through points, broken where they are not finite.

    Args:
        x, y: Shapes (k,).
        color: Any that CSS knows.
        label: For the legend; none if empty.
        dashed: Rather than solid.
        width: In pixels.
    """

    x: Array
    y: Array
    color: str
    label: str = ""
    dashed: bool = False
    width: float = 1.4


@dataclass(frozen=True)
class Field:
    """Values over both axes as colours, from the first of `FIELD_COLORS` for 0 to the last for the greatest.

    Args:
        x, y: Shapes (k,) and (r,), evenly spaced.
        values: Shape (r, k), none below 0.
    """

    x: Array
    y: Array
    values: Array


@dataclass(frozen=True)
class Panel:
    """Curves over the same axes.

    Args:
        title: Above them.
        x, y: What the axes are, with unit.
        curves: Later ones lie above earlier ones.
        equal: Whether both axes have the same scale.
        field: Behind the curves.
    """

    title: str
    x: str
    y: str
    curves: Sequence[Curve]
    equal: bool = False
    field: Field | None = None


@dataclass(frozen=True)
class Bar:
    """Something that lasts from `start` to `end`; its label is shown where there is room."""

    start: float
    end: float
    color: str
    label: str = ""
    opacity: float = 1.0


@dataclass(frozen=True)
class Lane:
    """Bars in a row with a name."""

    name: str
    bars: Sequence[Bar]


def limit_lines(values: Sequence[float], end: float, label: str = "limit") -> list[Curve]:
    """Dashed level lines from 0 to `end`, under one label."""
    x = np.array([0.0, end])
    return [
        Curve(x, np.full(2, value), "#c33", "" if k else label, dashed=True, width=1.0)
        for k, value in enumerate(values)
    ]


def write_panels(
    path: Path,
    title: str,
    panels: Sequence[Panel],
    columns: int,
    size: tuple[float, float] = (PANEL_WIDTH_PX, PANEL_HEIGHT_PX),
) -> None:
    """Draw panels of a size [pixels] row by row into a file (`.svg`), which appears under its name once it is
    complete."""
    width, height = size
    rows = math.ceil(len(panels) / columns)
    drawn = []
    for k, panel in enumerate(panels):
        drawn.append(
            f"<g transform='translate({k % columns * width:.0f} {TITLE_HEIGHT_PX + k // columns * height:.0f})'>"
        )
        drawn += [*_panel_svg(panel, width, height), "</g>"]
    _save_svg(path, title, drawn, columns * width, TITLE_HEIGHT_PX + rows * height)


def write_lanes(path: Path, title: str, x: str, lanes: Sequence[Lane]) -> None:
    """Draw lanes of bars below each other over one axis, `x` with its unit, into a file, as `write_panels` does."""
    high = LANE_HEIGHT_PX * len(lanes)
    low = min((bar.start for lane in lanes for bar in lane.bars), default=0.0)
    end = max((bar.end for lane in lanes for bar in lane.bars), default=1.0)
    left = LETTER_WIDTH_PX * max(len(lane.name) for lane in lanes) + 24.0
    scale = (LANES_WIDTH_PX - left - MARGIN_RIGHT_PX) / (end - low)
    parts = [f"<g transform='translate(0 {TITLE_HEIGHT_PX:.0f})'>"]
    for value in _round_values_between(low, end):
        at = left + (value - low) * scale
        parts.append(_line_svg(at, 0.0, at, high) + _text_svg(at, high + 14.0, f"{value:g}", 10, "middle"))
    parts.append(_text_svg(LANES_WIDTH_PX - MARGIN_RIGHT_PX, high + 28.0, x, 10, "end"))
    for k, lane in enumerate(lanes):
        middle = LANE_HEIGHT_PX * (k + 0.5)
        parts.append(_text_svg(left - 8.0, middle + 3.5, lane.name, 10, "end"))
        for bar in lane.bars:
            at, wide = left + (bar.start - low) * scale, (bar.end - bar.start) * scale
            parts.append(
                f"<rect x='{at:.1f}' y='{middle - 0.35 * LANE_HEIGHT_PX:.1f}' width='{wide:.1f}' "
                f"height='{0.7 * LANE_HEIGHT_PX:.1f}' fill='{bar.color}' fill-opacity='{bar.opacity:g}'/>"
            )
            if wide > 1.5 * LETTER_WIDTH_PX * len(bar.label) and bar.label:
                parts.append(_text_svg(at + 0.5 * wide, middle + 3.5, bar.label, 9, "middle"))
    _save_svg(path, title, [*parts, "</g>"], LANES_WIDTH_PX, TITLE_HEIGHT_PX + high + MARGIN_BOTTOM_PX)


def _save_svg(path: Path, title: str, drawn: Sequence[str], width: float, height: float) -> None:
    parts = [
        f"<svg xmlns='http://www.w3.org/2000/svg' width='{width:.0f}' height='{height:.0f}' "
        f"viewBox='0 0 {width:.0f} {height:.0f}'>",
        "<rect width='100%' height='100%' fill='white'/>",
        _text_svg(width / 2.0, 22.0, title, 15, "middle"),
    ]
    parts += drawn
    parts.append("</svg>\n")
    with atomic_write(path) as place:
        place.write_text("\n".join(parts), encoding="utf-8")


def _panel_svg(panel: Panel, width: float, height: float) -> list[str]:
    wide, high = width - MARGIN_LEFT_PX - MARGIN_RIGHT_PX, height - MARGIN_TOP_PX - MARGIN_BOTTOM_PX
    (x0, x1), (y0, y1) = (
        _cell_edges(getattr(panel.field, axis))
        if panel.field
        else _padded_range([getattr(curve, axis) for curve in panel.curves])
        for axis in "xy"
    )
    if panel.equal:
        scale = max((x1 - x0) / wide, (y1 - y0) / high)
        x0, x1 = _centred_range(x0, x1, scale * wide)
        y0, y1 = _centred_range(y0, y1, scale * high)

    def right(x: Array) -> Array:
        return MARGIN_LEFT_PX + (x - x0) / (x1 - x0) * wide

    def down(y: Array) -> Array:
        return MARGIN_TOP_PX + (y1 - y) / (y1 - y0) * high

    parts = [
        _text_svg(MARGIN_LEFT_PX, MARGIN_TOP_PX - 9.0, panel.title, 12),
        _text_svg(MARGIN_LEFT_PX + wide, height - 4.0, panel.x, 10, "end"),
    ]
    parts.append(
        _text_svg(0.0, 0.0, panel.y, 10, "middle", f"translate(12 {MARGIN_TOP_PX + high / 2.0:.0f}) rotate(-90)")
    )
    for value in _round_values_between(x0, x1):
        at = float(right(np.array(value)))
        parts.append(
            _line_svg(at, MARGIN_TOP_PX, at, MARGIN_TOP_PX + high)
            + _text_svg(at, MARGIN_TOP_PX + high + 13.0, f"{value:g}", 10, "middle")
        )
    for value in _round_values_between(y0, y1):
        at = float(down(np.array(value)))
        parts.append(
            _line_svg(MARGIN_LEFT_PX, at, MARGIN_LEFT_PX + wide, at)
            + _text_svg(MARGIN_LEFT_PX - 5.0, at + 3.5, f"{value:g}", 10, "end")
        )
    if panel.field:
        parts += _field_svg(panel.field, right, down)
    at = MARGIN_LEFT_PX + wide
    for curve in reversed(panel.curves):
        style = _stroke_style(curve)
        if curve.label:  # beside the title, from the right
            at -= LETTER_WIDTH_PX * len(curve.label) + 22.0
            y = MARGIN_TOP_PX - 12.5
            parts.append(f"<line {style} x1='{at:.1f}' y1='{y}' x2='{at + 18.0:.1f}' y2='{y}'/>")
            parts.append(_text_svg(at + 21.0, MARGIN_TOP_PX - 9.0, curve.label, 10, "start"))
            at -= 8.0
    for curve in panel.curves:
        style = _stroke_style(curve)
        parts += [
            f"<polyline {style} points='{points}'/>" for points in _polyline_points(right(curve.x), down(curve.y))
        ]
    return parts


def _field_svg(field: Field, right: Callable[[Array], Array], down: Callable[[Array], Array]) -> list[str]:
    """SVG of a field: one path per colour, in which each run of that colour in a row is a thick line."""
    shade = np.minimum(field.values / (field.values.max() or 1.0) * len(FIELD_COLORS), len(FIELD_COLORS) - 1).astype(
        int
    )
    edges = right(np.linspace(*_cell_edges(field.x), len(field.x) + 1))
    rows, thick = down(field.y), abs(float(np.diff(down(np.array(_cell_edges(field.y))))[0])) / len(field.y) + 0.3
    paths: list[list[str]] = [[] for _ in FIELD_COLORS]
    for k, row in enumerate(shade):
        ends = [0, *(np.flatnonzero(np.diff(row)) + 1).tolist(), len(row)]
        for start, end in pairwise(ends):
            paths[row[start]].append(f"M{edges[start]:.0f} {rows[k]:.1f}H{edges[end]:.0f}")
    return [
        f"<path d='{''.join(path)}' stroke='{color}' stroke-width='{thick:.1f}'/>"
        for color, path in zip(FIELD_COLORS, paths, strict=True)
        if path
    ]


def _cell_edges(values: Array) -> tuple[float, float]:
    """Outer edges of the first and the last of evenly spaced cells."""
    half = 0.5 * float(values[1] - values[0])
    return float(values[0]) - half, float(values[-1]) + half


def _stroke_style(curve: Curve) -> str:
    dashes = " stroke-dasharray='5 3'" if curve.dashed else ""
    return f"fill='none' stroke='{curve.color}' stroke-width='{curve.width:g}'{dashes}"


def _padded_range(values: Sequence[Array]) -> tuple[float, float]:
    """Least and greatest of all finite values, with a margin."""
    finite = np.concatenate([value[np.isfinite(value)] for value in values])
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    room = 0.06 * (high - low) or 0.5 * abs(high) or 1.0
    return low - room, high + room


def _centred_range(low: float, high: float, size: float) -> tuple[float, float]:
    middle = 0.5 * (low + high)
    return middle - 0.5 * size, middle + 0.5 * size


def _round_values_between(low: float, high: float) -> list[float]:
    """Round values between two limits, for the ticks of an axis."""
    step = 10.0 ** math.floor(math.log10((high - low) / TICKS_PER_AXIS))
    step *= next(factor for factor in (1.0, 2.0, 5.0, 10.0) if (high - low) / (factor * step) <= TICKS_PER_AXIS)
    return [round(k * step, 12) for k in range(math.ceil(low / step), math.floor(high / step) + 1)]


def _polyline_points(x: Array, y: Array) -> list[str]:
    """The points of each finite run of a line, as SVG's polylines take them."""
    every = max(1, len(x) // CURVE_SAMPLES)
    keep = np.unique(np.append(np.arange(0, len(x), every), len(x) - 1)) if len(x) else np.zeros(0, dtype=int)
    x, y = x[keep], y[keep]
    broken = np.flatnonzero(~(np.isfinite(x) & np.isfinite(y)))
    runs = np.split(np.column_stack([x, y]), np.unique(np.concatenate([broken, broken + 1])))
    return [
        " ".join(f"{a:.1f},{b:.1f}" for a, b in run.tolist()) for run in runs if len(run) and np.isfinite(run).all()
    ]


def _text_svg(x: float, y: float, words: str, size: int, anchor: str = "start", transform: str = "") -> str:
    placed = f"transform='{transform}'" if transform else f"x='{x:.1f}' y='{y:.1f}'"
    return f"<text {placed} {FONT} font-size='{size}' text-anchor='{anchor}'>{escape(words)}</text>"


def _line_svg(x1: float, y1: float, x2: float, y2: float) -> str:
    return f"<line x1='{x1:.1f}' y1='{y1:.1f}' x2='{x2:.1f}' y2='{y2:.1f}' stroke='#e4e4e4' stroke-width='1'/>"
