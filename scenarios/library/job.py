"""A clip of a library from its file to its row: planned, danced, reported, exported, in a folder of its own."""

import json
import os
import platform
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import Any

from scenarios.library.export import export_run, parse_formats
from scenarios.replay import Replay, replay
from sim.reporting.provenance import revision
from sot.errors import InputError
from sot.whole_file import atomic_folder, atomic_write

ROW_FILE, CLIPS = "row.json", "clips"
UPRIGHT, FELL, REFUSED, FAILED = "upright", "fell", "refused", "failed"
CRASHED, TIMED_OUT, OUT_OF_MEMORY = "crashed", "timed out", "out of memory"
OUTCOMES = (UPRIGHT, FELL, REFUSED, FAILED, CRASHED, TIMED_OUT, OUT_OF_MEMORY)
PACKAGES = ("mujoco", "numpy", "pin")
STAGES = {"reading": "read_s", "planning": "plan_s", "replaying": "dance_s", "recording": "record_s"}
Row = dict[str, Any]


@dataclass(frozen=True)
class Job:
    """A clip to dance.

    Attributes:
        key: the clip's name in the library.
        request: what to do.
        library: the folder of the library.
        formats: what to export, as `sot export --to` takes it; nothing if empty.
        time_limit: longest time that it may take [s].
    """

    key: str
    request: Replay
    library: Path
    formats: str = ""
    time_limit: float = float("inf")

    @property
    def folder(self) -> Path:
        """Where its files come to be."""
        return self.library / CLIPS / self.key


def read_row(folder: Path) -> Row | None:
    """The row of a clip that is done; None if there is none yet."""
    try:
        row: Row = json.loads((folder / ROW_FILE).read_text("utf-8"))
        return row if row["clip"] and row["outcome"] in OUTCOMES else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def dance_clip(job: Job) -> Row:
    """Do a job; its folder appears when all is done, with the row in it. Returns the row."""
    begun, times = perf_counter(), _Stages()
    row = empty_row(job)
    job.folder.parent.mkdir(parents=True, exist_ok=True)
    with atomic_folder(job.folder) as place:
        place.mkdir()
        try:
            report = replay(job.request, place, times)
            row |= {
                "outcome": FELL if report["fell"] else UPRIGHT,
                "reason": report["fell_reason"] or "",
                "seconds": report["duration_s"],
                "remarks": report["remarks"],
                "figures": flat_figures(report),
            }
            if job.formats:
                times("exporting", None)
                export_run(place, parse_formats(job.formats), robot=job.request.robot)
        except InputError as refusal:
            row |= {"outcome": REFUSED, "reason": str(refusal)}
        except MemoryError:
            row |= {"outcome": OUT_OF_MEMORY, "reason": "beyond the memory limit"}
        except Exception as error:
            row |= {"outcome": FAILED, "reason": f"{type(error).__name__}: {' '.join(str(error).split())}"}
        row["times"] = times.ended() | {"total_s": perf_counter() - begun}
        row["memory_mb"] = peak_memory_mb()
        write_row(row, place)
    return row


def lost_row(job: Job, outcome: str, reason: str, seconds: float) -> Row:
    """The row of a clip that took its process with it; it is all that its folder holds."""
    row = empty_row(job) | {"outcome": outcome, "reason": reason, "times": {"total_s": seconds}}
    job.folder.parent.mkdir(parents=True, exist_ok=True)
    with atomic_folder(job.folder) as place:
        place.mkdir()
        write_row(row, place)
    return row


def empty_row(job: Job) -> Row:
    """A row without an outcome."""
    return {
        "clip": job.key,
        "outcome": "",
        "reason": "",
        "robot": job.request.robot,
        "seconds": None,
        "figures": {},
        "remarks": [],
        "versions": {"revision": revision(), **{name: version(name) for name in PACKAGES}},
        "machine": {"host": platform.node(), "system": platform.platform(), "python": platform.python_version()},
        "times": {},
        "memory_mb": None,
    }


def write_row(row: Row, folder: Path) -> None:
    """Write a row into a clip's folder."""
    with atomic_write(folder / ROW_FILE) as place:
        place.write_text(json.dumps(row) + "\n", encoding="utf-8")


def flat_figures(report: Mapping[str, Any], before: str = "") -> dict[str, float | bool | None]:
    """The numbers of a report by their places, keys joined by dots; lists are left out."""
    flat: dict[str, float | bool | None] = {}
    for key, value in report.items():
        if isinstance(value, Mapping):
            flat |= flat_figures(value, f"{before}{key}.")
        elif value is None or isinstance(value, int | float):
            flat[before + key] = value
    return flat


def peak_memory_mb() -> float | None:
    """Most memory that this process has had resident [MB]; None where the system does not tell."""
    if os.name != "posix":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(peak / (1e6 if sys.platform == "darwin" else 1e3), 1)


class _Stages:
    """Takes the time of what it is told is being done [s]."""

    def __init__(self) -> None:
        self._stage, self._since, self._times = "", perf_counter(), dict[str, float]()

    def __call__(self, what: str, share: float | None) -> None:
        stage = what.split(" ")[0]
        if stage != self._stage:
            self._close()
            self._stage = stage

    def ended(self) -> dict[str, float]:
        """All of them, by their names in a row."""
        self._close()
        return dict(self._times)

    def _close(self) -> None:
        now, name = perf_counter(), STAGES.get(self._stage, f"{self._stage}_s" if self._stage else "")
        if name:
            self._times[name] = self._times.get(name, 0.0) + now - self._since
        self._since = now
