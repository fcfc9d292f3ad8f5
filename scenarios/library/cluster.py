"""Jobs by the workers of a Dask cluster, each of which hands them to a process of its own with the same limits."""

import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import current_process

from scenarios.library.job import Job, Row
from scenarios.library.worker import Worker
from sot.errors import InputError

CONNECT_TIMEOUT_S = 30
WORKER_COMMAND = "DASK_DISTRIBUTED__WORKER__DAEMON=False dask worker {} --nthreads 1"
_own = threading.local()


@contextmanager
def cluster_results(address: str, jobs: Sequence[Job], memory_limit: float) -> Iterator[Iterator[Row]]:
    """The rows of jobs as a cluster's workers do them; the folder of the library has to be theirs too.

    Args:
        address: of the scheduler, such as tcp://10.0.0.1:8786.
        jobs: What to do.
        memory_limit: of a process [GB].

    Raises:
        InputError: Dask is not installed, or nobody answers there.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError("--cluster needs Dask: pip install 'humanoid-sot[cluster]'") from None
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        words = " ".join(str(error).split())[:200]
        raise InputError(f"--cluster {address}: no Dask scheduler answers there: {words}") from None
    with client:
        if not client.scheduler_info(n_workers=-1)["workers"]:
            how = WORKER_COMMAND.format(address)
            print(f"No worker at {address} yet; clips are danced as workers come: {how}", file=sys.stderr)
        futures = [client.submit(run_here, job, memory_limit, pure=False) for job in jobs]

        def rows() -> Iterator[Row]:
            for future in as_completed(futures, loop=client.loop):
                row: Row = future.result()
                future.release()
                yield row

        try:
            yield rows()
        finally:
            client.cancel(futures)


def run_here(job: Job, memory_limit: float) -> Row:
    """Do a job in the process that this thread of a worker keeps for them.

    Raises:
        InputError: the worker may have no processes of its own.
    """
    if current_process().daemon:
        raise InputError(
            "Dask's workers are watched by a nanny and may start no processes; start them so:"
            f" {WORKER_COMMAND.format('ADDRESS')}"
        )
    worker: Worker | None = getattr(_own, "worker", None)
    if worker is None:
        worker = _own.worker = Worker(memory_limit)
    return worker.run(job)
