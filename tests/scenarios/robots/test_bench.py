"""The table of robots: each with its dances, and what one of its size may be off."""

from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from scenarios.replay import Replay
from scenarios.robots.bench import CLIP_PIECES, JOINTS_COLUMN, allowed_mm, bench_robots, robot_pieces, show_robots
from sot.errors import InputError
from sot.robots.robot import Robot, robot_names


def test_every_robot_dances_every_clip(tmp_path):
    for piece in CLIP_PIECES:
        (tmp_path / piece.clip).touch()
    pieces = robot_pieces(tmp_path)
    assert len(pieces) == 4 * len(robot_names())
    assert {piece.robot for piece in pieces} == set(robot_names())
    request = pieces[2].request(Replay("", rate=500.0))
    assert (request.robot, request.feet, request.duration, request.rate) == ("g1", "auto", 20.0, 500.0)
    assert [piece.name for piece in robot_pieces(None, ["hrp2"])] == ["hrp2 groove"]
    (tmp_path / CLIP_PIECES[0].clip).unlink()
    with pytest.raises(InputError, match="no such clip"):
        robot_pieces(tmp_path)


def test_a_row_says_how_far_off_the_robot_is_and_may_be(tmp_path):
    piece = replace(robot_pieces(None, ["hrp2"])[0], start=1.0, duration=0.2)
    table = bench_robots(Replay("", rate=200.0), [piece], None, lambda what, share: None)
    row = table["rows"][0]
    assert row["success"] and row["allowed_mm"] == pytest.approx(15.0, abs=0.3)  # legs of 0.6 m
    assert row["tracking.mpjpe_mm"] < row["allowed_mm"]
    assert row["solver.infeasible_ticks"] == 0 and JOINTS_COLUMN in row
    console = Console(file=StringIO(), width=250)
    show_robots(table, console)
    assert "hrp2 groove" in console.file.getvalue() and "1 of 1" in console.file.getvalue()
    assert allowed_mm(Robot.load("hrp2_modified")) == pytest.approx(allowed_mm(Robot.load("hrp2")))
