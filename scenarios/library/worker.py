"""A process that dances one clip after another: what crashes, hangs or eats memory loses its own clip only."""

import os
import signal
import threading
from collections.abc import Callable
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from time import perf_counter

from scenarios.library.job import CRASHED, OUT_OF_MEMORY, TIMED_OUT, Job, Row, dance_clip, lost_row

START_LIMIT_S = 600.0  # for a process to begin, which the first time on a machine compiles
DEFAULT_MEMORY_LIMIT_GB = 4.0
GIGABYTE = 1_000_000_000
VARIABLES = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
"""Environment of a process that shares the machine with others like it."""
VARIABLES["MALLOC_ARENA_MAX"] = "2"  # or each thread of a library reserves memory that nobody uses, and that counts
READY = "ready"
Dancer = Callable[[Job], Row]


class WorkerStoppedError(Exception):
    """A worker was stopped before its job was done."""


class Worker:
    """A process of its own for jobs, begun anew after one that it did not survive.

    Args:
        memory_limit: most memory that it may take for its jobs [GB]; not held where the system cannot.
        dancer: what it does with a job.
    """

    def __init__(self, memory_limit: float = DEFAULT_MEMORY_LIMIT_GB, dancer: Dancer = dance_clip) -> None:
        self._memory_limit, self._dancer = memory_limit, dancer
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None
        self._stopped = False

    def run(self, job: Job) -> Row:
        """Do a job; returns its row, whatever became of it.

        Raises:
            WorkerStoppedError: it was stopped meanwhile.
        """
        pipe, begun = self._ready_pipe(), perf_counter()
        try:
            pipe.send(job)
            if not pipe.poll(None if job.time_limit == float("inf") else job.time_limit):
                self.kill()
                return lost_row(job, TIMED_OUT, f"took more than {job.time_limit:g} s", perf_counter() - begun)
            row: Row = pipe.recv()
        except (EOFError, OSError):
            status = self.kill()
            if self._stopped:
                raise WorkerStoppedError from None
            return lost_row(job, CRASHED, f"its process ended {_ending(status)}", perf_counter() - begun)
        if row["outcome"] == OUT_OF_MEMORY:
            self.kill()  # what is left of it is not to be trusted
        return row

    def stop(self) -> None:
        """End the process from another thread, whatever it is at; `run` tells."""
        self._stopped = True
        process = self._process
        if process is not None:
            process.kill()

    def kill(self) -> int | None:
        """End the process at once; returns its exit status, negative for a signal."""
        process, self._process = self._process, None
        if process is None:
            return None
        process.join(0.2)  # an ending process tells how it ended
        process.kill()
        process.join()
        if self._pipe is not None:
            self._pipe.close()
        return process.exitcode

    def _ready_pipe(self) -> Connection:
        if self._process is not None and self._process.is_alive() and self._pipe is not None:
            return self._pipe
        self.kill()
        if self._stopped:
            raise WorkerStoppedError
        context = get_context("spawn")
        ours, theirs = context.Pipe()
        arguments = (theirs, self._memory_limit, self._dancer)
        with _SharingTheMachine():
            self._process = context.Process(target=_work, args=arguments, daemon=True)
            self._process.start()
        theirs.close()
        self._pipe = ours
        if self._stopped or not self._is_ready(ours):
            self.kill()
            raise WorkerStoppedError if self._stopped else RuntimeError("a worker's process could not be started")
        return ours

    @staticmethod
    def _is_ready(pipe: Connection) -> bool:
        try:
            return pipe.poll(START_LIMIT_S) and pipe.recv() == READY
        except (EOFError, OSError):
            return False


_starting = threading.Lock()


class _SharingTheMachine:
    """Processes that are started meanwhile have one thread each, for so many share the machine, and leave Ctrl-C to the
    process that they are started by."""

    def __enter__(self) -> None:
        _starting.acquire()
        self._before = {name: os.environ.get(name) for name in VARIABLES}
        os.environ.update(VARIABLES)
        if os.name == "posix":  # a process inherits what the thread blocks that starts it
            self._blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})

    def __exit__(self, *error: object) -> None:
        for name, value in self._before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
        if os.name == "posix":
            signal.pthread_sigmask(signal.SIG_SETMASK, self._blocked)
        _starting.release()


def _work(pipe: Connection, memory_limit: float, dancer: Dancer) -> None:
    """A worker's process: jobs in, rows out, until nobody sends any."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the batch's own process ends it
    threading.Thread(target=_end_with_parent, daemon=True).start()
    _limit_memory(memory_limit)
    pipe.send(READY)
    while True:
        try:
            job = pipe.recv()
        except (EOFError, OSError):
            return
        pipe.send(dancer(job))


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _limit_memory(gigabytes: float) -> None:
    """Let the process take so much memory on top of what its programs and libraries have reserved."""
    if os.name != "posix":
        return
    import resource

    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    wanted = _reserved_bytes() + int(gigabytes * GIGABYTE)
    soft = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


def _reserved_bytes() -> int:
    """Data that this process has reserved, as the limit counts it; 0 where the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[5])
    except (OSError, ValueError, IndexError):
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


def _ending(status: int | None) -> str:
    if status is None or status >= 0:
        return f"with status {status}"
    try:
        return f"by {signal.Signals(-status).name}"
    except ValueError:
        return f"by signal {-status}"
