"""`sot report LIBRARY`: one page (HTML) of a library, which any browser shows, without a network."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from scenarios.library.batch import OPTIONS_FILE
from scenarios.library.job import CLIPS, OUTCOMES, UPRIGHT, Row
from scenarios.library.table import read_rows
from scenarios.library.throughput import throughput_words
from scenarios.replay import RECORDING_FILE, REPORT_FILE
from sim.reporting.report import TABLE_ROWS
from sot.errors import InputError
from sot.whole_file import atomic_write

TEMPLATE = "page.html"
BINS, BAR_WIDTH, BAR_HEIGHT = 24, 10, 60  # of a histogram, in pixels
WORST_CLIPS = 25
BADNESS = (
    ("tracking.mpjpe_mm", 1.0 / 50.0),
    ("likeness.segment_deg", 1.0 / 15.0),
    ("contacts.slip_max_m", 1.0 / 0.01),
    ("solver.fallback_ticks", 1.0),
)
"""Figures by which dances that ended upright are ordered from the worst, and how much of each weighs as much."""


@dataclass(frozen=True)
class Distribution:
    """A figure over the clips that were danced.

    Attributes:
        words, unit, aim: as in a run's report.
        quantiles: least, 5 %, median, 95 % and greatest, in words.
        bars: heights of its histogram [pixels].
    """

    words: str
    unit: str
    aim: str
    quantiles: tuple[str, ...]
    bars: tuple[float, ...]


@dataclass(frozen=True)
class ShownClip:
    """A clip in the table of the worst.

    Attributes:
        name, outcome, reason: of its row.
        links: words -> address of its recording and report, from the page.
        figures: in words, of those that it is ordered by.
    """

    name: str
    outcome: str
    reason: str
    links: dict[str, str]
    figures: tuple[str, ...]


def is_library(folder: Path) -> bool:
    """Whether a folder holds a library of `sot batch`."""
    return (folder / OPTIONS_FILE).is_file()


def write_library_page(library: Path, out: Path) -> None:
    """Write the page of a library, which appears under its name once it is complete.

    Raises:
        InputError: nothing of the library is done yet.
    """
    rows = read_rows(library)
    if not rows:
        raise InputError(f"{library}: none of its clips is done yet")
    environment = Environment(
        loader=PackageLoader("scenarios.library", "."), autoescape=True, undefined=StrictUndefined
    )
    counts = Counter(row["outcome"] for row in rows)
    page = environment.get_template(TEMPLATE).render(
        title=library.resolve().name,
        count=len(rows),
        seconds=sum(row["seconds"] or 0.0 for row in rows),
        throughput=throughput_words(rows),
        outcomes=[(outcome, counts[outcome], counts[outcome] / len(rows)) for outcome in OUTCOMES if counts[outcome]],
        robots=sorted({row["robot"] for row in rows}),
        revisions=sorted({row["versions"]["revision"] for row in rows}),
        remarks=Counter(_kind_of_remark(said) for row in rows for said in row["remarks"]).most_common(12),
        distributions=distributions(rows),
        heads=[_words(place) for place, _ in BADNESS],
        worst=[_shown(row, library, out.parent) for row in worst_rows(rows)[:WORST_CLIPS]],
        bar_width=BAR_WIDTH,
        bar_height=BAR_HEIGHT,
    )
    with atomic_write(out) as place:
        place.write_text(page, encoding="utf-8")


def distributions(rows: Sequence[Row]) -> list[Distribution]:
    """Those of all figures of a run's report that any clip has."""
    shown = []
    for place, words, factor, unit, aim in TABLE_ROWS:
        values = np.array([v for row in rows if (v := row["figures"].get(place)) is not None], dtype=float) * factor
        if not values.size:
            continue
        # Values that differ by rounding alone have no room for bins between them.
        low, high = values.min(), max(values.max(), values.min() + 1e-9 * max(abs(values).max(), 1.0))
        counts, _ = np.histogram(values, bins=BINS, range=(low, high))
        quantiles = tuple(_number(value) for value in np.quantile(values, (0.0, 0.05, 0.5, 0.95, 1.0)))
        bars = tuple((BAR_HEIGHT * counts / counts.max()).round(1).tolist())
        shown.append(Distribution(words, unit, aim, quantiles, bars))
    return shown


def worst_rows(rows: Sequence[Row]) -> list[Row]:
    """Rows from the worst: those that failed by kind of failure, fallen ones, then upright ones by `BADNESS`."""

    def order(row: Row) -> tuple[int, float, str]:
        if row["outcome"] != UPRIGHT:
            return -OUTCOMES.index(row["outcome"]), 0.0, row["clip"]
        badness = sum(weight * (row["figures"].get(place) or 0.0) for place, weight in BADNESS)
        return 1, -badness, row["clip"]

    return sorted(rows, key=order)


def _shown(row: Row, library: Path, page_folder: Path) -> ShownClip:
    folder = library / CLIPS / row["clip"]
    files = {"recording": folder / RECORDING_FILE, "report": folder / REPORT_FILE}
    links = {
        words: quote(path.resolve().relative_to(page_folder.resolve()).as_posix())
        for words, path in files.items()
        if path.is_file() and path.resolve().is_relative_to(page_folder.resolve())
    }
    values = [row["figures"].get(place) for place, _ in BADNESS]
    factors = [next(f for name, _, f, _, _ in TABLE_ROWS if name == place) for place, _ in BADNESS]
    told = tuple("-" if v is None else _number(f * v) for v, f in zip(values, factors, strict=True))
    return ShownClip(row["clip"], row["outcome"], row["reason"], links, told)


def _number(value: float) -> str:
    """Three digits, or all that stand before the point."""
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def _words(place: str) -> str:
    return next(f"{words} [{unit}]" if unit else words for name, words, _, unit, _ in TABLE_ROWS if name == place)


def _kind_of_remark(said: str) -> str:
    """A remark without its numbers, so that alike ones are counted together."""
    return " ".join("…" if any(c.isdigit() for c in word) else word for word in said.split())
