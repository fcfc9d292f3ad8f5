"""Stairs are climbed under physics, soles wholly on their treads; what cannot be climbed is told."""

import json

import numpy as np
import pytest

from scenarios.cli import main
from scenarios.stairs.options import stairs_options
from scenarios.stairs.stairs import Stairs
from sot.errors import InputError
from sot.robots.robot import Robot


def test_treads_go_up_and_down_again():
    robot = Robot.load("hrp2")
    tops = [thing.surface("top").corners_at_point for thing in Stairs(rise=0.05, treads=3).things(robot)]
    np.testing.assert_allclose([top[0, 2] for top in tops], [0.05, 0.1, 0.15, 0.1, 0.05], atol=1e-12)
    starts = [top[:, 0].min() for top in tops]
    np.testing.assert_allclose(np.diff(starts), 0.3, atol=1e-12)
    noisy = Stairs(treads=1).things(robot, np.array([0.004]))[0].surface("top").corners_at_point
    assert noisy[0, 2] == pytest.approx(0.104)


def test_treads_of_a_ramp_go_on_where_the_last_one_ends():
    robot = Robot.load("hrp2")
    tops = [thing.surface("top") for thing in Stairs(rise=0.0, treads=3, slope=0.15).things(robot)]
    starts, ends = ([round(side, 9) for side in sides] for sides in zip(*(_extent(top) for top in tops), strict=True))
    assert starts[1:] == ends[:-1]
    edges = np.array([*starts, ends[-1]])
    heights = [float(top.height_at(np.array([x, 0.0]))) for top, x in zip(tops, edges[:-1], strict=True)]
    np.testing.assert_allclose(heights, 0.3 * np.tan(0.15) * np.array([0, 1, 2, 2, 1]), atol=1e-9)
    assert [float(np.sign(np.round(top.tilt[1], 9))) for top in tops] == [-1.0, -1.0, 0.0, 1.0, 1.0]


def _extent(top):
    corners = top.corners_at_point
    return corners[:, 0].min(), corners[:, 0].max()


def test_options_are_of_stairs_alone():
    assert stairs_options("sliding", None, None, None, None, 3) is None
    assert stairs_options("stairs", 0.05, None, 2, None, 1) == Stairs(rise=0.05, treads=2, seed=1)
    ramp = stairs_options("stairs", None, None, None, 10.0, None)
    assert (ramp.rise, ramp.slope) == (0.0, pytest.approx(np.radians(10.0)))
    for given, words in (
        ((0.05, None, None, None), "--rise"),
        ((None, None, 3, None), "--treads"),
        ((None, None, None, 0.0), "--slope"),
    ):
        with pytest.raises(InputError, match=f"sliding takes no {words}"):
            stairs_options("sliding", *given, None)
    for given, words in (
        ((-0.1, None, None, None), "--rise"),
        ((None, 3.0, None, None), "--depth"),
        ((None, None, 0, None), "--treads"),
        ((None, None, None, -8.0), "--slope"),
    ):
        with pytest.raises(InputError, match=words):
            stairs_options("stairs", *given, None)


def test_a_ramp_too_steep_for_soles_is_refused_before_anything_is_written(tmp_path, capsys):
    assert main(["run", "stairs", "--slope", "25", "--out", str(tmp_path / "run")]) == 2
    assert "slopes by 25°, and soles hold on 17°" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_treads_too_short_for_the_soles_are_refused_before_anything_is_written(tmp_path, capsys):
    assert main(["run", "stairs", "--depth", "0.15", "--out", str(tmp_path / "run")]) == 2
    assert "too small for the soles" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["hrp2", "jvrc1"])
def test_a_tread_is_climbed_and_left_with_heights_told_wrong(tmp_path, robot):
    arguments = ["--treads", "1", "--rate", "500", "--seed", "1", "--robot", robot, "--out", str(tmp_path)]
    assert main(["run", "stairs", *arguments]) == 0
    found = json.loads((tmp_path / "report.json").read_text())
    assert not found["fell"] and found["stairs"]["treads_stood_on"] == 1
    assert found["stairs"]["edge_margin_min_m"] > 0.0
    assert found["contacts"]["slip_max_m"] < 0.01


def test_a_part_without_a_clip_is_refused(tmp_path, capsys):
    assert main(["run", "stairs", "--start", "2", "--out", str(tmp_path / "run")]) == 2
    assert "name the one that --start and --duration are of" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("clip", "on_one", "on_both", "scene"),
    [
        ("walk_stairs", 7, 7, ()),
        ("walk_stairs_over", 7, 0, ()),
        ("walk_ramp", 6, 6, ("--slope", "8", "--treads", "4", "--depth", "0.4")),
    ],
)
def test_who_climbs_is_followed_with_heights_told_wrong(tmp_path, clip, on_one, on_both, scene):
    assert main(["run", "stairs", "--clip", clip, *scene, "--rate", "500", "--seed", "2", "--out", str(tmp_path)]) == 0
    found = json.loads((tmp_path / "report.json").read_text())
    assert not found["fell"] and found["contacts"]["slip_max_m"] < 0.01
    assert found["stairs"]["treads_stepped_on"] == on_one and found["stairs"]["treads_stood_on"] == on_both
    assert found["stairs"]["edge_margin_min_m"] > 0.0
    assert any(remark.endswith("the robot steps on what the scene has there.") for remark in found["remarks"])
