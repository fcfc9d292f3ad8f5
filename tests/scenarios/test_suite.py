"""The table of dances: which clips, what a row says, and that a clip that cannot be danced is a row too."""

import json
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from scenarios import bench_command, cli, suite
from scenarios.inputs.groove import groove_bvh
from scenarios.replay import RECORDING_FILE, REPORT_FILE, Replay
from scenarios.suite import TABLE_FIGURES, Piece, bench_suite, show, suite_pieces
from sot.errors import InputError

PLANTED = Replay("", rate=200.0, feet="planted")


def test_the_long_dance_comes_in_pieces_and_a_folder_s_clips_before_it(tmp_path):
    whole = suite_pieces(None)
    assert [piece.start for piece in whole] == [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 0.0]
    assert [piece.duration for piece in whole[:-1]] == pytest.approx([20.0] * 6 + [11.5])
    assert whole[-1] == Piece("cmu_01_01", "cmu_01_01")
    for name in ("b.amc", "a.bvh", "b.asf"):
        (tmp_path / name).touch()
    assert [piece.name for piece in suite_pieces(tmp_path)[:2]] == ["a", "b"]
    assert suite_pieces(tmp_path)[2:] == whole


def test_an_empty_folder_is_an_error(tmp_path):
    with pytest.raises(InputError, match="no clips"):
        suite_pieces(tmp_path)


def test_rows_of_a_dance_and_of_a_clip_that_is_refused(tmp_path):
    done = bench_suite(
        PLANTED,
        [Piece("short", "groove", 1.0, 0.4), Piece("none", "no such file.bvh")],
        tmp_path / "kept",
        lambda what, share: None,
    )
    danced, refused = done["rows"]
    assert (danced["name"], danced["success"], danced["ending"]) == ("short", True, "upright")
    assert danced["tracking.mpjpe_mm"] < 20.0
    assert danced["speed"] == 1.0
    assert danced["planning_ratio"] > 0.0
    assert all(place in danced and refused[place] is None for place, *_ in TABLE_FIGURES)
    assert not refused["success"]
    assert refused["ending"].startswith("refused: no such file.bvh")
    assert (done["summary"]["clips"], done["summary"]["successes"]) == (2, 1)
    assert done["summary"]["tracking.mpjpe_mm"] == danced["tracking.mpjpe_mm"]
    assert (tmp_path / "kept/short" / RECORDING_FILE).is_file() and (tmp_path / "kept/short" / REPORT_FILE).is_file()
    console = Console(file=StringIO(), width=250)
    show(done, console)
    assert "1 of 2" in console.file.getvalue() and "A success: upright, key bodies" in console.file.getvalue()


@pytest.mark.parametrize(("mpjpe", "segments", "met"), [(9, 9, True), (101, 9, False), (9, 21, False), (9, None, True)])
def test_a_success_is_near_its_reference_and_looks_like_its_human(mpjpe, segments, met):
    row = {"tracking.mpjpe_mm": mpjpe, "likeness.segment_deg": segments}
    assert suite.LIKE_ITS_HUMAN.is_met(row) == met


def test_from_the_command_line(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.bvh").write_text(groove_bvh())
    chosen = suite.suite_pieces(Path())
    monkeypatch.setitem(bench_command.SUITES, "dance", suite.Suite(lambda *given: [chosen[0].part(1.0, 0.2)]))
    status = cli.main(["bench", "--suite", "dance", "--feet", "planted", "--rate", "200", "--json"])
    assert status == cli.DONE
    assert json.loads(capsys.readouterr().out)["rows"][0]["name"] == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["mine.bvh"]


def test_a_suite_on_an_estimated_state_says_how_far_off_it_was(capsys, monkeypatch):
    monkeypatch.setitem(bench_command.SUITES, "dance", suite.Suite(lambda *given: [Piece("short", "groove", 1.0, 0.2)]))
    command = ["bench", "--suite", "dance", "--feet", "planted", "--rate", "200", "--json"]
    assert cli.main([*command, "--state", "estimated", "--sensors", "bmi088"]) == cli.DONE
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    assert row["estimator.way_m"] == 0.0
    assert 0.0 < row["estimator.position_end_m"] < 5e-3 and 0.0 < row["estimator.tilt_rms_deg"] < 0.5


@pytest.mark.parametrize(
    ("told", "answer"),
    [
        (["--state", "estimated"], "add --suite dance"),
        (["--suite", "dance", "--state", "guessed"], "unknown state 'guessed'"),
        (["--suite", "dance", "--sensors", "bmi088"], "add --state estimated"),
    ],
)
def test_a_state_that_cannot_be_had_is_refused(told, answer, capsys):
    assert cli.main(["bench", *told]) == cli.BAD_INPUT
    assert answer in capsys.readouterr().err
