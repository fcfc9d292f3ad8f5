"""Pictures of curves: well-formed, whole, and broken where there is nothing to draw."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from sim.reporting.chart import FIELD_COLORS, Bar, Curve, Field, Lane, Panel, limit_lines, write_lanes, write_panels

SVG = "{http://www.w3.org/2000/svg}"


def drawn(tmp_path, *panels, columns=2):
    path = tmp_path / "curves.svg"
    write_panels(path, "some <curves>", panels, columns)
    assert [p.name for p in tmp_path.iterdir()] == ["curves.svg"]
    return ElementTree.parse(path).getroot()


def test_a_panel_holds_its_words_and_its_curves(tmp_path):
    t = np.linspace(0.0, 1.0, 5000)
    root = drawn(
        tmp_path, Panel("a & b", "s", "m", [Curve(t, np.sin(9 * t), "red", "wave"), *limit_lines([-0.5, 0.5], 1.0)])
    )
    words = [text.text for text in root.iter(f"{SVG}text")]
    assert {"some <curves>", "a & b", "s", "m", "wave", "limit"} <= set(words)
    lines = list(root.iter(f"{SVG}polyline"))
    assert len(lines) == 3
    assert len(lines[0].get("points").split()) < 2000


def test_all_of_a_curve_lies_within_its_axes(tmp_path):
    rng = np.random.default_rng(0)
    for scale in (1e-9, 1.0, 1e9):
        x, y = scale * rng.standard_normal((2, 50))
        for equal in (False, True):
            root = drawn(tmp_path, Panel("", "", "", [Curve(x, y, "red")], equal=equal))
            (line,) = root.iter(f"{SVG}polyline")
            points = np.array([[float(v) for v in point.split(",")] for point in line.get("points").split()])
            assert points[:, 0].min() >= 62.0 and points[:, 0].max() <= 366.0
            assert points[:, 1].min() >= 28.0 and points[:, 1].max() <= 176.0


def test_gaps_break_a_line_and_a_constant_is_drawn(tmp_path):
    y = np.array([1.0, 1.0, np.nan, 1.0, np.inf, 1.0])
    root = drawn(tmp_path, Panel("", "", "", [Curve(np.arange(6.0), y, "red")]))
    assert len(list(root.iter(f"{SVG}polyline"))) == 3
    root = drawn(tmp_path, Panel("", "", "", [Curve(np.arange(2.0), np.full(2, np.nan), "red")]))
    assert not list(root.iter(f"{SVG}polyline"))


def test_a_field_is_painted_in_shades_and_leaves_its_axes_nothing_uncovered(tmp_path):
    values = np.zeros((4, 6))
    values[2, 3:] = 5.0
    field = Field(np.arange(6.0), 1.0 + np.arange(4.0), values)
    root = drawn(tmp_path, Panel("power", "s", "Hz", [], field=field))
    low, high = root.iter(f"{SVG}path")
    assert (low.get("stroke"), high.get("stroke")) == (FIELD_COLORS[0], FIELD_COLORS[-1])
    runs = {path: [re.findall(r"[\d.]+", run) for run in path.get("d").split("M")[1:]] for path in (low, high)}
    assert len(runs[low]) == 4 and len(runs[high]) == 1
    (start, row, end), full = map(float, runs[high][0]), [float(value) for value in runs[low][0]]
    assert (start, end) == pytest.approx((0.5 * (full[0] + full[2]), full[2]), abs=1.0)
    assert row < full[1]  # a higher frequency lies further up
    assert full[2] - full[0] == pytest.approx(304.0, abs=1.0)  # all of the panel


def test_lanes_hold_their_bars_in_time(tmp_path):
    lanes = [Lane("hand & head", [Bar(1.0, 3.0, "blue", "2"), Bar(3.0, 4.0, "blue", "", 0.35)]), Lane("feet", [])]
    path = tmp_path / "lanes.svg"
    write_lanes(path, "tasks", "s", [*lanes, Lane("all", [Bar(0.0, 4.0, "grey")])])
    root = ElementTree.parse(path).getroot()
    bars = [bar for bar in root.iter(f"{SVG}rect") if bar.get("width") != "100%"]
    left, wide = ([float(bar.get(key)) for bar in bars] for key in ("x", "width"))
    np.testing.assert_allclose(wide[0] / wide[2], 0.5, atol=1e-3)
    np.testing.assert_allclose([left[0] - left[2], left[1] - left[2]], [wide[2] / 4.0, 3.0 * wide[2] / 4.0], atol=0.2)
    words = [text.text for text in root.iter(f"{SVG}text")]
    assert {"hand & head", "feet", "all", "2", "tasks", "s"} <= set(words)
