"""The study of Dariush 2009: what its experiments find on made-up motions, and that the study runs."""

import json

import numpy as np
import pytest

from scenarios import cli
from scenarios.dariush2009.experiments import confidence_figures, gain_figures, limit_runs, priority_runs
from scenarios.dariush2009.velocity_runs import follow_by_velocities
from scenarios.hammam2015.key_point_reference import RATE, KeyPointReference, key_point_reference
from scenarios.hammam2015.pictures import arm_distances
from sot.control.tick import Tick
from sot.motion.human.key_points import KEY_POINTS
from sot.robots.robot import Robot
from tests.sot.motion.human.humans import dancer


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def reference(robot):
    human = dancer(1.0)
    return key_point_reference(human.slice(0.0, 0.5), robot)


def rest_with(robot, name, target):
    """Key points at rest, but for one that goes to a target within a second."""
    tick, times = Tick(robot), np.arange(0.0, 1.5, 1.0 / RATE)
    places = {key: np.tile(tick.frame(key).position, (len(times), 1)) for key in KEY_POINTS}
    share = np.clip(times, 0.0, 1.0)[:, None]
    places[name] = (1.0 - share) * places[name] + share * np.asarray(target)
    return KeyPointReference.through(times, places)


def test_a_higher_gain_lowers_a_points_own_error(robot, reference):
    figures = gain_figures(robot, reference)
    for name, own in figures.items():
        assert own[name] == min(of[name] for of in figures.values())


def test_exact_null_spaces_keep_priorities_and_damped_ones_do_not(robot, reference):
    figures = {name: found.figures["waist"] for name, found in priority_runs(robot, reference).items()}
    assert figures["Algorithm 1, exact"] < figures["augmentation"] < figures["Algorithm 1"]


def test_confidence_belongs_into_the_weights(robot, reference):
    wrists = {kind: found["wrists"] for kind, found in confidence_figures(robot, reference).items()}
    assert wrists["weight"] < 0.6 * wrists["gain"] and wrists["weight"] < 0.6 * wrists["unsaid"]


def test_the_weight_of_14_keeps_a_range(robot):
    runs = limit_runs(robot, rest_with(robot, "right_wrist", [-0.5, -0.2, 0.9]), robot.lower, robot.upper)
    assert runs.figures["with"]["beyond_rad"] < 0.0 < runs.figures["without"]["beyond_rad"]


def test_shapes_are_kept_apart_where_a_wrist_is_asked_into_the_trunk(robot):
    reference = rest_with(robot, "right_wrist", [0.0, 0.1, 0.95])
    parts = {"arm": ("right_arm", None)}
    least = {}
    for keep in (False, True):
        run = follow_by_velocities(robot, reference, [("waist", "right_wrist")], keep_apart=keep)
        least[keep] = arm_distances(robot, run.times, run.q, parts)[1]["arm"].min()
    assert least[False] < -0.01 and least[True] > 0.0


@pytest.mark.slow
def test_the_study_writes_its_figures_and_pictures(tmp_path):
    options = ["--clip", "groove", "--duration", "0.5", "--out", str(tmp_path / "d")]
    assert cli.main(["run", "dariush", *options]) == 0
    report = json.loads((tmp_path / "d" / "report.json").read_text("utf-8"))
    assert {"gains", "priorities", "limits", "collisions", "velocities", "confidence"} <= set(report)
    pictures = {path.name for path in (tmp_path / "d").glob("*.svg")}
    assert pictures == {"blending.svg", "distances.svg", "limits.svg", "priorities.svg"}


def test_a_study_without_physics_takes_no_rate(tmp_path, capsys):
    assert cli.main(["run", "dariush", "--rate", "500", "--out", str(tmp_path / "d")]) == 2
    assert "it takes no options but --clip, --start, --duration and --out" in capsys.readouterr().err
    assert not (tmp_path / "d").exists()
