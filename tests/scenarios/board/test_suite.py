"""The board's suite: which clips, in their own time and way, and a row of its columns."""

import json

import pytest

from scenarios import bench_command, cli
from scenarios.board.protocol import MAX_STEPS, RATE_HZ
from scenarios.board.suite import BOARD, COLUMNS, NAMED, ROBOT, SECONDS, board_average, board_pieces
from scenarios.replay import Replay
from scenarios.suite import Piece, bench_suite
from sot.errors import InputError

COMMON = Replay("", ROBOT, rate=250.0, feet="auto", as_danced=True)


def test_clips_of_packages_or_those_of_a_folder_twenty_seconds_of_each(tmp_path):
    own = board_pieces(None, None)
    assert [piece.name for piece in own][-3:] == list(NAMED)
    assert SECONDS * RATE_HZ == MAX_STEPS
    assert {piece.duration for piece in own} == {SECONDS}
    for name in ("b.csv", "a.csv", "c.bvh"):
        (tmp_path / name).touch()
    motions = board_pieces(tmp_path, "unitree-csv")
    assert [piece.name for piece in motions] == ["a", "b"]
    request = motions[0].request(Replay("", "g1", fps=30.0))
    assert (request.from_format, request.fps, request.duration) == ("unitree-csv", 30.0, SECONDS)
    assert board_pieces(tmp_path, None)[0].request(Replay("", fps=30.0)).fps is None
    with pytest.raises(InputError, match="no clips"):
        board_pieces(tmp_path, "gmr-pickle")


def test_means_are_over_steps():
    rows = [
        {"board.completion": 1.0, "board.steps": 100.0, "board.power_w": 50.0},
        {"board.completion": 0.5, "board.steps": 300.0, "board.power_w": 90.0},
        {"board.completion": None, "board.power_w": None},
    ]
    assert board_average("board.completion", rows) == 0.5
    assert board_average("board.power_w", rows) == 80.0
    assert board_average("board.power_w", rows[2:]) is None


@pytest.mark.slow
def test_a_clip_and_one_that_is_refused_have_rows():
    pieces = [Piece("short", "groove", 2.0, 0.6), Piece("none", "no such file.bvh")]
    done = bench_suite(COMMON, pieces, None, lambda what, share: None, BOARD)
    danced, refused = done["rows"]
    assert danced["success"] and danced["board.completion"] == 1.0 and danced["board.steps"] == 31.0
    assert (
        0.0 < danced["board.root_drift_mm"] < 30.0
        and danced["board.loaded_slip_m_s"] <= danced["board.slip_m_s"] < 0.05
    )
    assert 0.0 < danced["board.power_w"] < 96.0 and 0.0 < danced["board.local_mpjpe_mm"] < 50.0
    assert not refused["success"] and all(refused[place] is None for place, *_ in COLUMNS)
    assert done["summary"]["board.completion"] == 0.5
    assert done["summary"]["board.power_w"] == pytest.approx(danced["board.power_w"])


@pytest.mark.parametrize(
    ("told", "answer"),
    [
        (["--suite", "g1"], "dance, g1-reference-tracking"),
        (["--suite", "g1-reference-tracking", "--robot", "talos"], "danced by g1"),
        (["--suite", "dance", "--from", "unitree-csv"], "name the folder with --mocap"),
    ],
)
def test_requests_that_fit_no_suite_are_one_line(told, answer, capsys):
    assert cli.main(["bench", *told]) == cli.BAD_INPUT
    said = capsys.readouterr().err
    assert answer in said and said.count("\n") == 1


def test_the_board_s_robot_dances_in_the_clip_s_own_time(monkeypatch, capsys):
    asked = []

    def bench(request, pieces, out, tell, suite):
        asked.append((request, pieces))
        return {"rows": [], "rule": "", "summary": {"clips": 0, "successes": 0}}

    monkeypatch.setattr(bench_command, "bench_suite", bench)
    assert cli.main(["bench", "--suite", "g1-reference-tracking", "--json"]) == cli.DONE
    ((request, pieces),) = asked
    assert (request.robot, request.as_danced, len(pieces)) == (ROBOT, True, 5)
    assert json.loads(capsys.readouterr().out)["summary"]["clips"] == 0
