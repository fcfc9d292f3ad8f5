"""The benchmark: phases that add up, ratios that do not depend on the machine, and files that are no benchmark."""

import copy
import io
import json

import pytest
from rich.console import Console

from scenarios import bench_command, cli
from scenarios.bench import benchmark_figures, read_figures, show
from scenarios.peers import read_peer_figures
from scenarios.replay import Replay
from sot.errors import InputError


@pytest.fixture(scope="module")
def figures():
    return benchmark_figures(Replay("groove", duration=0.3), lambda what, share: None)


def shown(figures, against=None) -> str:
    text = io.StringIO()
    show(figures, Console(file=text, width=120), against)
    return text.getvalue()


def test_phases_add_up_to_the_tick(figures):
    times = figures["tick_us"]
    assert sum(times[phase]["mean"] for phase in ("model", "assemble", "solve", "rest")) == pytest.approx(
        times["whole"]["mean"]
    )
    for phase in times.values():
        assert 0.0 < phase["p50"] <= phase["p95"] <= phase["p99"]


def test_times_the_machine_and_the_dance(figures):
    assert figures["ticks"] == 2300  # with a second of lead and one of rest
    assert figures["fell"] is False
    assert figures["real_time_factor"] > 0.0
    assert figures["retarget_frames_per_s"] > 0.0
    assert all(time > 0.0 for time in figures["reference_us"].values())


def test_a_slower_machine_is_no_slower_controller(figures):
    slow = copy.deepcopy(figures)
    for times in slow["tick_us"].values():
        for key in times:
            times[key] *= 2.0
    slow["reference_us"]["interleaved"] *= 2.0
    line = next(line for line in shown(slow, figures).splitlines() if line.startswith("tick, median"))
    assert line.split()[-2:] == ["2.00", "1.00"]


def test_says_all_phases(figures):
    text = shown(figures)
    for word in ("whole", "model", "assemble", "solve", "rest", "p95", "frames/s"):
        assert word in text


def test_reads_what_it_has_written(figures, tmp_path):
    path = tmp_path / "bench.json"
    path.write_text(json.dumps(figures))
    assert read_figures(path) == figures


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"tick_us": 3}', "\0"])
def test_refuses_other_files(text, tmp_path, capsys):
    path = tmp_path / "other.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"other\.json: (not the figures of a benchmark|a binary file)"):
        read_figures(path)
    assert cli.main(["bench", "--against", str(path)]) == cli.BAD_INPUT
    assert capsys.readouterr().err.count("\n") == 1


def test_peers_stand_in_the_same_table(figures, tmp_path, capsys, monkeypatch):
    times = {"p50": 200.0, "p95": 250.0, "p99": 300.0, "mean": 210.0}
    peer = {"name": "a peer", "tick_us": {"whole": times}, "reference_us": 60.0}
    path = tmp_path / "peer.json"
    path.write_text(json.dumps(peer | {"ticks": 3}))
    monkeypatch.setattr(bench_command, "benchmark_figures", lambda request, tell: figures)
    assert cli.main(["bench", "--peer", str(path)]) == cli.DONE
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    row = lines[lines.index("a peer") + 1]
    assert row.split() == ["whole", "200", "250", "300", "210", "3.50"]
    assert cli.main(["bench", "--peer", str(path), "--json"]) == cli.DONE
    assert json.loads(capsys.readouterr().out) == figures | {"peers": [peer]}
    assert cli.main(["bench", "--peer", str(path), "--against", str(path)]) == cli.BAD_INPUT


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"name": "x", "tick_us": {"whole": 3}, "reference_us": 1}'])
def test_refuses_what_is_no_peer(text, tmp_path):
    path = tmp_path / "other.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"other\.json: not the figures of a peer"):
        read_peer_figures(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_peer_figures(tmp_path / "absent.json")


def test_prints_json(figures, capsys, monkeypatch):
    monkeypatch.setattr(bench_command, "benchmark_figures", lambda request, tell: figures)
    assert cli.main(["bench", "--json"]) == cli.DONE
    assert json.loads(capsys.readouterr().out) == figures
