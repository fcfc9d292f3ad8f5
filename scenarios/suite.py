"""A table of dances: each clip danced under physics, a row of figures each, and what they come to."""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean, median
from typing import Any

from rich.console import Console
from rich.table import Table

from scenarios.inputs import clips
from scenarios.replay import Dance, ProgressCallback, Replay, dance, write_outputs
from sim.reporting.report import figure_at
from sot.errors import InputError
from sot.exchange.registry import readable_format
from sot.motion.plan import Plan

MAX_SUCCESS_MPJPE_MM = 100.0  # a dance whose key bodies are farther off, on average, is no success
MAX_SUCCESS_SEGMENT_DEG = 20.0  # a dance whose segments are farther off the human's, on average, is no success
PIECE_DURATION_S = 20.0  # length of the pieces that a long named clip is danced in
LONG_CLIP, LEAPING_CLIP = "lafan1_dance1_subject2", "cmu_01_01"
UPRIGHT = "upright"

Columns = tuple[tuple[str, str, float, int], ...]
"""Figures of a row: place in the report, head, factor to the unit shown, digits after the point."""

TABLE_FIGURES: Columns = (
    ("speed", "speed", 1.0, 2),
    ("zmp.inside", "zmp in %", 100.0, 1),
    ("contacts.slip_max_m", "slip mm", 1e3, 1),
    ("contacts.sole_tilt_max_deg", "tilt deg", 1.0, 1),
    ("tracking.mpjpe_mm", "mpjpe mm", 1.0, 1),
    ("likeness.segment_deg", "segm deg", 1.0, 1),
    ("likeness.leg_segment_deg", "legs deg", 1.0, 1),
    ("likeness.knee_bend_deg", "knee deg", 1.0, 1),
    ("likeness.foot_lift_ratio", "lift", 1.0, 2),
    ("likeness.heading_deg", "head deg", 1.0, 1),
    ("likeness.hand_path_ratio", "hands", 1.0, 2),
    ("contacts.torque_step_max_nm", "step Nm", 1.0, 1),
    ("limits.self_collision_min_m", "self mm", 1e3, 1),
    ("contacts.switches", "switches", 1.0, 0),
    ("solver.infeasible_ticks", "infeas", 1.0, 0),
    ("solver.fallback_ticks", "fallb", 1.0, 0),
    ("real_time_factor", "RTF", 1.0, 2),
    ("planning_ratio", "plan s/s", 1.0, 2),
)
ESTIMATOR_FIGURES: Columns = (
    ("estimator.way_m", "way m", 1.0, 2),
    ("estimator.position_end_m", "base off mm", 1e3, 1),
    ("estimator.tilt_rms_deg", "tilt off deg", 1.0, 2),
)
"""Further figures of dances on an estimated state."""


@dataclass(frozen=True)
class Piece:
    """A clip, or a part of one, under the name of its row; robot and feet are the request's unless given."""

    name: str
    clip: str
    start: float = 0.0
    duration: float | None = None
    robot: str | None = None
    feet: str | None = None
    from_format: str | None = None

    def request(self, common: Replay) -> Replay:
        """What is to be danced, given what holds for all pieces."""
        return replace(
            common,
            clip=self.clip,
            start=self.start,
            duration=self.duration,
            robot=self.robot or common.robot,
            feet=self.feet or common.feet,
            from_format=self.from_format,
            fps=common.fps if self.from_format else None,
        )

    def part(self, start: float, duration: float) -> "Piece":
        """A part of it, from a time on and no longer than that [s]."""
        return replace(self, start=start, duration=duration)


def folder_pieces(folder: Path, from_format: str | None = None) -> list[Piece]:
    """The clips of a folder by name: humans' (.bvh, .amc), or a robot's motions in a format.

    Raises:
        InputError: no such folder or format, or no clip in it.
    """
    endings = (".bvh", ".amc") if from_format is None else (readable_format(from_format).ending,)
    paths = sorted(path for path in folder.glob("*") if path.suffix.lower() in endings)
    if not paths:
        raise InputError(f"{folder}: no clips ({', '.join(endings)}) there")
    return [Piece(path.stem, str(path), from_format=from_format) for path in paths]


def suite_pieces(mocap: Path | None, from_format: str | None = None) -> list[Piece]:
    """What the suite "dance" is made of: the clips of a folder, the long named dance in pieces, and leaps, which no
    robot here can do and a planner has to make something of.

    Raises:
        InputError: no such folder or format, or no clip in it.
    """
    found = [] if mocap is None else folder_pieces(mocap, from_format)
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


def columns_of(request: Replay) -> Columns:
    """The figures of a row that fit what is asked for."""
    return TABLE_FIGURES if request.state == "true" else (*TABLE_FIGURES, *ESTIMATOR_FIGURES)


@dataclass(frozen=True)
class SuccessRule:
    """What makes a success of a dance that ended upright: in words, and whether its row meets it."""

    words: str
    is_met: Callable[[Mapping[str, Any]], bool]


def _looks_like_its_human(row: Mapping[str, Any]) -> bool:
    off, unlike = row["tracking.mpjpe_mm"], row["likeness.segment_deg"]
    near = off is not None and off <= MAX_SUCCESS_MPJPE_MM
    return near and (unlike is None or unlike <= MAX_SUCCESS_SEGMENT_DEG)


LIKE_ITS_HUMAN = SuccessRule(
    f"upright, key bodies within {MAX_SUCCESS_MPJPE_MM:.0f} mm of their reference, segments within"
    f" {MAX_SUCCESS_SEGMENT_DEG:.0f} deg of the human's, on average",
    _looks_like_its_human,
)


def usual_average(place: str, rows: Sequence[Mapping[str, Any]]) -> float | None:
    """Over the clips that could be danced, the mean speed and the medians of other figures."""
    values = [row[place] for row in rows if row[place] is not None]
    return (fmean if place == "speed" else median)(values) if values else None


@dataclass(frozen=True)
class Suite:
    """A table of dances.

    Attributes:
        pieces: the clips, given a folder of more of them and the format of robots' motions in it.
        columns: the figures of a row that fit what holds for all pieces.
        success: what makes one.
        more: entries of a row that no report has, from what was asked for, the dance and its report.
        average: what all rows come to in a column.
        robot: who dances; the user's choice unless given.
        as_danced: whether nothing may be slowed down and no way be shortened.
    """

    pieces: Callable[[Path | None, str | None], list[Piece]]
    columns: Callable[[Replay], Columns] = columns_of
    success: SuccessRule = LIKE_ITS_HUMAN
    more: Callable[[Replay, Dance, Mapping[str, Any]], Mapping[str, Any]] = lambda request, danced, report: {}
    average: Callable[[str, Sequence[Mapping[str, Any]]], float | None] = usual_average
    robot: str | None = None
    as_danced: bool = False


DANCES = Suite(suite_pieces)


def bench_suite(
    request: Replay, pieces: Sequence[Piece], out: Path | None, tell: ProgressCallback, suite: Suite = DANCES
) -> dict[str, Any]:
    """Dance all pieces.

    Args:
        request: what holds for all of them.
        pieces: the clips.
        out: folder that keeps a recording and a report a piece; nothing is kept unless given.
        tell: told the piece and what is being done with it.
        suite: what a row is of.

    Returns:
        "rows", one a piece: "name", "success", "ending" in words, and the columns, None where there are none;
        "rule": what a success is; "summary": how many succeeded, and the columns' averages.
    """
    columns = suite.columns(request)
    nothing: dict[str, Any] = dict.fromkeys(place for place, *_ in columns)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for piece in pieces:
            said = f"{piece.name}: "

            def told(what: str, share: float | None, said: str = said) -> None:
                tell(said + what, share)

            own, place = piece.request(request), (out or Path(folder)) / piece.name.replace(" ", "_")
            row = {"name": piece.name} | nothing | _figures_row(own, place, told, columns, suite)
            rows.append(row | {"success": row["ending"] == UPRIGHT and suite.success.is_met(row)})
    summary = {"clips": len(rows), "successes": sum(row["success"] for row in rows)}
    summary |= {place: suite.average(place, rows) for place, *_ in columns}
    return {"rows": rows, "rule": suite.success.words, "summary": summary}


def show(
    table: Mapping[str, Any], console: Console, columns: Columns = TABLE_FIGURES, words: Sequence[str] = ()
) -> None:
    """Print the rows, and what they come to; `words` are entries of a row that are no figures."""
    shown = Table(box=None, padding=(0, 1, 0, 0))
    shown.add_column("clip", no_wrap=True)
    shown.add_column("")
    for _, head, _, _ in columns:
        shown.add_column(head, justify="right")
    for head in words:
        shown.add_column(head)
    summary = {"name": "", "ending": f"{table['summary']['successes']} of {table['summary']['clips']}"}
    for row in (*table["rows"], summary | table["summary"]):
        values = ((row.get(place), factor, digits) for place, _, factor, digits in columns)
        cells = ("-" if value is None else f"{factor * value:.{digits}f}" for value, factor, digits in values)
        shown.add_row(row["name"], row["ending"], *cells, *(str(row.get(head) or "") for head in words))
    console.print(shown)
    console.print(f"A success: {table['rule']}.", highlight=False)


def _figures_row(
    request: Replay,
    folder: Path,
    tell: ProgressCallback,
    columns: Columns,
    suite: Suite,
) -> dict[str, Any]:
    try:
        danced = dance(request, tell)
    except InputError as refusal:
        return {"ending": f"refused: {refusal}"}
    report = write_outputs(danced, folder, tell)
    row: dict[str, Any] = {"ending": UPRIGHT if not report["fell"] else f"fell at {report['fell_at_s']:.1f} s"}
    row |= suite.more(request, danced, report)
    ended = not report["fell"]
    row["speed"] = report["speed"] * (1.0 - report["stretched_s"] / report["duration_s"]) if ended else None
    if isinstance(danced.plan, Plan):
        row["planning_ratio"] = danced.plan.seconds["total"] / danced.motion.duration
    return row | {place: figure_at(report, place) for place, *_ in columns if place not in (*row, "planning_ratio")}
