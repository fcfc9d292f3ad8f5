"""What a command shows while it runs, and when it is done."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from scenarios.replay import RECORDING_FILE, REPORT_FILE, ProgressCallback
from scenarios.terminal import DONE, FELL, messages, output
from sim.reporting.report import print_table


def show_report(report: dict[str, Any], folder: Path) -> int:
    """Show a report, and say by which status a run ended."""
    print_table([report], output)
    print_remarks((*report["remarks"], *report["edits"]))
    output.print(f"\nWritten: {folder / RECORDING_FILE}, {folder / REPORT_FILE}", soft_wrap=True)
    return FELL if report["fell"] else DONE


def print_remarks(sentences: Sequence[str]) -> None:
    for sentence in sentences:
        output.print(f"\n{sentence}", soft_wrap=True, highlight=False)


@contextmanager
def progress() -> Iterator[ProgressCallback]:
    """A bar on a terminal, nothing in a pipe."""
    bar = Progress(
        TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn(), console=messages, transient=True
    )
    with bar if messages.is_terminal else nullcontext():
        task = bar.add_task("", total=None)
        yield lambda what, share: bar.update(task, description=what, total=share and 1.0, completed=share or 0.0)
