"""Streams of rerun that give back all their memory when they are closed, however many a process opens.

Rerun's own `save` keeps 0.6 to 3 MB and two threads of every blueprint that it is given: the blueprint's stream holds
a sink in memory that holds the stream. Closing that stream parts them, but `save` does not hand it out.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import rerun as rr
import rerun.blueprint as rrb
import rerun_bindings

APPLICATION = "humanoid-sot"


@contextmanager
def open_stream(path: Path, blueprint: rrb.Blueprint) -> Iterator[rr.RecordingStream]:
    """A stream into a file (`.rrd`) that opens with the blueprint; closed when this is left."""
    rerun_bindings.flush_and_cleanup_orphaned_recordings()  # those that were closed and are referred to no more
    stream = rr.RecordingStream(APPLICATION)
    with _stored_blueprint(blueprint) as storage:
        rerun_bindings.save(path=str(path), default_blueprint=storage, recording=stream.to_native())
    try:
        yield stream
    finally:
        stream.disconnect()


@contextmanager
def _stored_blueprint(blueprint: rrb.Blueprint) -> Iterator[rerun_bindings.PyMemorySinkStorage]:
    """A blueprint as rerun's `create_in_memory_blueprint` stores it, in a stream that is closed when this is left."""
    stream = rr.RecordingStream._from_native(
        rerun_bindings.new_blueprint(APPLICATION, make_default=False, make_thread_default=False)
    )
    try:
        stream.set_time("blueprint", sequence=0)
        blueprint._log_to_stream(stream)
        yield stream.memory_recording().storage
    finally:
        stream.disconnect()
