"""What the command line may say about HumanoidBench's scenes."""

import pytest

from scenarios import cli
from scenarios.humanoidbench.humanoidbench import BenchTrial
from scenarios.humanoidbench.options import bench_options


def test_a_scene_has_a_seed() -> None:
    assert bench_options("otani", "box", 3) is None
    assert bench_options("humanoidbench", "push", None) == BenchTrial("push", 1)
    assert bench_options("humanoidbench", "door", 4) == BenchTrial("door", 4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "say which scene, push or package or door, not ''"),
        (["shelf"], "say which scene, push or package or door, not 'shelf'"),
        (["push", "--seed", "-1"], "--seed -1: give 0 or more"),
        (["push", "--mass", "3"], "humanoidbench takes no --mass"),
        (["push", "--clip", "groove"], "motions of its own"),
    ],
)
def test_what_makes_no_sense_is_one_line_and_leaves_nothing(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["run", "humanoidbench", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1
    assert not list(tmp_path.iterdir())
