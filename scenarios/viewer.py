"""Opening a recording: in a window, or in the browser."""

import os
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from time import perf_counter, sleep
from urllib.parse import quote

import rerun as rr

from sot.errors import InputError

HOST = "127.0.0.1"
STARTING_TIME = 20.0
"""Time that rerun's server may take to start [s]."""


def has_display() -> bool:
    """Whether there is a display to open a window on."""
    return sys.platform != "linux" or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def check_display() -> None:
    """Check that there is a display to open a window on.

    Raises:
        InputError: there is none.
    """
    if not has_display():
        raise InputError("no display to open a window on: `sot view --web` shows a recording in a browser")


def open_in_window(path: Path) -> bool:
    """Open a recording in rerun's viewer; returns whether that went well, once its window is closed.

    Raises:
        InputError: there is no display.
    """
    check_display()
    return subprocess.run([sys.executable, "-m", "rerun", str(path)], check=False).returncode == 0


def serve_to_browser(path: Path, tell: Callable[[str], object]) -> None:
    """Open a recording in the browser, which fetches it as one file, and serve it until interrupted.

    Rerun's own way, a stream of messages, takes up to twice as long to take in.

    Args:
        path: the recording.
        tell: told where the recording is served.
    """
    with file_server(path) as served:
        url = file_url(served, path)
        rr.serve_web_viewer(web_port=0, connect_to=url)
        tell(url)
        try:
            served.serve_forever()
        except KeyboardInterrupt:
            return


@contextmanager
def stream_server() -> Iterator[tuple[str, str]]:
    """Rerun's server on this machine, as long as the context lasts: where to send a stream, and the page that shows it.

    Rerun's own call to serve a stream listens to the whole network.

    Raises:
        InputError: it does not start.
    """
    into, page = _free_port(), _free_port()
    ports = ["--bind", HOST, "--port", str(into), "--web-viewer-port", str(page)]
    none = subprocess.DEVNULL
    command = [sys.executable, "-m", "rerun", "--serve-web", *ports]
    server = subprocess.Popen(command, stdin=none, stdout=none, stderr=none, start_new_session=True)
    try:
        began = perf_counter()
        while not (_listens(into) and _listens(page)):
            if server.poll() is not None or perf_counter() - began > STARTING_TIME:
                raise InputError("rerun's server does not start; without --view nothing is shown, but all is recorded")
            sleep(0.1)
        proxy = f"rerun+http://{HOST}:{into}/proxy"
        yield proxy, f"http://{HOST}:{page}/?url={quote(proxy, safe=':/')}"
    finally:
        if server.poll() is None:
            os.killpg(server.pid, signal.SIGTERM)  # the module is a wrapper: its child is the server
        server.wait()


def _free_port() -> int:
    with closing(socket.socket()) as one:
        one.bind((HOST, 0))
        return int(one.getsockname()[1])


def _listens(port: int) -> bool:
    with closing(socket.socket()) as one:
        return one.connect_ex((HOST, port)) == 0


def file_server(path: Path) -> ThreadingHTTPServer:
    """A server, to be run, of one file to pages of any origin on this machine, at a port that is free."""
    return ThreadingHTTPServer((HOST, 0), partial(_OneFile, path))


def file_url(served: ThreadingHTTPServer, path: Path) -> str:
    """URL of the file that a server serves."""
    return f"http://{HOST}:{served.server_address[1]}/{quote(path.name)}"


class _OneFile(BaseHTTPRequestHandler):
    def __init__(self, path: Path, *given: object) -> None:
        self._file = path
        super().__init__(*given)  # type: ignore[arg-type]

    def do_GET(self) -> None:
        if self.path != f"/{quote(self._file.name)}":
            self.send_error(404)
            return
        with self._file.open("rb") as content:
            self.send_response(200)
            self.send_header("Content-Type", "application/octet-stream")
            self.send_header("Content-Length", str(self._file.stat().st_size))
            self.send_header("Access-Control-Allow-Origin", "*")
            self.end_headers()
            shutil.copyfileobj(content, self.wfile)

    def log_message(self, *_: object) -> None:
        """Not a word on a terminal that waits for nothing but Ctrl-C."""
