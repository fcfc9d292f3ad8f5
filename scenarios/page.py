"""`sot report`: one page of one run or several, or of a library."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from scenarios.library.page import is_library, write_library_page
from scenarios.replay import REPORT_FILE, TRACES_FILE, check_writable
from sim.reporting import page
from sim.reporting.traces import Traces
from sot.errors import InputError
from sot.text_file import read_text

PAGE_FILE, COMPARISON_FILE = "report.html", "comparison.html"


def write_page(folders: Sequence[Path], out: Path | None = None) -> Path:
    """Write the page of a run, of several beside each other, or of a library.

    Args:
        folders: of the runs, or of one library of `sot batch`.
        out: file to write; the run's own folder takes it by default, or the folder above the first of several.

    Returns:
        The file.

    Raises:
        InputError: a folder is no run, or of another version; or the file cannot be written. Nothing is written then.
    """
    places = [folder.resolve() for folder in folders]
    repeated = next((folder for k, folder in enumerate(folders) if places[k] in places[:k]), None)
    if repeated is not None:
        raise InputError(f"{repeated}: given twice; name each run once")
    if out is None:
        out = folders[0] / PAGE_FILE if len(folders) == 1 else folders[0].absolute().parent / COMPARISON_FILE
    if out.suffix not in (".html", ".htm") or out.is_dir():
        raise InputError(f"{out}: a page is written to a file that ends in .html")
    if len(folders) == 1 and is_library(folders[0]):
        check_writable(out.parent)
        out.parent.mkdir(parents=True, exist_ok=True)
        write_library_page(folders[0], out)
        return out
    runs = [_read_run(folder) for folder in folders]
    check_writable(out.parent)
    out.parent.mkdir(parents=True, exist_ok=True)
    names = [place.name for place in places]
    if len(set(names)) < len(names):
        names = [str(folder) for folder in folders]
    page.write_html(out, names, [report for report, _ in runs], [traces for _, traces in runs])
    return out


def _read_run(folder: Path) -> tuple[Mapping[str, Any], Traces]:
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; `sot replay CLIP --out DIR` makes a run")
    for name in (REPORT_FILE, TRACES_FILE):
        if not (folder / name).is_file():
            raise InputError(
                f"{folder}: no run of `sot replay` or of an earlier version, it has no {name}; run it again"
            )
    traces = Traces.load(folder / TRACES_FILE)
    try:
        report = json.loads(read_text(folder / REPORT_FILE))
        same = report["clip"] == traces.facts["clip"] and report["robot"] == traces.facts["robot"]
        same = same and math.isclose(report["duration_s"], traces.facts["duration_s"], rel_tol=1e-5)
        list(page.report.table_rows([report]))
        for key in ("command", "seed", "revision"):
            _ = report[key]
    except (OSError, ValueError, KeyError, TypeError) as error:
        what = f"it has no '{error.args[0]}'" if isinstance(error, KeyError) else str(error)
        raise InputError(f"{folder / REPORT_FILE}: cannot be read as a run's report ({what}); run it again") from None
    if not same:
        raise InputError(f"{folder}: {REPORT_FILE} and {TRACES_FILE} are of different runs; run it again")
    return report, traces
