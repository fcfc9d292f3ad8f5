"""The study of resolved acceleration: its reference, its runs, what they violate, and the torque law."""

import json
from pathlib import Path

import numpy as np
import pytest

from scenarios import cli
from scenarios.hammam2015.figures import run_figures, violation_histogram
from scenarios.hammam2015.key_point_reference import RATE, ClipPart, KeyPointReference, key_point_reference
from scenarios.hammam2015.kinematic_run import follow_key_points
from scenarios.hammam2015.methods import METHODS, TASK_SETS
from scenarios.hammam2015.torque_law import torque_law_run
from sot.control.tick import Tick
from sot.motion.human.key_points import KEY_POINTS, UpperBodyLengths
from sot.robots.robot import Robot
from tests.sot.motion.human.humans import dancer

MOCAP = Path(__file__).parents[4] / "shared" / "mocap"


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


@pytest.fixture(scope="module")
def reference(robot):
    return key_point_reference(dancer(1.0), robot)


def wrists_through_the_trunk(robot):
    """Key points at rest, but for wrists that pass through the trunk to the other side, and on beyond all reach."""
    tick, times = Tick(robot), np.arange(0.0, 2.0, 1.0 / RATE)
    rest = {name: tick.frame(name).position.copy() for name in KEY_POINTS}
    places = {name: np.tile(place, (len(times), 1)) for name, place in rest.items()}
    share = np.clip(times, 0.0, 1.0)[:, None]
    for side, sign in (("left", -1.0), ("right", 1.0)):
        places[f"{side}_wrist"] = (1.0 - share) * rest[f"{side}_wrist"] + share * [-0.3, sign * 0.5, 1.0]
    return KeyPointReference.through(times, places)


def test_the_reference_has_the_robots_lengths_and_starts_at_its_rest(robot, reference):
    tick = Tick(robot)
    rest = {name: tick.frame(name).position for name in KEY_POINTS}
    for name in KEY_POINTS:
        np.testing.assert_allclose(reference.positions[name][0], rest[name], atol=1e-9)
    last = {name: place[-1] for name, place in reference.positions.items()}
    assert UpperBodyLengths.of(last).__dict__ == pytest.approx(UpperBodyLengths.of(rest).__dict__)
    sampled = reference.of(("waist", "head"))(0.5)
    np.testing.assert_allclose(sampled.positions[1], reference.positions["head"][50])
    slope = RATE / 2.0 * (reference.positions["head"][51] - reference.positions["head"][49])
    np.testing.assert_allclose(sampled.velocities[1], slope, atol=0.01)


@pytest.mark.parametrize("name", ["CRAC mended", "CCLIK mended", "cascade"])
def test_wrists_that_are_asked_through_the_trunk_violate_nothing(robot, name):
    run = follow_key_points(robot, METHODS[name], wrists_through_the_trunk(robot), 2)
    assert not run.ran_away and not run.violations.any()
    assert run.foot_errors.max() < 0.005
    figures = run_figures(run, 60.0)
    assert figures["clean"] == 1.0 and figures["beyond_rad"] < 0.0 < figures["nearest_m"]
    assert violation_histogram(run) == [len(run.times)]


@pytest.mark.parametrize("name", ["no constraints", "CRAC as printed"])
def test_without_constraints_and_as_printed_they_do(robot, name):
    run = follow_key_points(robot, METHODS[name], wrists_through_the_trunk(robot), 2)
    figures = run_figures(run, 60.0)
    assert run.ran_away or figures["clean"] < 0.9
    assert sum(violation_histogram(run)) == len(run.times) and len(violation_histogram(run)) > 1


def test_redundancy_helps_tracking_hammam_5(robot, reference):
    errors = {s: run_figures(follow_key_points(robot, METHODS["CRAC mended"], reference, s), 60.0) for s in TASK_SETS}
    assert errors[3]["wrist_rms_m"] < 0.01 and errors[2]["wrist_rms_m"] < errors[1]["wrist_rms_m"]


@pytest.mark.slow
def test_the_torque_law_stands_below_a_balance(robot):
    reference = key_point_reference(dancer(1.0), robot)
    found = torque_law_run(robot, reference, "below balance", 500.0)
    assert found["fell_at_s"] is None and found["beyond_rad"] < 0.0 and found["points_rms_m"] < 0.05


@pytest.mark.slow
def test_the_study_writes_its_figures_and_pictures(tmp_path):
    options = ["--clip", "groove", "--duration", "0.5", "--rate", "500", "--out", str(tmp_path / "h")]
    assert cli.main(["run", "hammam", *options]) == 0
    report = json.loads((tmp_path / "h" / "report.json").read_text("utf-8"))
    assert set(report["summary"]) == {"1", "2", "3"} and set(report["summary"]["1"]) == set(METHODS)
    pictures = {path.name for path in (tmp_path / "h").glob("*.svg")}
    assert pictures == {"distances.svg", "joints.svg", "powers.svg", "tracking.svg", "violations.svg"}


@pytest.mark.parametrize(
    ("options", "words"),
    [(["--start", "3"], "name the clip"), (["--robot", "hrp2_modified"], "takes no options but --clip")],
)
def test_what_the_study_does_not_take_is_refused(options, words, tmp_path, capsys):
    assert cli.main(["run", "hammam", *options, "--out", str(tmp_path / "h")]) == 2
    assert words in capsys.readouterr().err and not (tmp_path / "h").exists()


@pytest.mark.slow
@pytest.mark.skipif(not MOCAP.is_dir(), reason="no captures at hand")
@pytest.mark.parametrize("clip", ["perfume_A", "perfume_B", "bandai_punch", "bandai_walk"])
@pytest.mark.parametrize("task_set", list(TASK_SETS))
def test_captured_clips_violate_nothing(robot, clip, task_set):
    human = ClipPart(str(MOCAP / f"{clip}.bvh"), 0.0, 6.0).human()
    reference = key_point_reference(human, robot)
    mended, cascade = (
        follow_key_points(robot, METHODS[name], reference, task_set) for name in ("CRAC mended", "cascade")
    )
    assert np.mean(mended.violations == 0) >= 0.995 and not cascade.violations.any()
