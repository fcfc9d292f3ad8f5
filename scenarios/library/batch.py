"""`sot batch`: a folder, a pattern or a list of clips danced in parallel, to a library that a second call resumes."""

import json
import queue
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import Any

from scenarios.inputs.dancer import check_format
from scenarios.library.clip_list import CLIP_ENDINGS, find_clips, share_of_rank
from scenarios.library.export import parse_formats
from scenarios.library.job import Job, Row, read_row
from scenarios.library.table import append_line, write_table
from scenarios.library.worker import DEFAULT_MEMORY_LIMIT_GB, Worker
from scenarios.replay import Replay, check_writable, make_solver
from sot.errors import InputError
from sot.exchange.registry import readable_format
from sot.robots.robot import Robot
from sot.text_file import read_text
from sot.whole_file import atomic_write

OPTIONS_FILE = "library.json"
DEFAULT_TIME_LIMIT_S = 3600.0
Teller = Callable[[Row, int, int], object]
"""Function that is told a row that has come, how many are done, and how many there are."""


@dataclass(frozen=True)
class Batch:
    """What a batch does.

    Attributes:
        source: folder, pattern or list of the clips.
        out: folder of the library.
        request: what holds for all clips.
        formats: to export each clip's run in, as `sot export --to` takes them.
        workers: processes at once.
        rank, ranks: the share of the clips to do.
        time_limit: of a clip [s].
        memory_limit: of a process [GB].
        cluster: address of a Dask scheduler whose workers do it, in the place of processes here.
    """

    source: str
    out: Path
    request: Replay
    formats: str = ""
    workers: int = 1
    rank: int = 0
    ranks: int = 1
    time_limit: float = DEFAULT_TIME_LIMIT_S
    memory_limit: float = DEFAULT_MEMORY_LIMIT_GB
    cluster: str | None = None


@dataclass(frozen=True)
class Summary:
    """What a batch came to.

    Attributes:
        rows: of all clips of the library that are done, whoever did them.
        new: of the clips that this batch did.
        wall_s: time that it took [s].
    """

    rows: list[Row]
    new: list[Row]
    wall_s: float


def run_batch(batch: Batch, tell: Teller = lambda row, done, count: None) -> Summary:
    """Dance all clips of a batch that are not done yet.

    Raises:
        InputError: no clips, a request that no clip can be danced with, or another library is in the folder.
        KeyboardInterrupt: the user ends it; what is done is kept, and the table is written.
    """
    make_solver(batch.request.solver)
    check_format(batch.request)
    Robot.load(batch.request.robot)
    if batch.formats:
        parse_formats(batch.formats)
    clips = share_of_rank(find_clips(batch.source, _endings(batch.request)), batch.rank, batch.ranks)
    check_writable(batch.out)
    batch.out.mkdir(parents=True, exist_ok=True)
    _claim_folder(batch)
    jobs = [
        Job(
            clip.key,
            replace(batch.request, clip=clip.clip, start=clip.start, duration=clip.duration or batch.request.duration),
            batch.out,
            batch.formats,
            batch.time_limit,
        )
        for clip in clips
    ]
    begun, new, waiting = perf_counter(), list[Row](), [job for job in jobs if read_row(job.folder) is None]
    try:
        with _results(batch, waiting) as results:
            for row in results:
                new.append(row)
                append_line(batch.out, row)
                tell(row, len(jobs) - len(waiting) + len(new), len(jobs))
    finally:
        rows = write_table(batch.out)
    return Summary(rows, new, perf_counter() - begun)


@contextmanager
def _results(batch: Batch, jobs: Sequence[Job]) -> Iterator[Iterator[Row]]:
    """The rows of jobs as they come; nothing goes on when this is left."""
    if batch.cluster is not None:
        from scenarios.library.cluster import cluster_results

        with cluster_results(batch.cluster, jobs, batch.memory_limit) as rows:
            yield rows
        return
    with _local_results(jobs, batch.workers, batch.memory_limit) as rows:
        yield rows


@contextmanager
def _local_results(jobs: Sequence[Job], count: int, memory_limit: float) -> Iterator[Iterator[Row]]:
    """The rows of jobs by processes of this machine, each fed by a thread."""
    waiting: queue.SimpleQueue[Job] = queue.SimpleQueue()
    done: queue.SimpleQueue[Row | BaseException] = queue.SimpleQueue()
    for job in jobs:
        waiting.put(job)
    workers, stopped = [Worker(memory_limit) for _ in range(min(count, len(jobs)))], threading.Event()

    def feed(worker: Worker) -> None:
        try:
            while not stopped.is_set():
                done.put(worker.run(waiting.get_nowait()))
        except queue.Empty:
            pass
        except BaseException as error:  # told where it can be handled
            if not stopped.is_set():
                done.put(error)
        finally:
            worker.kill()

    threads = [threading.Thread(target=feed, args=(worker,), daemon=True) for worker in workers]
    for thread in threads:
        thread.start()

    def rows() -> Iterator[Row]:
        for _ in jobs:
            row = done.get()
            if isinstance(row, BaseException):
                raise row
            yield row

    try:
        yield rows()
    finally:
        stopped.set()
        for worker in workers:
            worker.stop()
        for thread in threads:
            thread.join()


def _endings(request: Replay) -> tuple[str, ...]:
    if request.from_format is None:
        return CLIP_ENDINGS
    ending = readable_format(request.from_format).ending
    if not ending:
        raise InputError(f"{request.from_format} is a format of folders; a batch is of files")
    return (ending,)


def _claim_folder(batch: Batch) -> None:
    """Note in the library's folder what its clips are danced with; the same has to hold when it is resumed.

    Raises:
        InputError: another library is there.
    """
    path, options = batch.out / OPTIONS_FILE, _options(batch)
    if not path.exists():
        if any(not file.name.startswith(".") for file in batch.out.iterdir()):
            raise InputError(f"{batch.out}: not empty, and no library of `sot batch`; name another folder")
        with atomic_write(path) as place:
            place.write_text(json.dumps(options, indent=2) + "\n", encoding="utf-8")
        return
    try:
        had = json.loads(read_text(path))
        other = [f"{name} {had[name]!r} and not {value!r}" for name, value in options.items() if had[name] != value]
    except (ValueError, KeyError, TypeError):
        raise InputError(f"{path}: cannot be read; name another folder") from None
    if other:
        raise InputError(f"{batch.out}: a library made with {', '.join(other)}; name another folder")


def _options(batch: Batch) -> dict[str, Any]:
    told = asdict(replace(batch.request, clip=""))
    options: dict[str, Any] = json.loads(json.dumps(told | {"formats": batch.formats}, default=str))
    return options
