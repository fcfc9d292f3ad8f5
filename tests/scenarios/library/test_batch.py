"""A batch: rows, resumption, and clips that take their process with them. The dances themselves are stand-ins."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from scenarios import cli
from scenarios.library import batch as batch_module
from scenarios.library.batch import Batch, run_batch
from scenarios.library.job import CLIPS, CRASHED, OUT_OF_MEMORY, REFUSED, TIMED_OUT, UPRIGHT, Job, dance_clip, read_row
from scenarios.library.table import LINES_FILE, TABLE_FILE, is_repeatable, read_rows, table_of
from scenarios.library.worker import Worker
from scenarios.replay import Replay
from sot.errors import InputError
from tests.scenarios.library.dancers import quick


class InProcess:
    """A worker without a process of its own: to start one takes seconds."""

    def __init__(self, memory_limit: float) -> None:
        self.run = quick

    def stop(self) -> None: ...
    def kill(self) -> None: ...


@pytest.fixture
def quick_workers(monkeypatch):
    monkeypatch.setattr(batch_module, "Worker", InProcess)


def folder_of(tmp_path: Path, *names: str) -> Path:
    folder = tmp_path / "mocap"
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / f"{name}.bvh").write_text("")
    return folder


def batch_of(folder: Path, out: Path, **options: object) -> Batch:
    return Batch(str(folder), out, Replay(""), **options)  # type: ignore[arg-type]


@pytest.mark.slow
def test_what_crashes_hangs_or_eats_memory_loses_itself_only(tmp_path, monkeypatch):
    monkeypatch.setattr(batch_module, "Worker", lambda limit: Worker(limit, quick))
    folder = folder_of(tmp_path, "one", "crash", "hang", "eat", "two")
    out = tmp_path / "library"
    told = []
    done = run_batch(
        batch_of(folder, out, workers=2, time_limit=5.0, memory_limit=4.0), lambda *what: told.append(what[1:])
    )
    outcomes = {row["clip"]: row["outcome"] for row in done.rows}
    assert outcomes == {
        "one.bvh": UPRIGHT,
        "crash.bvh": CRASHED,
        "hang.bvh": TIMED_OUT,
        "eat.bvh": OUT_OF_MEMORY,
        "two.bvh": UPRIGHT,
    }
    assert told == [(k, 5) for k in range(1, 6)]
    reasons = {row["clip"]: row["reason"] for row in done.rows}
    assert "SIGSEGV" in reasons["crash.bvh"] and "5 s" in reasons["hang.bvh"]
    lines = [json.loads(line) for line in (out / LINES_FILE).read_text().splitlines()]
    assert lines == done.rows == read_rows(out)
    table = pq.read_table(out / TABLE_FILE).to_pylist()
    assert [row["clip"] for row in table] == sorted(outcomes)
    assert table[-1]["figures.tracking.mpjpe_mm"] == 3.0

    (folder / "three.bvh").write_text("")
    again = run_batch(batch_of(folder, out))
    assert [row["clip"] for row in again.new] == ["three.bvh"] and len(again.rows) == 6


def test_ranks_share_the_clips_and_make_the_same_table(tmp_path, quick_workers):
    folder = folder_of(tmp_path, *(f"clip{k}" for k in range(7)))
    whole = run_batch(batch_of(folder, tmp_path / "whole"))
    shares = [run_batch(batch_of(folder, tmp_path / "shared", rank=rank, ranks=2)) for rank in range(2)]
    assert sum(len(share.new) for share in shares) == 7 and all(share.new for share in shares)
    same = [name for name in table_of(whole.rows).column_names if is_repeatable(name)]
    assert {"clip", "outcome", "figures.tracking.mpjpe_mm"} <= set(same)
    assert table_of(whole.rows).select(same) == table_of(shares[1].rows).select(same)


KILLED = """
import signal
import sys
from pathlib import Path
from scenarios.library import batch as batch_module
from scenarios.library.worker import Worker
from scenarios.replay import Replay
from tests.scenarios.library.dancers import quick
if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    batch_module.Worker = lambda limit: Worker(limit, quick)
    print("ready", flush=True)
    batch_module.run_batch(batch_module.Batch(sys.argv[1], Path(sys.argv[2]), Replay(""), workers=2),
                           lambda row, done, count: print(done, flush=True))
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_ctrl_c_ends_a_batch_and_keeps_what_is_done(tmp_path):
    folder, out = folder_of(tmp_path, "slow", *(f"hang{k}" for k in range(4))), tmp_path / "library"
    script = tmp_path / "killed.py"
    script.write_text(KILLED)
    process = subprocess.Popen(
        [sys.executable, str(script), str(folder), str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    started = [process.stdout.readline().strip() for _ in range(2)]
    assert started == ["ready", "1"]
    begun = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does, to all of them
    _, said = process.communicate(timeout=60.0)
    assert time.monotonic() - begun < 30.0 and said.count("Traceback") == 1 and "KeyboardInterrupt" in said
    assert [row["clip"] for row in read_rows(out)] == ["slow.bvh"]
    assert pq.read_table(out / TABLE_FILE).num_rows == 1


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_a_batch_that_is_killed_is_resumed(tmp_path):
    folder, out = folder_of(tmp_path, *(f"slow{k}" for k in range(12))), tmp_path / "library"
    script = tmp_path / "killed.py"
    script.write_text(KILLED)
    for stop_after in (1, 2, 2):
        process = subprocess.Popen(
            [sys.executable, str(script), str(folder), str(out)], stdout=subprocess.PIPE, text=True, cwd=Path.cwd()
        )
        assert process.stdout is not None
        for line in process.stdout:
            if line.strip() == "ready":
                before = len(read_rows(out))
            elif int(line) >= before + stop_after:
                break
        process.send_signal(signal.SIGKILL)
        process.wait()
    time.sleep(1.0)  # the workers notice that nobody is there
    kept = read_rows(out)
    assert 5 <= len(kept) < 12
    done = subprocess.run([sys.executable, str(script), str(folder), str(out)], check=True, capture_output=True)
    assert len(done.stdout.split()) == 1 + 12 - len(kept)
    assert [row["clip"] for row in read_rows(out)] == sorted(f"slow{k}.bvh" for k in range(12))
    assert [path.name for path in (out / CLIPS).iterdir() if path.name.startswith(".")] == []


def test_a_refused_clip_is_a_row_and_no_trace_of_it_is_left(tmp_path):
    folder = folder_of(tmp_path, "broken")
    job = Job("broken.bvh", Replay(str(folder / "broken.bvh")), tmp_path / "library")
    row = dance_clip(job)
    assert row["outcome"] == REFUSED and "broken.bvh" in row["reason"]
    assert read_row(job.folder) == row
    assert [path.name for path in job.folder.iterdir()] == ["row.json"]
    assert row["versions"]["mujoco"] and row["machine"]["host"]


def test_another_library_is_not_written_into(tmp_path, quick_workers):
    folder, out = folder_of(tmp_path, "one"), tmp_path / "library"
    run_batch(batch_of(folder, out))
    with pytest.raises(InputError, match="made with rate 1000"):
        run_batch(Batch(str(folder), out, Replay("", rate=500.0)))
    with pytest.raises(InputError, match="not empty"):
        run_batch(batch_of(folder, folder))


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["nowhere", "-o", "out"], "no such folder"),
        ([".", "-o", "out", "--to", "fbx"], "unknown format"),
        ([".", "-o", "out", "--from", "lerobot"], "folders"),
        ([".", "-o", "out", "--fps", "30"], "--from"),
        ([".", "-o", "out", "--rank", "2", "--ranks", "2"], "ranks count"),
        ([".", "-o", "out", "--solver", "magic"], "unknown solver"),
    ],
)
def test_bad_requests_are_one_line_and_write_nothing(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "clip.bvh").write_text("")
    assert cli.main(["batch", *arguments]) == cli.BAD_INPUT
    said = capsys.readouterr().err
    assert words in said and said.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["clip.bvh"]
