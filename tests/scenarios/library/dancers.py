"""What workers do with jobs in tests: quick, and as bad as clips can be. The clip's name says what."""

import os
import signal
import time

import numpy as np

from scenarios.library.job import UPRIGHT, Job, Row, dance_clip, empty_row, write_row
from sot.whole_file import atomic_folder


def quick(job: Job) -> Row:
    """Sleeps, crashes, hangs, eats memory, or is done at once, as the clip's name asks for; writes as a dance does."""
    name = job.key.split("/")[-1].removesuffix(".bvh")
    if name.startswith("crash"):
        os.kill(os.getpid(), signal.SIGSEGV)
    if name.startswith("hang"):
        time.sleep(60.0)
    if name.startswith("slow"):
        time.sleep(0.3)
    if name.startswith("eat"):
        return _eating(job)
    row = empty_row(job) | {"outcome": UPRIGHT, "seconds": 1.0, "figures": {"tracking.mpjpe_mm": float(len(name))}}
    row["times"] = {"total_s": 0.0, "worker": float(os.getpid())}
    job.folder.parent.mkdir(parents=True, exist_ok=True)
    with atomic_folder(job.folder) as place:
        place.mkdir()
        write_row(row, place)
    return row


def _eating(job: Job) -> Row:
    import scenarios.library.job as own

    def eat(*anything: object) -> object:
        return [np.empty(125_000_000) for _ in range(200)]  # reserved, not touched

    own.replay = eat  # type: ignore[assignment]
    return dance_clip(job)
