"""The rows of a library as one file of JSON lines and one Parquet table, a clip a row, in the order of their names."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from scenarios.library.job import CLIPS, ROW_FILE, Row, read_row
from sot.whole_file import atomic_write

LINES_FILE, TABLE_FILE = "library.jsonl", "library.parquet"
TEXTS = ("clip", "outcome", "reason", "robot")
MEASURED_ON_THE_MACHINE = ("times.", "machine.", "memory_mb", "figures.tick_us.", "figures.estimator_us.")
"""How names of columns begin that differ from one machine or run to another."""
TIMES = ("figures.real_time_factor", "figures.reference_us", "figures.retarget.frames_per_s", "figures.planning_ratio")
"""Further columns that do."""
ROUNDING_ERRORS = ("figures.solver.max_residual",)
"""Columns of rounding errors alone, which differ with where arrays lie in memory."""


def read_rows(library: Path) -> list[Row]:
    """The rows of all clips that are done, by name."""
    folder = library / CLIPS
    found = (read_row(path.parent) for path in sorted(folder.rglob(ROW_FILE)) if not _is_partial(path, folder))
    return sorted((row for row in found if row is not None), key=lambda row: row["clip"])


def append_line(library: Path, row: Row) -> None:
    """Add a clip's line while a batch runs."""
    with (library / LINES_FILE).open("a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")


def write_table(library: Path) -> list[Row]:
    """Write both files anew from the clips' own rows; returns these."""
    rows = read_rows(library)
    with atomic_write(library / LINES_FILE) as place:
        place.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    with atomic_write(library / TABLE_FILE) as place:
        pq.write_table(table_of(rows), place)
    return rows


def table_of(rows: Sequence[Row]) -> pa.Table:
    """Rows as a table: texts, numbers by their places (nested keys joined by dots), remarks as lists."""
    flat = [_flat(row) for row in rows]
    names = dict.fromkeys(name for row in flat for name in row)
    columns: dict[str, pa.Array] = {}
    for name in dict.fromkeys((*TEXTS, *sorted(names))):
        values = [row.get(name) for row in flat]
        if name == "remarks":
            columns[name] = pa.array(values, pa.list_(pa.string()))
        elif any(isinstance(value, str) for value in values) or name in TEXTS:
            columns[name] = pa.array([None if value is None else str(value) for value in values], pa.string())
        else:
            columns[name] = pa.array([None if value is None else float(value) for value in values], pa.float64())
    return pa.table(columns)


def is_repeatable(column: str) -> bool:
    """Whether a column is the same whenever, wherever and by however many workers a library is made."""
    return not column.startswith(MEASURED_ON_THE_MACHINE) and column not in (*TIMES, *ROUNDING_ERRORS)


def _flat(row: Row, before: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in row.items():
        if isinstance(value, dict):
            flat |= _flat(value, f"{before}{key}.")
        else:
            flat[before + key] = value
    return flat


def _is_partial(path: Path, folder: Path) -> bool:
    return any(part.startswith(".") for part in path.relative_to(folder).parts)
