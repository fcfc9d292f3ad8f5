"""`sot batch` on the command line."""

from pathlib import Path
from typing import Annotated

import typer
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from scenarios.inputs.clip_options import Duration, Feet, FrameRate, FromFormat, MappingFile
from scenarios.inputs.run_options import Rate, RobotName, SolverName
from scenarios.library.batch import DEFAULT_TIME_LIMIT_S, OPTIONS_FILE, Batch, Summary, run_batch
from scenarios.library.job import OUTCOMES, UPRIGHT, Row
from scenarios.library.table import LINES_FILE, TABLE_FILE
from scenarios.library.throughput import throughput_words
from scenarios.library.worker import DEFAULT_MEMORY_LIMIT_GB
from scenarios.replay import Replay
from scenarios.terminal import DONE, messages, output

SHOWN_FAILURES = 10


def batch_command(
    clips: Annotated[
        str, typer.Argument(help='A folder, a pattern like "mocap/**/*.bvh", or a list (.txt), a clip a line.')
    ],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the library.")],
    robot: RobotName = "hrp2",
    solver: SolverName = "cascade",
    feet: Feet = "auto",
    duration: Duration = None,
    rate: Rate = 1000.0,
    mapping: MappingFile = None,
    from_format: FromFormat = None,
    fps: FrameRate = None,
    to: Annotated[
        str, typer.Option("--to", help="Formats to export each clip in, as `sot export --to`; none by default.")
    ] = "",
    workers: Annotated[int, typer.Option(help="Processes at once, one thread each.", min=1, max=1024)] = 1,
    cluster: Annotated[str | None, typer.Option(help="Address of a Dask scheduler whose workers do it.")] = None,
    rank: Annotated[int, typer.Option(help="With --ranks: which share of the clips to do, from 0.", min=0)] = 0,
    ranks: Annotated[int, typer.Option(help="How many batches share the clips.", min=1)] = 1,
    time_limit: Annotated[float, typer.Option(help="Longest time for a clip [s].", min=0.01)] = DEFAULT_TIME_LIMIT_S,
    memory_limit: Annotated[
        float, typer.Option(help="Most memory that a clip may take [GB].", min=0.1)
    ] = DEFAULT_MEMORY_LIMIT_GB,
) -> int:
    """Dance a whole library of clips in parallel; called again, it goes on where it was."""
    request = Replay(
        "", robot, None, solver, feet, duration=duration, rate=rate, mapping=mapping, from_format=from_format, fps=fps
    )
    batch = Batch(clips, out, request, to, workers, rank, ranks, time_limit, memory_limit, cluster)
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=messages,
        transient=True,
        disable=not messages.is_terminal,
    )
    with bar:
        task = bar.add_task("starting", total=None)

        def told(row: Row, done: int, count: int) -> None:
            bar.update(task, description=f"{row['outcome']}: {row['clip']}", completed=done, total=count)

        summary = run_batch(batch, told)
    _show(summary, out)
    return DONE


def _show(summary: Summary, out: Path) -> None:
    counts = {outcome: sum(row["outcome"] == outcome for row in summary.rows) for outcome in OUTCOMES}
    told = ", ".join(f"{count} {outcome}" for outcome, count in counts.items() if count)
    output.print(f"{len(summary.rows)} clips in the library: {told}", highlight=False)
    if summary.new:
        seconds = sum(row["seconds"] or 0.0 for row in summary.new)
        output.print(
            f"This batch: {len(summary.new)} clips, {seconds:.0f} s of motion in {summary.wall_s:.0f} s:"
            f" {throughput_words(summary.new)}",
            soft_wrap=True,
            highlight=False,
        )
    bad = [row for row in summary.new if row["outcome"] != UPRIGHT]
    for row in bad[:SHOWN_FAILURES]:
        output.print(f"{row['clip']}: {row['outcome']}: {row['reason']}", soft_wrap=True, highlight=False, markup=False)
    if len(bad) > SHOWN_FAILURES:
        output.print(f"{len(bad) - SHOWN_FAILURES} more of these are in {LINES_FILE}")
    files = ", ".join(str(out / name) for name in (OPTIONS_FILE, LINES_FILE, TABLE_FILE))
    output.print(f"\nWritten: {files}; `sot report {out}` makes a page of it", soft_wrap=True)
