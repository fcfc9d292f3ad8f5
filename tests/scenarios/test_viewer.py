"""A browser is given a recording, and nothing else."""

import threading
import urllib.error
import urllib.request
from pathlib import Path

import pytest

from scenarios import cli, viewer


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "a run.rrd"
    path.write_bytes(bytes(range(256)) * 1000)
    (tmp_path / "report.json").write_text("{}")
    return path


def test_serves_the_file_to_any_origin_and_nothing_beside_it(recording):
    with viewer.file_server(recording) as served:
        threading.Thread(target=served.serve_forever, daemon=True).start()
        url = viewer.file_url(served, recording)
        with urllib.request.urlopen(url) as answer:
            assert answer.headers["Access-Control-Allow-Origin"] == "*"
            assert answer.read() == recording.read_bytes()
        for other in ("/report.json", "/", "/../report.json"):
            with pytest.raises(urllib.error.HTTPError, match="404"):
                urllib.request.urlopen(url.rsplit("/", 1)[0] + other)
        served.shutdown()


def test_the_browser_opens_what_is_served_until_interrupted(recording, monkeypatch, capsys):
    opened = []

    def read(**how: object) -> None:
        opened.append(how["connect_to"])

    def interrupted(_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(viewer.rr, "serve_web_viewer", read)
    monkeypatch.setattr(viewer.ThreadingHTTPServer, "serve_forever", interrupted)
    assert cli.main(["view", str(recording), "--web"]) == cli.DONE
    (url,) = opened
    assert url.startswith("http://127.0.0.1:") and url.endswith("/a%20run.rrd")
    assert url in capsys.readouterr().err
