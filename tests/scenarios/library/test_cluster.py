"""A batch by the workers of a Dask cluster."""

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


def test_nobody_at_the_address(tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "CONNECT_TIMEOUT_S", 1)
    (tmp_path / "clip.bvh").write_text("")
    batch = Batch(str(tmp_path / "*.bvh"), tmp_path / "library", Replay(""), cluster="tcp://127.0.0.1:9")
    with pytest.raises(InputError, match="no Dask scheduler answers"):
        run_batch(batch)
