"""The tab of tasks that come, go and change their level."""

from sim.recording.panels import task_level_tabs
from sot.robots.robot import Robot
from tests.sim.runs import perfect_log, still_motion


def test_a_task_that_comes_has_a_lane_and_others_have_none():
    log = perfect_log(still_motion(Robot.load("hrp2"), 4.0)).trimmed()
    assert task_level_tabs(log) == []
    log.level_place[:400, 1], log.level_share[:400, 1] = 0, 0.0
    log.level_share[400:440, 1] = 0.5
    (tab,) = task_level_tabs(log)
    (plot,) = tab.plots
    ((name, states),) = plot.lanes.items()
    assert name == log.level_names[1]
    assert [plot.names[states[row]] for row in (0, 399, 400, 439, 440, -1)] == [
        *("none", "none", "on its way", "on its way", "level 2", "level 2")
    ]
    assert len(plot.colors) == len(plot.names)
