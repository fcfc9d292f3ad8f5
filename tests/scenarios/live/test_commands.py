"""Bad input to `sot live` and `sot stream` is one line and exit status 2."""

import socket

import pytest

from scenarios.cli import main
from scenarios.live.session import LiveRequest, open_source
from scenarios.live.streaming import part_of
from scenarios.terminal import BAD_INPUT
from sot.errors import InputError
from sot.robots.robot import Robot
from tests.sot.live.streams.clips import groove


def refusal(capsys, *arguments):
    assert main(arguments) == BAD_INPUT
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("live", "ftp://127.0.0.1"), "unknown stream; choose one of udp://, vmc://, rokoko://"),
        (("live", "nobody"), "nobody"),
        (("live", "groove", "--token", "x"), "are for streams"),
        (("live", "vmc://127.0.0.1:0", "--token", "x"), "knows no token"),
        (("live", "udp://0.0.0.0:0"), "--bind"),
        (("live", "groove", "--mapping", "nowhere.toml"), "nowhere.toml"),
        (("live", "udp://127.0.0.1:0", "--robot", "nobody"), "unknown robot"),
        (("stream", "groove", "--to", "groove"), "unknown stream"),
        (("stream", "groove", "--to", "udp://127.0.0.1:9", "--start", "99"), "nothing from 99 s"),
    ],
)
def test_bad_input(capsys, tmp_path, arguments, says):
    out = ("--out", str(tmp_path / "out")) if arguments[0] == "live" else ()
    assert says in refusal(capsys, *arguments, *out)
    assert not (tmp_path / "out").exists()


def test_a_port_in_use(capsys, tmp_path):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        url = f"udp://127.0.0.1:{taken.getsockname()[1]}"
        assert "cannot listen" in refusal(capsys, "live", url, "--out", str(tmp_path / "out"))


def test_a_wrong_token(capsys):
    source = open_source(LiveRequest("udp://127.0.0.1:0", token="right"), Robot.load("hrp2"))
    try:
        import threading

        stop = threading.Event()

        def listen():
            now = 0.0
            while not stop.wait(0.02):
                now += 0.02
                source.poll(now)

        listener = threading.Thread(target=listen)
        listener.start()
        line = refusal(
            capsys, "stream", "groove", "--duration", "2", "--to", f"udp://127.0.0.1:{source.port}", "--token", "wrong"
        )
        assert "another token" in line
        assert source.counts["wrong token"] > 0
    finally:
        stop.set()
        listener.join()
        source.close()


def test_a_part_of_a_clip():
    part = part_of(groove(), 2.0, 1.0)
    assert part.duration == pytest.approx(1.0)
    with pytest.raises(InputError):
        part_of(groove(), 2.0, 0.0)
