"""Time of a control tick, phase by phase, in a dance under physics."""

import json
import math
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from scenarios.replay import RECORDING_FILE, ProgressCallback, Replay, dance
from sim.log import RunLog
from sim.reference import Reference, hot_reference_us
from sim.reporting.report import figure_at
from sot.errors import InputError
from sot.text_file import read_text

PHASES = ("model", "assemble", "solve", "rest")
PERCENTILES = {"p50": 50.0, "p95": 95.0, "p99": 99.0}

# Lines of a comparison: path in the figures, words, whether it scales with the machine, digits after the point.
COMPARISON_LINES: tuple[tuple[str, str, bool, int], ...] = (
    ("tick_us.whole.p50", "tick, median [µs]", True, 0),
    ("tick_us.whole.p95", "tick, 95th percentile [µs]", True, 0),
    ("tick_us.whole.p99", "tick, 99th percentile [µs]", True, 0),
    *((f"tick_us.{phase}.mean", f"{phase}, mean [µs]", True, 0) for phase in PHASES),
    ("late_percent", "ticks longer than the period [%]", False, 2),
    ("real_time_factor", "simulated time over wall-clock time", False, 2),
    ("retarget_frames_per_s", "retargeting [frames/s]", False, 0),
    ("reference_us.interleaved", "reference computation, between ticks [µs]", False, 0),
    ("reference_us.hot", "reference computation, in a tight loop [µs]", False, 0),
)


def benchmark_figures(request: Replay, tell: ProgressCallback) -> dict[str, Any]:
    """Figures of the time that a dance takes; a reference computation runs between ticks, on as cold a cache.

    Returns:
        The figures, as `sot bench --json` prints them. The phases' means add up to that of the whole; "rest" is what a
        tick takes outside of the three phases that the controller times.

    Raises:
        InputError: anything in the request that does not fit.
    """
    reference = Reference()

    def between_ticks(what: str, share: float | None) -> None:
        if what == "replaying":
            reference()
        tell(what, share)

    danced = dance(request, between_ticks)
    run = danced.run
    tell("recording", None)
    with tempfile.TemporaryDirectory() as folder:
        wall = run.wall_s - 1e-6 * sum(reference.times_us) + danced.write_recording(Path(folder) / RECORDING_FILE)
    log = run.log.trimmed()
    return {
        "clip": danced.info.clip,
        "robot": danced.info.robot,
        "solver": danced.info.solver,
        "rate_hz": request.rate,
        "ticks": log.ticks,
        "fell": run.fell_at_s is not None,
        "tick_us": phase_statistics(log),
        "late_percent": 100.0 * float(np.mean(log.tick_us > 1e6 * log.period)),
        "real_time_factor": log.ticks * log.period / wall,
        "retarget_frames_per_s": danced.plan.retarget["frames_per_s"] if danced.plan else None,
        "reference_us": {"interleaved": reference.median_us, "hot": hot_reference_us()},
    }


def phase_statistics(log: RunLog) -> dict[str, dict[str, float]]:
    """Statistics of the whole tick and of its phases [µs]; the means of the phases add up to the whole's."""
    parts = {"model": log.model_us, "assemble": log.assemble_us, "solve": log.solve_us}
    times = {"whole": log.tick_us, **parts, "rest": log.tick_us - sum(parts.values())}
    return {
        name: {key: float(np.percentile(values, share)) for key, share in PERCENTILES.items()}
        | {"mean": float(np.mean(values))}
        for name, values in times.items()
    }


def read_figures(path: Path) -> dict[str, Any]:
    """Figures that `sot bench --json` has printed to a file.

    Raises:
        InputError: no such file, or something else in it.
    """
    try:
        figures = json.loads(read_text(path))
        complete = all(math.isfinite(figure_at(figures, place) or 0.0) for place, *_ in COMPARISON_LINES)
    except (ValueError, KeyError, TypeError):
        complete = False
    if not complete:
        raise InputError(f"{path}: not the figures of a benchmark; `sot bench --json > FILE` writes them")
    return figures


def show(figures: Mapping[str, Any], console: Console, against: Mapping[str, Any] | None = None) -> None:
    """Print figures as a table; against others as ratios too, made independent of the machine where time matters."""
    _title(figures, console)
    if against is None:
        _show_phases(figures, console)
        lines: Sequence[tuple[str, str, bool, int]] = [
            line for line in COMPARISON_LINES if not line[0].startswith("tick_us")
        ]
    else:
        console.print("Against: ", end="")
        _title(against, console)
        lines = COMPARISON_LINES
    table = Table(box=None, padding=(0, 2, 0, 0), show_header=against is not None)
    table.add_column("", no_wrap=True)
    for head in ("this", "that", "ratio", "in references") if against is not None else ("",):
        table.add_column(head, justify="right", no_wrap=True)
    for place, words, scales, digits in lines:
        values = [figure_at(each, place) for each in (figures, against) if each is not None]
        row = ["-" if value is None else f"{value:.{digits}f}" for value in values]
        if against is not None:
            row += _formatted_ratios(values, scales, figures, against)
        table.add_row(escape(words), *row)
    console.print(table)


def _title(figures: Mapping[str, Any], console: Console) -> None:
    fell = " (fell)" if figures["fell"] else ""
    console.print(
        f"{figures['clip']}, {figures['robot']}, {figures['solver']}, {figures['rate_hz']:g} Hz: "
        f"{figures['ticks']} ticks{fell}",
        highlight=False,
        soft_wrap=True,
    )


def _show_phases(figures: Mapping[str, Any], console: Console) -> None:
    table = Table(box=None, padding=(0, 2, 0, 0))
    table.add_column("µs a tick", no_wrap=True)
    heads = (*PERCENTILES, "mean")
    for head in (*heads, "mean in references"):
        table.add_column(head, justify="right")

    def add(tick_us: Mapping[str, Mapping[str, float]], reference_us: float | None, indent: str = "") -> None:
        for name, times in tick_us.items():
            relative = f"{times['mean'] / reference_us:.2f}" if reference_us else "-"
            table.add_row(indent + name, *(f"{times[head]:.0f}" for head in heads), relative)

    add(figures["tick_us"], figures["reference_us"]["interleaved"])
    for peer in figures.get("peers", ()):
        table.add_row(escape(peer["name"]))
        add(peer["tick_us"], peer["reference_us"], indent="  ")
    console.print(table)


def _formatted_ratios(
    values: Sequence[float | None], scales: bool, figures: Mapping[str, Any], against: Mapping[str, Any]
) -> tuple[str, str]:
    """Ratio of two values, and that of the two counted in each machine's reference."""
    this, that = values
    if this is None or not that:
        return "-", "-"
    units = [each["reference_us"]["interleaved"] for each in (figures, against)]
    relative = f"{this / units[0] / (that / units[1]):.2f}" if scales and all(units) else ""
    return f"{this / that:.2f}", relative
