"""How a robot walks with people: clips sent as live streams over a socket, a row of figures each.

    python benchmarks/live_steps.py [--mocap FOLDER] [--delay 0.5 0] [--seconds 20] [--only NAME ...] [--rate 500]
    python benchmarks/live_steps.py --faults
    python benchmarks/live_steps.py --pushes 8
    python benchmarks/live_steps.py --loop 600

Clips are those of the suite "dance", lafan1_aiming in pieces, and the walks of this project. `--faults` plays the walk
with stops ten times for each fault of the stream that a planted robot bears; `--pushes` pushes the chest twenty times
while it steps, once a run; `--loop` plays LAFAN1's dance and aiming one after the other for so many seconds. The time
of a stream is the simulation's, so that load changes nothing.
"""

import argparse
import random
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from scenarios.inputs import clips
from scenarios.inputs.disturbances import spaced_pushes
from scenarios.live.paced_stream import Fault, PacedStream
from scenarios.live.session import LiveRequest, follow
from scenarios.live.streaming import part_of, performance
from scenarios.suite import LONG_CLIP, PIECE_DURATION_S, UPRIGHT, Columns, Piece, suite_pieces, usual_average
from scenarios.suite import show as show_suite
from sim.reporting.report import figure_at
from sot.live.frame import Frame
from sot.motion import read
from sot.motion.human.capture import Capture
from sot.robots.robot import Robot

FRAME_RATE_HZ = 50.0
AIMING_CLIP = "lafan1_aiming"
WALKS = ("walk_turns", "walk_stops")
COLUMNS: Columns = (
    ("zmp.inside", "zmp in %", 100.0, 1),
    ("steps.made", "made", 1.0, 0),
    ("steps.footfalls", "asked", 1.0, 0),
    ("steps.path_ratio", "way", 1.0, 2),
    ("likeness.leg_segment_deg", "legs deg", 1.0, 1),
    ("likeness.heading_deg", "head deg", 1.0, 1),
    ("likeness.upper_segment_deg", "upper deg", 1.0, 1),
    ("contacts.torque_step_max_nm", "step N m", 1.0, 0),
    ("contacts.slip_max_m", "slip mm", 1e3, 1),
    ("tick_us.p99", "tick p99 us", 1.0, 0),
    ("real_time_factor", "RTF", 1.0, 2),
)
FAULT_CLIP, FAULT_RUNS = "walk_stops", 10
LOST_SHARE, GREATEST_JITTER_S = 0.2, 0.1
GAP_S, STOP_EARLIEST_S, STOP_LATEST_S = 1.0, 2.0, 7.0
PUSH_COUNT, PUSHED_FOR_S = 20, 8.0


class Faults:
    """What befalls the frames of one run, drawn by its number."""

    def __init__(self, run: int) -> None:
        self._draw = random.Random(run)
        self._at = STOP_EARLIEST_S + (STOP_LATEST_S - STOP_EARLIEST_S) * self._draw.random()

    def lost(self, frame: Frame, now: float) -> Sequence[tuple[float, Frame]]:
        """A fifth of them never arrives."""
        return [] if self._draw.random() < LOST_SHARE else [(now, frame)]

    def late(self, frame: Frame, now: float) -> Sequence[tuple[float, Frame]]:
        """They are up to 100 ms late, and out of order."""
        return [(now + GREATEST_JITTER_S * self._draw.random(), frame)]

    def twice(self, frame: Frame, now: float) -> Sequence[tuple[float, Frame]]:
        """They arrive twice."""
        return [(now, frame), (now + GREATEST_JITTER_S * self._draw.random(), frame)]

    def gap(self, frame: Frame, now: float) -> Sequence[tuple[float, Frame]]:
        """None arrives for a second."""
        return [] if self._at < now < self._at + GAP_S else [(now, frame)]

    def stops(self, frame: Frame, now: float) -> Sequence[tuple[float, Frame]]:
        """None arrives any more."""
        return [] if now > self._at else [(now, frame)]

    def elsewhere(self, frame: Frame, now: float) -> Sequence[tuple[float, Frame]]:
        """The person is 0.7 m aside at once."""
        return [(now, replace(frame, positions=frame.positions + np.array([0.7 * (now > self._at), 0.0, 0.0])))]

    def not_finite(self, frame: Frame, now: float) -> Sequence[tuple[float, Frame]]:
        """Some of them, and all for a fifth of a second, have no numbers."""
        bad = self._at < now < self._at + 0.2 or self._draw.random() < 0.05
        return [(now, replace(frame, positions=np.full_like(frame.positions, np.nan)) if bad else frame)]


FAULTS = ("lost", "late", "twice", "gap", "stops", "elsewhere", "not_finite")


def live_pieces(mocap: Path | None) -> Iterator[Piece]:
    """What is walked with."""
    yield from suite_pieces(mocap)
    seconds = next(clip.seconds for clip in clips.named_clips() if clip.name == AIMING_CLIP)
    for start in np.arange(0.0, seconds - 0.5 * PIECE_DURATION_S, PIECE_DURATION_S).tolist():
        yield Piece(f"{AIMING_CLIP} {start:.0f} s", AIMING_CLIP, start, min(PIECE_DURATION_S, seconds - start))
    for walk in WALKS:
        yield Piece(walk, walk)


def row_of(name: str, capture: Capture, request: LiveRequest, out: Path | None, fault: Fault | None) -> dict[str, Any]:
    """Follow a capture, and say how that went."""
    robot = Robot.load(request.robot)
    with (
        closing(PacedStream("udp", capture, FRAME_RATE_HZ, fault)) as stream,
        tempfile.TemporaryDirectory() as folder,
    ):
        report = follow(request, stream, robot, (out or Path(folder)) / name.replace(" ", "_"), lambda *_: None)
    ending = f"fell at {report['fell_at_s']:.1f} s" if report["fell"] else UPRIGHT
    row = {"name": name, "ending": ending, "success": not report["fell"]}
    return row | {place: figure_at(report, place) for place, *_ in COLUMNS}


def table_of(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Rows, and what they come to."""
    summary = {"clips": len(rows), "successes": sum(row["success"] for row in rows)}
    summary |= {place: usual_average(place, rows) for place, *_ in COLUMNS}
    return {"rows": rows, "rule": "upright to the end", "summary": summary}


def tell(row: Mapping[str, Any]) -> None:
    """Say at once how a run went."""
    figures = ", ".join(
        f"{head} {factor * row[place]:.{digits}f}" for place, head, factor, digits in COLUMNS if row[place] is not None
    )
    print(f"{row['name']}: {row['ending']}; {figures}", file=sys.stderr, flush=True)


def request_of(source: str, arguments: argparse.Namespace, delay: float) -> LiveRequest:
    """What is asked of a source; time is the simulation's."""
    return LiveRequest(source, arguments.robot, rate=arguments.rate, delay=delay, feet="steps", keeps_time=False)


def asked_pieces(arguments: argparse.Namespace, otherwise: Sequence[str] = ("",)) -> list[Piece]:
    """The pieces whose names hold what is asked for, or something else where nothing is."""
    names = arguments.only or otherwise
    found = [piece for piece in live_pieces(arguments.mocap) if any(name in piece.name for name in names)]
    if not found:
        sys.exit(f"--only {' '.join(names)}: no piece has such a name; those of --mocap need its folder")
    return found


def suite_rows(arguments: argparse.Namespace, delay: float) -> Iterator[dict[str, Any]]:
    """A row a clip."""
    for piece in asked_pieces(arguments):
        seconds = min(piece.duration or np.inf, arguments.seconds)
        capture = part_of(read(clips.find_clip(piece.clip)), piece.start, seconds if np.isfinite(seconds) else None)
        yield row_of(piece.name, capture, request_of(piece.clip, arguments, delay), arguments.out, None)


def fault_rows(arguments: argparse.Namespace, delay: float) -> Iterator[dict[str, Any]]:
    """A row a run: ten of each fault."""
    request = request_of(FAULT_CLIP, arguments, delay)
    capture = part_of(read(clips.find_clip(FAULT_CLIP)), 0.0, STOP_LATEST_S + 2.0 * GAP_S)
    for name in arguments.only or FAULTS:
        for run in range(FAULT_RUNS):
            yield row_of(f"{name} {run}", capture, request, arguments.out, getattr(Faults(run), name))


def push_rows(arguments: argparse.Namespace, delay: float) -> Iterator[dict[str, Any]]:
    """A row a push: twenty of the first clip whose name is asked for."""
    piece = asked_pieces(arguments, otherwise=WALKS)[0]
    capture = part_of(read(clips.find_clip(piece.clip)), piece.start, min(piece.duration or np.inf, PUSHED_FOR_S))
    request = request_of(piece.clip, arguments, delay)
    for push in spaced_pushes(STOP_EARLIEST_S, capture.duration + delay, PUSH_COUNT, arguments.pushes):
        name = f"{piece.name} at {push.t:.2f} s {np.degrees(push.direction):.0f} deg"
        yield row_of(name, capture, replace(request, pushes=(push,)), arguments.out, None)


def loop_rows(arguments: argparse.Namespace, delay: float) -> Iterator[dict[str, Any]]:
    """One long row."""
    capture = performance((LONG_CLIP, AIMING_CLIP), FRAME_RATE_HZ, loop=arguments.loop)
    yield row_of(f"both for {arguments.loop:g} s", capture, request_of("both", arguments, delay), arguments.out, None)


def main() -> int:
    """Print a table a delay."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mocap", type=Path, help="folder of more clips")
    parser.add_argument("--robot", default="hrp2")
    parser.add_argument("--delay", type=float, nargs="+", default=[0.5, 0.0], help="s")
    parser.add_argument("--seconds", type=float, default=np.inf, help="of each piece at most")
    parser.add_argument("--rate", type=float, default=500.0, help="Hz")
    parser.add_argument("--only", nargs="+", help="pieces whose names hold this; faults by name")
    parser.add_argument("--out", type=Path, help="folder that keeps recordings and reports")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--faults", action="store_true")
    kind.add_argument("--pushes", type=float, help="N s")
    kind.add_argument("--loop", type=float, help="s")
    arguments = parser.parse_args()
    rows_of = suite_rows
    if arguments.faults:
        rows_of = fault_rows
    elif arguments.pushes:
        rows_of = push_rows
    elif arguments.loop:
        rows_of = loop_rows
    for delay in arguments.delay:
        rows = []
        for row in rows_of(arguments, delay):
            rows.append(row)
            tell(row)
        print(f"delay {delay:g} s")
        show_suite(table_of(rows), Console(width=180), COLUMNS)
    return 0


if __name__ == "__main__":
    sys.exit(main())
