"""Edited dances under physics: what is asked for happens, and without edits all is as before, to the last bit."""

import json

import numpy as np
import pytest

from scenarios import replay
from scenarios.replay import REPORT_FILE, TIMELINE_FILE, Replay, dance
from sim.reporting.figures import Points
from sot.motion.trajectory import Motion

EDITS = """
[[edit]]
point = "right_hand"
axis = "z"
by = 0.12
from = 0.4
to = 2.0

[[edit]]
joint = "HEAD0"
through = [[0.9, 20], [1.3, -20]]
"""


@pytest.fixture(scope="module")
def clip(tmp_path_factory):
    """A motion that is planned once."""
    file = tmp_path_factory.mktemp("clip") / "groove.npz"
    replay.retarget(Replay("groove", duration=1.2, rate=250.0), file, lambda what, share: None)
    return file


@pytest.fixture(scope="module")
def plain(clip):
    """The run without edits."""
    return danced(clip).run.log.trimmed()


def request(clip, **options):
    return Replay(str(clip), rate=250.0, **options)


def danced(clip, **options):
    return dance(request(clip, **options), lambda what, share: None)


def test_what_is_asked_for_happens_and_is_told(clip, tmp_path):
    (tmp_path / "edits.toml").write_text(EDITS)
    figures = replay.replay(request(clip, edits=tmp_path / "edits.toml"), tmp_path / "out", lambda what, share: None)
    assert not figures["fell"]
    assert [line.split(":")[0] for line in figures["edits"]] == ["edit 1", "edit 2"]
    assert json.loads((tmp_path / "out" / REPORT_FILE).read_text())["edits"] == figures["edits"]
    picture = (tmp_path / "out" / TIMELINE_FILE).read_text()
    assert "right_hand edited: edit 1" in picture and "balance: Balance" in picture


@pytest.mark.parametrize("limb_only", ["false", "true"])
def test_the_hand_rises_by_what_was_added_and_the_head_meets_its_way_points(clip, tmp_path, limb_only):
    """By the whole body, or by its arm alone."""
    (tmp_path / "edits.toml").write_text(EDITS.replace("by = 0.12", f"by = 0.12\nlimb_only = {limb_only}"))
    run, motion = danced(clip, edits=tmp_path / "edits.toml").run, Motion.load(clip)
    log, robot = run.log.trimmed(), motion.robot
    hand = Points.of(robot, log.q, ("right_hand",)).positions["right_hand"][:, 2]
    raised = hand - motion.track("right_hand").position[: len(hand), 2]
    full = (log.time > 0.75) & (log.time < 1.6)
    np.testing.assert_allclose(raised[full], 0.12, atol=0.006)
    np.testing.assert_allclose(raised[log.time < 0.4], 0.0, atol=0.006)
    joint = robot.joints.index("HEAD0")
    turned = np.rad2deg(log.q[:, 7 + joint] - motion.q[: len(hand), 7 + joint])
    np.testing.assert_allclose(np.interp([0.9, 1.3], log.time, turned), [20.0, -20.0], atol=1.0)
    column = log.level_names.index("right_hand edited: edit 1")
    # After balance, feet and waist.
    assert np.all(log.level_place[full, column] == 4) and np.all(log.level_share[full, column] == 1.0)
    assert np.all(log.level_place[log.time < 0.19, column] == 0)


def test_without_edits_the_run_is_the_unedited_one_tick_for_tick(clip, plain, tmp_path):
    (tmp_path / "none.toml").write_text("# nothing left\n")
    empty = danced(clip, edits=tmp_path / "none.toml").run.log.trimmed()
    for column in ("q", "v", "torque"):
        np.testing.assert_array_equal(getattr(empty, column), getattr(plain, column))


def test_until_an_edit_begins_the_run_is_the_unedited_one_tick_for_tick(clip, plain, tmp_path):
    (tmp_path / "edits.toml").write_text(EDITS)
    edited = danced(clip, edits=tmp_path / "edits.toml").run.log.trimmed()
    before = plain.time < 0.2 - 1e-9  # when its task begins to come
    np.testing.assert_array_equal(edited.torque[before], plain.torque[before])
    assert np.any(edited.torque[~before] != plain.torque[~before])
