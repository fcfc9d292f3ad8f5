"""The tasks and contacts of a run over time as a picture, Ramos Figure 4."""

from pathlib import Path

import numpy as np

from sim.log import FOOT_FIXED, FOOT_OFF, FOOT_ROLLING, FOOT_SLIDING, RunInfo, RunLog, constant_stretches
from sim.reporting.chart import Bar, Lane, write_lanes
from sot.robots.robot import Robot

CONSTANT_COLOR, CHANGING_COLOR = "#9fb4c7", "#2b6fd9"
MODE_COLORS_AND_LABELS = {
    FOOT_OFF: ("#c8c8cc", "off"),
    FOOT_FIXED: ("#3cbeb4", "fixed"),
    FOOT_SLIDING: ("#f0a93a", "sliding"),
    FOOT_ROLLING: ("#5a96e6", "heel up"),
}
TRANSITION_OPACITY = 0.35
"""Opacity of a task on its way from one level to another."""


def has_changes(log: RunLog) -> bool:
    """Whether any task or contact of a run comes, goes or changes."""
    log = log.trimmed()
    return bool((log.level_share < 1.0).any() or np.ptp(log.foot_mode, axis=0).any()) if log.ticks else False


def write_timeline(path: Path, log: RunLog, info: RunInfo, robot: Robot) -> None:
    """Draw a run's schedule into a file (`.svg`)."""
    write_lanes(path, f"{info.clip} by {robot.label}: tasks and contacts over time", "s", schedule_lanes(log, robot))


def schedule_lanes(log: RunLog, robot: Robot) -> list[Lane]:
    """A run's schedule: a lane a task, those above others in the stack first, and a lane a foot.

    Bars that are there from end to end are grey, others blue; they are pale where the task is on its way from one level
    to another. The number in a bar is the place of the task's level, 1 being right below the hard level.
    """
    log = log.trimmed()
    place = np.where(log.level_place > 0, log.level_place, np.nan)
    seen = np.flatnonzero((log.level_place > 0).any(axis=0))
    order = sorted(seen.tolist(), key=lambda k: float(np.nanmax(place[:, k])))
    drawn = []
    for k in order:
        color = CONSTANT_COLOR if (log.level_share[:, k] >= 1.0).all() else CHANGING_COLOR
        states = np.where(log.level_share[:, k] < 1.0, -log.level_place[:, k], log.level_place[:, k])
        bars = [
            Bar(*span, color, "" if value < 0 else str(value), TRANSITION_OPACITY if value < 0 else 1.0)
            for value, span in _timed_stretches(states, log)
            if value
        ]
        drawn.append(Lane(log.level_names[k], bars))
    for index, foot in enumerate(robot.feet):
        modes = _timed_stretches(log.foot_mode[:, index], log)
        drawn.append(
            Lane(foot.replace("_", " "), [Bar(*span, *MODE_COLORS_AND_LABELS[value]) for value, span in modes])
        )
    return drawn


def _timed_stretches(states: np.ndarray, log: RunLog) -> list[tuple[int, tuple[float, float]]]:
    """Runs of equal states (T,), each with when it starts and ends [s]."""
    if not log.ticks:
        return []
    times = np.append(log.time, log.time[-1] + log.period).tolist()
    return [(state, (times[rows.start], times[rows.stop])) for state, rows in constant_stretches(states)]
