"""The tabs of tasks that come, go and change their level, and of servos."""

from dataclasses import replace

import numpy as np

from sim.recording.panels import servo_tabs, task_level_tabs
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


def test_servos_and_soles_have_a_tab_if_there_are_any():
    robot = Robot.load("hrp2")
    log = perfect_log(still_motion(robot, 1.0)).trimmed()
    assert servo_tabs(log, robot) == []
    target, deflection = log.q[:, 7:].copy(), np.zeros((log.ticks, 2, 3))
    target[3, robot.groups["chest"][0]] += np.deg2rad(2.0)
    deflection[:, 1, 0], deflection[:, 0, 2] = np.deg2rad(-1.0), 0.003
    (tab,) = servo_tabs(replace(log, target=target, sole_deflection=deflection), robot)
    error, turn, height = (plot.curves[0] for plot in tab.plots)
    assert error.values.max() == error.values[3, list(error.names).index("chest")] > 1.99
    np.testing.assert_allclose(turn.values[:, list(turn.names).index("right_foot, roll")], -1.0)
    np.testing.assert_allclose(height.values, np.tile([3.0, 0.0], (log.ticks, 1)))
    assert servo_tabs(replace(log, target=target), robot)[0].plots[0].title.startswith("Greatest angle")
