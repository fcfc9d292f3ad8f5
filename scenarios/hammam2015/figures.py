"""The figures of kinematic runs, and their table."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.hammam2015.kinematic_run import KinematicRun

Array = np.ndarray
Figures = dict[str, Any]

REFERENCE_US = 60.0
"""Time of the reference computation [µs] to which rates are scaled."""
TRACKED = "right_wrist"


def run_figures(run: KinematicRun, reference_us: float) -> Figures:
    """Figures of one run.

    Args:
        run: The run.
        reference_us: Time of the reference computation in the same process [µs].

    Returns:
        "joints_out" and "pairs": joints outside their ranges and pairs that overlap, mean a frame; "clean": share of
        the frames without either; "beyond_rad": the largest excess of a range; "nearest_m": the nearest that two shapes
        come; "points_rms_m", "wrist_rms_m": distances from the reference; "foot_m": the largest of a foot; "power_w":
        mean power, Hammam (43); "frames_per_s": median, of this machine and "scaled" to one whose reference computation
        takes REFERENCE_US; "ran_away".
    """
    wrist = run.errors[:, run.names.index(TRACKED)]
    per_second = 1e6 / float(np.median(run.frame_us))
    return {
        "joints_out": float(run.joints_out.mean()),
        "pairs": float(run.overlaps.mean()),
        "clean": float(np.mean(run.violations == 0)),
        "beyond_rad": float(run.beyond.max()),
        "nearest_m": float(run.nearest.min()),
        "points_rms_m": _rms(run.errors),
        "wrist_rms_m": _rms(wrist),
        "foot_m": float(run.foot_errors.max()),
        "power_w": float(run.powers.mean()),
        "frames_per_s": per_second,
        "frames_per_s_scaled": per_second * reference_us / REFERENCE_US,
        "ran_away": run.ran_away,
    }


def violation_histogram(run: KinematicRun) -> list[int]:
    """Number of frames with 0, 1, 2, ... violations, Figures 4 and 11."""
    return [int(count) for count in np.bincount(run.violations)]


def summary(figures: Mapping[str, Mapping[str, Figures]], method: str) -> Figures:
    """Over all clips: medians, and the worst where limits are concerned. `figures`: clip -> method -> figures."""
    runs: Sequence[Figures] = [of_clip[method] for of_clip in figures.values()]

    def middle(key: str) -> float:
        return float(np.median([run[key] for run in runs]))

    return {
        "ran_away": sum(run["ran_away"] for run in runs),
        "joints_out": middle("joints_out"),
        "pairs": middle("pairs"),
        "clean_least": min(run["clean"] for run in runs),
        "clean_clips": sum(run["clean"] == 1.0 for run in runs),
        "beyond_rad": max(run["beyond_rad"] for run in runs),
        "nearest_m": min(run["nearest_m"] for run in runs),
        "points_rms_m": middle("points_rms_m"),
        "wrist_rms_m": middle("wrist_rms_m"),
        "foot_m": max(run["foot_m"] for run in runs),
        "power_w": middle("power_w"),
        "frames_per_s_scaled": middle("frames_per_s_scaled"),
    }


def print_summaries(figures: Mapping[str, Any], console: Console) -> None:
    """Print the summaries of all task sets and methods."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for words in ("set", "method"):
        table.add_column(words)
    for words in (
        *("ran\naway", "joints out\na frame", "pairs\na frame", "clean frames\nleast %", "beyond\ndeg", "nearest\nmm"),
        *("points\nrms mm", "wrist\nrms mm", "foot\nmm", "power\nW", "frames/s\nscaled"),
    ):
        table.add_column(words, justify="right")
    for task_set, methods in figures["summary"].items():
        for method, of in methods.items():
            table.add_row(
                task_set,
                method,
                str(of["ran_away"]),
                f"{of['joints_out']:.2f}",
                f"{of['pairs']:.2f}",
                f"{100.0 * of['clean_least']:.1f}",
                f"{np.degrees(of['beyond_rad']):.1f}",
                f"{1e3 * of['nearest_m']:.0f}",
                f"{1e3 * of['points_rms_m']:.0f}",
                f"{1e3 * of['wrist_rms_m']:.0f}",
                f"{1e3 * of['foot_m']:.1f}",
                f"{of['power_w']:.0f}",
                f"{of['frames_per_s_scaled']:.0f}",
            )
    console.print(table)


def print_torque_law(figures: Mapping[str, Any], console: Console) -> None:
    """Print what the torque law did under physics."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for words in ("torque law, set 2", "accelerations"):
        table.add_column(words)
    for words in ("upright", "points rms mm", "ZMP inside %", "gave α_c up %", "beyond deg"):
        table.add_column(words, justify="right")
    for clip, kinds in figures["torque_law"].items():
        for kind, of in kinds.items():
            upright = "yes" if of["fell_at_s"] is None else f"fell at {of['fell_at_s']:.1f} s"
            table.add_row(
                clip,
                kind,
                upright,
                f"{1e3 * of['points_rms_m']:.0f}",
                f"{100.0 * (of['zmp_inside'] or 0.0):.1f}",
                f"{100.0 * of['given_up']:.0f}",
                f"{np.degrees(of['beyond_rad']):.1f}",
            )
    console.print(table)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
