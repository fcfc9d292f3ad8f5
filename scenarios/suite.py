"""A table of dances: many clips danced under physics, one row of figures each, and a summary."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean, median
from typing import Any

from rich.console import Console
from rich.table import Table

from scenarios.inputs import clips
from scenarios.replay import ProgressCallback, Replay, dance, write_outputs
from sim.reporting.report import figure_at
from sot.errors import InputError

MAX_SUCCESS_MPJPE_MM = 100.0  # mean error of key bodies above which a dance counts as failed
PIECE_DURATION_S = 20.0  # length of the pieces into which the long clip is cut
LONG_CLIP, LEAPING_CLIP = "lafan1_dance1_subject2", "cmu_01_01"
SUITES = ("dance",)

# Figures of a row: place in the report, head, factor to the unit shown, digits after the point.
TABLE_FIGURES: tuple[tuple[str, str, float, int], ...] = (
    ("speed", "speed", 1.0, 2),
    ("zmp.inside", "zmp in %", 100.0, 1),
    ("contacts.slip_max_m", "slip mm", 1e3, 1),
    ("contacts.sole_tilt_max_deg", "tilt deg", 1.0, 1),
    ("tracking.mpjpe_mm", "mpjpe mm", 1.0, 1),
    ("likeness.segment_deg", "segm deg", 1.0, 1),
    ("likeness.hand_path_ratio", "hands", 1.0, 2),
    ("limits.self_collision_min_m", "self mm", 1e3, 1),
    ("contacts.switches", "switches", 1.0, 0),
    ("solver.infeasible_ticks", "infeas", 1.0, 0),
    ("solver.fallback_ticks", "fallb", 1.0, 0),
    ("real_time_factor", "RTF", 1.0, 2),
    ("planning_ratio", "plan s/s", 1.0, 2),
)


@dataclass(frozen=True)
class Piece:
    """A clip, or a part of one, under the name of its row."""

    name: str
    clip: str
    start: float = 0.0
    duration: float | None = None


def suite_pieces(mocap: Path | None) -> list[Piece]:
    """Pieces of the suite "dance": the clips (.bvh, .amc) of a folder, the long named dance in pieces, and leaps, which
    no robot here can do.

    Raises:
        InputError: no such folder, or no clip in it.
    """
    found: list[Piece] = []
    if mocap is not None:
        found = [Piece(path.stem, str(path)) for path in sorted([*mocap.glob("*.bvh"), *mocap.glob("*.amc")])]
        if not found:
            raise InputError(f"{mocap}: no clips (.bvh, .amc) there")
    seconds = next(clip.seconds for clip in clips.named_clips() if clip.name == LONG_CLIP)
    starts = [
        k * PIECE_DURATION_S
        for k in range(int(seconds // PIECE_DURATION_S) + 1)
        if seconds - k * PIECE_DURATION_S > 0.5 * PIECE_DURATION_S
    ]
    long = [
        Piece(f"{LONG_CLIP} {start:.0f} s", LONG_CLIP, start, min(PIECE_DURATION_S, seconds - start))
        for start in starts
    ]
    return [*found, *long, Piece(LEAPING_CLIP, LEAPING_CLIP)]


def bench_suite(request: Replay, pieces: Sequence[Piece], out: Path | None, tell: ProgressCallback) -> dict[str, Any]:
    """Dance all pieces.

    Args:
        request: what holds for all of them.
        pieces: the clips.
        out: folder that keeps a recording and a report a piece; nothing is kept unless given.
        tell: told the piece and what is being done with it.

    Returns:
        "rows", one a piece: "name", "success", "ending" in words, and `TABLE_FIGURES`, None where there are none;
        "summary": how many succeeded, and over those that could be danced the mean speed and the medians of the other
        figures.
    """
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for piece in pieces:
            said = f"{piece.name}: "
            own = replace(request, clip=piece.clip, start=piece.start, duration=piece.duration)

            def told(what: str, share: float | None, said: str = said) -> None:
                tell(said + what, share)

            rows.append(
                {"name": piece.name} | _figures_row(own, (out or Path(folder)) / piece.name.replace(" ", "_"), told)
            )
    return {"rows": rows, "summary": _summary(rows)}


def show(table: Mapping[str, Any], console: Console) -> None:
    """Print the rows and the summary."""
    shown = Table(box=None, padding=(0, 1, 0, 0))
    shown.add_column("clip", no_wrap=True)
    shown.add_column("")
    for _, head, _, _ in TABLE_FIGURES:
        shown.add_column(head, justify="right")
    summary = {"name": "", "ending": f"{table['summary']['successes']} of {table['summary']['clips']}"}
    for row in (*table["rows"], summary | table["summary"]):
        values = ((row.get(place), factor, digits) for place, _, factor, digits in TABLE_FIGURES)
        cells = ("-" if value is None else f"{factor * value:.{digits}f}" for value, factor, digits in values)
        shown.add_row(row["name"], row["ending"], *cells)
    console.print(shown)


def _figures_row(request: Replay, folder: Path, tell: ProgressCallback) -> dict[str, Any]:
    nothing: dict[str, Any] = dict.fromkeys(place for place, *_ in TABLE_FIGURES)
    try:
        danced = dance(request, tell)
    except InputError as refusal:
        return {"success": False, "ending": f"refused: {refusal}"} | nothing
    report = write_outputs(danced, folder, tell)
    row = nothing | {place: figure_at(report, place) for place, *_ in TABLE_FIGURES if place != "planning_ratio"}
    row["speed"] = report["speed"] * (1.0 - report["stretched_s"] / report["duration_s"])
    if danced.plan is not None:
        row["planning_ratio"] = danced.plan.seconds["total"] / danced.motion.duration
    off = report["tracking"]["mpjpe_mm"]
    success = not report["fell"] and off is not None and off <= MAX_SUCCESS_MPJPE_MM
    ending = "upright" if not report["fell"] else f"fell at {report['fell_at_s']:.1f} s"
    return {"success": success, "ending": ending} | row


def _summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    summary: dict[str, Any] = {"clips": len(rows), "successes": sum(row["success"] for row in rows)}
    for place, *_ in TABLE_FIGURES:
        values = [row[place] for row in rows if row[place] is not None]
        summary[place] = (fmean if place == "speed" else median)(values) if values else None
    return summary
