"""Figures of other controllers, or of ours elsewhere, for the table of a benchmark."""

import json
import math
from pathlib import Path
from typing import Any

from sot.errors import InputError
from sot.text_file import read_text

TICK_STATISTICS = ("p50", "p95", "p99", "mean")


def read_peer_figures(path: Path) -> dict[str, Any]:
    """Read the figures that `benchmarks/peer_tsid.py` or `benchmarks/peer_ticks.py` printed to a file.

    Returns:
        "name"; "tick_us", phase -> `TICK_STATISTICS` [µs]; "reference_us", of the reference computation meanwhile [µs].

    Raises:
        InputError: no such file, or something else in it.
    """
    try:
        peer = json.loads(read_text(path))
        times = [times[key] for times in peer["tick_us"].values() for key in TICK_STATISTICS]
        complete = isinstance(peer["name"], str) and bool(times)
        complete = complete and all(math.isfinite(value) and value >= 0.0 for value in (*times, peer["reference_us"]))
    except (ValueError, KeyError, TypeError, AttributeError):
        complete = False
    if not complete:
        raise InputError(f"{path}: not the figures of a peer; `python benchmarks/peer_tsid.py` prints them")
    return {key: peer[key] for key in ("name", "tick_us", "reference_us")}
