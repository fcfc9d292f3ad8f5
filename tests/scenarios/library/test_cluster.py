"""A batch by the workers of a Dask cluster."""

import os
import subprocess
import sys
import threading

import pytest

from scenarios.library import cluster
from scenarios.library.batch import Batch, run_batch
from scenarios.library.job import CRASHED, UPRIGHT
from scenarios.library.worker import Worker
from scenarios.replay import Replay
from sot.errors import InputError
from tests.scenarios.library.dancers import quick

distributed = pytest.importorskip("distributed")


@pytest.mark.slow
def test_two_workers_share_the_clips(tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "Worker", lambda limit: Worker(limit, quick))
    folder, names = tmp_path / "mocap", ["slow1", "slow2", "slow3", "slow4", "crash"]
    folder.mkdir()
    for name in names:
        (folder / f"{name}.bvh").write_text("")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None) as local:
        batch = Batch(str(folder), tmp_path / "library", Replay(""), cluster=local.scheduler_address)
        done = run_batch(batch)
    outcomes = {row["clip"].removesuffix(".bvh"): row["outcome"] for row in done.rows}
    assert outcomes == {name: CRASHED if name == "crash" else UPRIGHT for name in names}
    processes = {row["times"]["worker"] for row in done.rows if row["outcome"] == UPRIGHT}
    assert len(processes) >= 2


@pytest.mark.slow
def test_workers_that_come_late_by_the_command_that_is_told_dance_the_clips(tmp_path, capsys):
    clips, done = tmp_path / "clips.txt", []
    clips.write_text("groove\t1.0\t0.2\nnothing.bvh\n")
    request = Replay("", rate=200.0, feet="planted")
    with distributed.LocalCluster(n_workers=0, processes=False, protocol="tcp", dashboard_address=None) as local:
        batch = Batch(str(clips), tmp_path / "library", request, cluster=local.scheduler_address)
        waits = threading.Thread(target=lambda: done.append(run_batch(batch)))
        waits.start()
        variable, _, _, *arguments = cluster.WORKER_COMMAND.format(local.scheduler_address).split()
        command = [sys.executable, "-m", "distributed.cli.dask_worker", *arguments, "--no-dashboard"]
        name, value = variable.split("=")
        worker = subprocess.Popen(command, env=os.environ | {name: value, "PYTHONPATH": os.getcwd()})
        waits.join(300.0)
        worker.terminate()
        worker.wait()
    assert sorted(row["outcome"] for row in done[0].rows) == ["refused", UPRIGHT]
    assert "No worker at tcp://" in capsys.readouterr().err


def test_nobody_at_the_address(tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "CONNECT_TIMEOUT_S", 1)
    (tmp_path / "clip.bvh").write_text("")
    batch = Batch(str(tmp_path / "*.bvh"), tmp_path / "library", Replay(""), cluster="tcp://127.0.0.1:9")
    with pytest.raises(InputError, match="no Dask scheduler answers"):
        run_batch(batch)
