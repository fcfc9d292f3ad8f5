"""Streams give back their memory, and their files open with the blueprint."""

import os
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from sim.recording.stream import APPLICATION, open_stream

COUNT, MAX_GROWTH_MB = 50, 8.0  # rerun's own way grows by 29 MB
STATUS, THREADS = Path("/proc/self/statm"), Path("/proc/self/task")


def write(path: Path) -> None:
    views = (rrb.TimeSeriesView(origin="/angle"), rrb.Spatial3DView(origin="/"))
    with open_stream(path, rrb.Blueprint(rrb.Horizontal(*views))) as stream:
        stream.send_columns(
            "angle", [rr.TimeColumn("time", duration=np.arange(3))], rr.Scalars.columns(scalars=np.ones(3))
        )


def resident_mb() -> float:
    return int(STATUS.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


@pytest.mark.skipif(not STATUS.exists(), reason="needs /proc")
def test_many_streams_take_no_more_memory_and_threads_than_a_few(tmp_path):
    for _ in range(5):
        write(tmp_path / "run.rrd")
    before, threads = resident_mb(), len(list(THREADS.iterdir()))
    for _ in range(COUNT):
        write(tmp_path / "run.rrd")
    assert resident_mb() - before < MAX_GROWTH_MB
    assert len(list(THREADS.iterdir())) <= threads + 4


def test_a_file_holds_its_data_and_the_blueprint(tmp_path):
    write(tmp_path / "run.rrd")
    reader = RrdReader(tmp_path / "run.rrd")
    assert [chunk.entity_path for chunk in reader.stream().to_chunks() if chunk.entity_path == "/angle"] == ["/angle"]
    (blueprint,) = reader.blueprints()
    assert blueprint.application_id == APPLICATION
