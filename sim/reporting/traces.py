"""What a run's page shows: its columns, thin enough for a page, and what they mean, in a file of their own.

A recording holds more, but is twenty times as large, and rerun's ways to read one back are experimental.
"""

import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.log import RunInfo, RunLog, nearest_frames
from sim.recording.footing import foothold_outlines
from sim.recording.panels import LIMB_GROUPS
from sim.reporting.timeline import schedule_lanes
from sim.support import support_extents
from sot.errors import InputError
from sot.motion.trajectory import Motion
from sot.whole_file import atomic_write

FORMAT_VERSION = 1
"""Of the file; to be counted up with every change of what is in it."""
CURVE_BUCKETS, TICK_TIME_BUCKETS = 1000, 300
FACTS_KEY = "facts"

Columns = dict[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class Traces:
    """A run, as its page shows it.

    Attributes:
        facts: what was run, names and limits; plain text and numbers.
        columns: by name, a row a time of `columns["time"]`, single precision.
    """

    facts: Mapping[str, Any]
    columns: Mapping[str, np.ndarray]

    @staticmethod
    def of(log: RunLog, info: RunInfo, motion: Motion) -> "Traces":
        """Those of a run.

        Args:
            log: rows of the run.
            info: facts about the run.
            motion: the reference.
        """
        log, robot = log.trimmed(), motion.robot
        frames = nearest_frames(log.time, motion.rate, len(motion.q))
        sides = support_extents(log, motion)
        columns = {
            "angle": log.q[:, 7:],
            "reference": motion.q[frames, 7:],
            "torque": log.torque,
            "zmp_measured": log.zmp_measured,
            "zmp_control": log.zmp_control,
            "zmp_planned": log.zmp_planned,
            "support_least": sides[:, 0],
            "support_greatest": sides[:, 1],
            "com_error": np.linalg.norm(log.com - motion.com[frames], axis=1),
            "force_normal": log.foot_wrench[:, :, 2],
            "force_along": np.linalg.norm(log.foot_wrench[:, :, :2], axis=2),
            "task_error": log.level_error,
        }
        size = max(1, -(-log.ticks // CURVE_BUCKETS))
        thin = {name: bucket_extremes(values, size) for name, values in columns.items()}
        thin["time"] = bucket_times(log.time, size)
        every = np.arange(0, log.ticks, max(1, size // 2))
        thin["zmp_way"] = log.zmp_measured[every]  # x and y at the same times
        thin["tick_time"], thin["tick_median"], thin["tick_greatest"] = _tick_time_buckets(log)
        facts = {
            "version": FORMAT_VERSION,
            "clip": info.clip,
            "robot": info.robot,
            "label": robot.label,
            "duration_s": log.ticks * log.period,
            "period_s": log.period,
            "joints": robot.joints,
            "limbs": {
                name: [joint for group in groups for joint in robot.groups[group]]
                for name, groups in LIMB_GROUPS.items()
            },
            "lower": robot.lower.tolist(),
            "upper": robot.upper.tolist(),
            "effort": robot.effort.tolist(),
            "feet": robot.feet,
            "tasks": log.level_names,
            "task_units": log.level_units,
            "footholds": [outline[:, :2].tolist() for outline in foothold_outlines(motion)],
            "lanes": [
                {
                    "name": lane.name,
                    "bars": [[bar.start, bar.end, bar.color, bar.label, bar.opacity] for bar in lane.bars],
                }
                for lane in schedule_lanes(log, robot)
            ],
        }
        return Traces(facts, {name: values.astype(np.float32) for name, values in thin.items()})

    def save(self, path: Path) -> None:
        """Write to a file (`.npz`), which appears under its name once it is complete."""
        content: dict[str, Any] = {FACTS_KEY: np.array(json.dumps(self.facts)), **self.columns}
        with atomic_write(path) as place:
            np.savez_compressed(place, **content)

    @staticmethod
    def load(path: Path) -> "Traces":
        """Read what `save` wrote.

        Raises:
            InputError: not such a file, damaged, or of another version.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                content = {name: file[name] for name in file.files}
            facts = json.loads(str(content.pop(FACTS_KEY)))
            version = facts["version"]
        except (OSError, ValueError, EOFError, KeyError, TypeError, zipfile.BadZipFile) as error:
            raise InputError(f"{path}: cannot be read as the traces of a run ({error}); run it again") from None
        if version != FORMAT_VERSION:
            raise InputError(
                f"{path}: written by another version (its format is {version}, this one reads {FORMAT_VERSION});"
                " run it again"
            )
        return Traces(facts, content)


def bucket_extremes(values: np.ndarray, size: int) -> np.ndarray:
    """Least and greatest of every `size` rows of values (T, ...), in the order in which they came.

    A peak of a single tick stays a peak.
    """
    if size == 1 or not values.size:
        return values
    short = -len(values) % size
    cells = np.concatenate([values, np.repeat(values[-1:], short, axis=0)]).reshape(-1, size, *values.shape[1:])
    gap = np.isnan(cells)
    least, greatest = np.where(gap, np.inf, cells).argmin(axis=1), np.where(gap, -np.inf, cells).argmax(axis=1)
    order = np.stack([np.minimum(least, greatest), np.maximum(least, greatest)], axis=1)
    return np.take_along_axis(cells, order, axis=1).reshape(-1, *values.shape[1:])


def bucket_times(times: np.ndarray, size: int) -> np.ndarray:
    """Times of what `bucket_extremes` returns, two evenly spaced ones for every `size`."""
    if size == 1 or not len(times):
        return times
    starts = times[::size]
    width = size * (times[1] - times[0])
    return np.stack([starts + 0.25 * width, starts + 0.75 * width], axis=1).ravel()


def _tick_time_buckets(log: RunLog) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (B,) of stretches of a run, median and greatest time of their ticks and of the ticks' parts (B, 4) [µs]."""
    parts = np.column_stack([log.tick_us, log.model_us, log.assemble_us, log.solve_us])
    stretches = [part for part in np.array_split(np.arange(log.ticks), TICK_TIME_BUCKETS) if len(part)]
    shape = (len(stretches), parts.shape[1])
    median = np.array([np.median(parts[rows], axis=0) for rows in stretches]).reshape(shape)
    greatest = np.array([parts[rows].max(axis=0) for rows in stretches]).reshape(shape)
    return np.array([log.time[rows].mean() for rows in stretches]), median, greatest
