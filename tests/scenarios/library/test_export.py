"""`sot export` of a run, and `sot replay --from` of what it wrote."""

import json
from pathlib import Path

import numpy as np
import pytest

from scenarios import cli
from scenarios.replay import REPORT_FILE, SIMULATED_FILE, Replay, dance, write_outputs
from sot.exchange.registry import FORMATS, read_motion
from sot.exchange.simulated_motion import SimulatedMotion
from sot.robots.robot import Robot

WRITTEN = [name for name, one in FORMATS.items() if one.write is not None]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "short"
    tell = lambda what, share: None  # noqa: E731
    write_outputs(dance(Replay("groove", duration=0.1, rate=200.0), tell), folder, tell)
    return folder


def test_a_run_leaves_what_it_did(run):
    simulated = SimulatedMotion.load(run / SIMULATED_FILE)
    assert simulated.rate == pytest.approx(200.0) and simulated.facts["licence"] == "CC0 1.0"
    assert simulated.contact.all() and (simulated.friction_margin > 0.0).all()
    weight = simulated.wrench[:, :, 2].sum(axis=1).mean()
    assert weight == pytest.approx(9.81 * Robot.load("hrp2").mass, rel=0.02)
    assert np.nanmin(simulated.zmp_margin) > 0.0


def test_all_formats_at_once_each_with_a_card(run, tmp_path, capsys):
    out = tmp_path / "out"
    assert cli.main(["export", str(run), "--to", ",".join(WRITTEN), "-o", str(out), "--fps", "50"]) == cli.DONE
    assert capsys.readouterr().out.count("Written:") == len(WRITTEN)
    robot = Robot.load("hrp2")
    wanted = SimulatedMotion.load(run / SIMULATED_FILE).motion(robot, "groove").resampled(50.0)
    for name in WRITTEN:
        one, folder = FORMATS[name], out / name
        assert {path.name for path in folder.iterdir()} == {f"groove{one.ending}", "groove.card.md"}
        assert "CC0 1.0" in (folder / "groove.card.md").read_text()
        if one.read is not None:
            rate = 50.0 if name.endswith("csv") else None
            back = read_motion(folder / f"groove{one.ending}", name, robot, rate)
            assert np.abs(back.q[:, :3] - wanted.q[:, :3]).max() < 1e-6
            assert np.abs(back.q[:, 7:] - wanted.q[:, 7:]).max() < 1e-6


def test_again_and_into_the_runs_own_folder(run, capsys):
    for _ in range(2):
        assert cli.main(["export", str(run), "--to", "any4hdmi, lerobot"]) == cli.DONE
    assert sorted(path.name for path in (run / "exports" / "lerobot").iterdir()) == ["groove", "groove.card.md"]


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["export", "nowhere", "--to", "lerobot"], "no run"),
        (["export", "RUN", "--to", "fbx"], "choose one of"),
        (["export", "RUN", "--to", "sot-npz"], "not exported"),
        (["export", "RUN", "--to", "lerobot", "--fps", "29.97"], "whole number"),
        (["export", "RUN", "--to", "lerobot", "--robot", "g1"], "another robot"),
        (["replay", "RUN/simulated.npz", "--from", "gmr-pickle"], "cannot be read"),
        (["replay", "RUN/simulated.npz", "--from", "sot-npz", "--up", "y"], "--up"),
        (["replay", "RUN/simulated.npz", "--from", "contact-labels"], "holds no motion"),
        (["replay", "RUN/nothing.csv", "--from", "unitree-csv", "--fps", "30"], "no such file"),
        (["replay", "groove", "--fps", "30"], "--from"),
    ],
)
def test_bad_requests_are_one_line(arguments, words, run, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main([word.replace("RUN", str(run)) for word in arguments]) == cli.BAD_INPUT
    said = capsys.readouterr().err
    assert words in said and said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_robots_motion_is_danced_again(run, tmp_path, capsys):
    out = tmp_path / "again"
    arguments = ["--from", "sot-npz", "--start", "0.9", "--duration", "0.2", "--rate", "200", "--out", str(out)]
    assert cli.main(["replay", str(run / SIMULATED_FILE), *arguments]) == cli.DONE
    report = json.loads((out / REPORT_FILE).read_text())
    assert report["incoming"]["self_collision"] == 0.0 and report["incoming"]["limmt_score"] > 90.0
    assert report["quality"]["limmt_score"] > 90.0 and report["quality"]["r_mpkpe_mm"] < 20.0
    assert report["likeness"]["segment_deg"] < 8.0
