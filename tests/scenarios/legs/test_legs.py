import numpy as np
import pytest

from scenarios.inputs.clips import find_clip
from scenarios.legs.legs import MOMENTS, moments_of, panel_of
from scenarios.replay import Replay, dance
from sim.reporting import figures
from sot.motion import read, recognise


def test_the_moments_are_those_of_the_highest_lifts():
    points = recognise(read(find_clip("kick"))).points
    moments = moments_of(points, 50.0)
    assert len(moments) == MOMENTS and (np.diff(moments) >= 30).all()
    for side in ("left", "right"):
        assert int(points[f"{side}_ankle"][:, 2].argmax()) in moments


def test_who_never_lifts_a_foot_is_shown_now_and_then():
    points = recognise(read(find_clip("groove"))).points
    assert len(moments_of(points, 50.0)) == MOMENTS


def test_a_panel_shows_both_bodies_side_by_side():
    points = recognise(read(find_clip("kick"))).points
    panel = panel_of({"dancer": points, "robot": points}, 0, "now", 0.85)
    halves = [[curve for curve in panel.curves if curve.color == color] for color in ("#4a6fa5", "#d9722a")]
    assert len(halves[0]) == len(halves[1]) > 10
    assert max(c.x.max() for c in halves[0]) < min(c.x.min() for c in halves[1])
    np.testing.assert_allclose(halves[0][0].y, halves[1][0].y)


@pytest.mark.slow
def test_a_kick_gets_as_high_as_the_hips_and_a_held_foot_is_held():
    danced = dance(Replay("kick", feet="auto", rate=500.0), lambda what, share: None)
    log, plan = danced.run.log.trimmed(), danced.plan
    assert danced.info.fell_at_s is None and plan.added_time <= 0.5
    robot = figures.Points.of(plan.motion.robot, log.q[::10]).positions
    right = robot["right_ankle"][:, 2]
    assert right.max() >= 0.8 * robot["right_hip"][right.argmax(), 2]
    held = robot["left_ankle"][:, 2] >= 0.9 * np.median(robot["left_knee"][:, 2])
    assert np.count_nonzero(held) * 10 * log.period >= 3.0
    assert figures.contacts(log, plan.motion)["torque_step_max_nm"] <= 28.0
