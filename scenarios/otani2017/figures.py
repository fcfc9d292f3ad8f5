"""Figures of runs in which things are handled."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sim.log import RunLog
from sim.reporting.objects import object_figures
from sot.behaviours.manipulation.schedule import ManipulationSchedule
from sot.motion.objects.events import ContactSets
from sot.motion.objects.pose_path import PosePath
from sot.motion.objects.retarget import RobotDemonstration
from sot.robots.system import System
from sot.rotation import rotation_vector


def object_report(log: RunLog, system: System, demonstration: RobotDemonstration) -> dict[str, dict[str, Any]]:
    """Figures of the things, see `object_figures`, with how far they are off their aim, or should have turned.

    Args:
        log: Rows of the run.
        system: The robot and the things as they are simulated.
        demonstration: What was to be done.
    """
    objects = object_figures(log, system)
    for name, path in demonstration.things.items():
        aim = path.track.position[-1]
        if system.thing(name).is_free:
            made = [event for event in demonstration.targets if event.pair.first.entity == name]
            aim = demonstration.targets[made[-1]].place.translation if made else aim
            objects[name]["end_error_m"] = float(np.linalg.norm(np.array(objects[name]["end_m"]) - aim))
        else:
            objects[name]["wanted_angle_deg"] = _turned(path)
    return objects


def tick_medians(log: RunLog, history: Sequence[tuple[float, ContactSets]]) -> dict[str, float | None]:
    """Medians of the time of a tick while hands hold a thing and while none does [µs]; None where that never was."""
    starts = [start for start, _ in history]
    holding = np.array([bool(sets.holding) for _, sets in history])
    held = holding[np.searchsorted(starts, log.time, side="right") - 1]
    return {
        words: float(np.median(log.tick_us[rows])) if rows.any() else None
        for words, rows in (("held", held), ("without", ~held))
    }


def manipulation_figures(schedule: ManipulationSchedule) -> dict[str, Any]:
    """Why a demonstration was given up, if it was, when it stood still, and the sets of contacts over time."""
    return {
        "failure": schedule.failure or None,
        "waits": [{"events": wait.what, "start_s": wait.start, "end_s": wait.end} for wait in schedule.waits],
        "sets": [{"t_s": t, "sets": str(sets)} for t, sets in schedule.history],
    }


def _turned(path: PosePath) -> float:
    """How far a path turns from its start to its end [deg]."""
    turn = rotation_vector(path.track.rotation[-1] @ path.track.rotation[0].T)
    return float(np.degrees(np.linalg.norm(turn)))
