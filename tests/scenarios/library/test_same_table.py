"""A library of real dances is the same table whether made at one go, killed and resumed, by ranks, or by Dask."""

import os
import random
import subprocess
import sys
import time
from pathlib import Path

import pyarrow as pa
import pytest

from scenarios.library.batch import Batch, run_batch
from scenarios.library.job import CLIPS, UPRIGHT
from scenarios.library.table import is_repeatable, read_rows, table_of
from scenarios.replay import Replay

REQUEST = Replay("", rate=200.0, feet="planted")
STARTS, DURATION = (1.0, 3.0, 5.0, 7.0), 0.2
COMMAND = ("-m", "scenarios", "batch", "--rate", "200", "--feet", "planted", "--workers", "2")
KILLS, SECONDS_TO_KILL = 2, (1.0, 4.0)


def table(out: Path) -> pa.Table:
    whole = table_of(read_rows(out))
    return whole.select([name for name in whole.column_names if is_repeatable(name)])


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_real_dances_killed_and_resumed_or_shared_make_the_same_table(tmp_path):
    clips = tmp_path / "clips.txt"
    clips.write_text("".join(f"groove\t{start}\t{DURATION}\n" for start in STARTS) + "nothing.bvh\n")
    whole, killed, shared, clustered = (tmp_path / name for name in ("whole", "killed", "shared", "clustered"))

    run_batch(Batch(str(clips), whole, REQUEST, workers=2))
    expected = table(whole)
    assert expected.num_rows == len(STARTS) + 1 and expected.column("outcome").to_pylist().count(UPRIGHT) == len(STARTS)

    chance = random.Random(1)
    for _ in range(KILLS):
        process = subprocess.Popen([sys.executable, *COMMAND, str(clips), "-o", str(killed)], cwd=Path.cwd())
        before = len(read_rows(killed))
        while process.poll() is None and len(read_rows(killed)) == before:  # a dance at least is done
            time.sleep(0.1)
        time.sleep(chance.uniform(*SECONDS_TO_KILL))
        process.kill()
        process.wait()
    time.sleep(1.0)  # the workers notice that nobody is there
    run_batch(Batch(str(clips), killed, REQUEST, workers=2))
    assert table(killed) == expected
    assert not [path for path in (killed / CLIPS).iterdir() if path.name.startswith(".")]

    for rank in range(2):
        run_batch(Batch(str(clips), shared, REQUEST, rank=rank, ranks=2))
    assert table(shared) == expected

    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None) as local:
        run_batch(Batch(str(clips), clustered, REQUEST, cluster=local.scheduler_address))
    assert table(clustered) == expected
