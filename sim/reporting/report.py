"""A run's report: its figures as JSON, and as a table to read."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from sim.log import Fallback, RunInfo, RunLog
from sim.reference import hot_reference_us
from sim.reporting import figures
from sim.reporting.estimator import estimate_us, estimator_figures
from sim.reporting.provenance import command_line, revision
from sim.reporting.servo import servo_figures
from sim.reporting.slides import slide_figures, worst_of_slides
from sot.hardware.hardware import Hardware
from sot.motion.performance import Performance
from sot.motion.quality import KEYS as QUALITY_KEYS
from sot.motion.trajectory import Motion
from sot.proximity import overlap_remarks
from sot.whole_file import atomic_write

SIGNIFICANT_DIGITS = 6
PRINTED_LINES_LIMIT = 3
"""Most conflicts, and most kinds of fallbacks, that are printed on the terminal."""
RETARGET_KEYS = ("key_point_rms_m", "frames_per_s")

# What the table says: place in the report, words, factor to the unit read, unit, what to aim for.
TABLE_ROWS: tuple[tuple[str, str, float, str, str], ...] = (
    ("duration_s", "simulated time", 1.0, "s", ""),
    ("real_time_factor", "simulated time over wall-clock time", 1.0, "", "1 or more"),
    ("tick_us.p50", "tick, median", 1.0, "µs", ""),
    ("tick_us.p99", "tick, 99th percentile", 1.0, "µs", "below the period"),
    ("reference_us", "the machine: QR of a 62 × 18 matrix", 1.0, "µs", ""),
    ("tracking.mpjpe_mm", "key bodies off their reference, mean", 1.0, "mm", "0"),
    ("tracking.joint_rms_rad", "joint angles off their reference", 180.0 / math.pi, "deg", "0"),
    ("tracking.com_rms_m", "centre of mass off its reference", 1e3, "mm", "0"),
    ("likeness.segment_deg", "body segments off the human's", 1.0, "deg", "0"),
    ("likeness.upper_segment_deg", "… without the legs", 1.0, "deg", "0"),
    ("likeness.leg_segment_deg", "… of the legs", 1.0, "deg", "0"),
    ("likeness.knee_bend_deg", "knees bent more than the human's, mean", 1.0, "deg", "0"),
    ("likeness.foot_lift_ratio", "lifts of feet, robot over human", 1.0, "", "1"),
    ("likeness.heading_deg", "heading off the human's, rms", 1.0, "deg", "0"),
    ("likeness.hand_path_ratio", "way of the hands, robot over human", 1.0, "", "1"),
    ("retarget.key_point_rms_m", "reference off the scaled human", 1e3, "mm", ""),
    ("speed_min", "slowest speed, over the dancer's", 100.0, "%", "100"),
    ("stretched_s", "time added by slowing down", 1.0, "s", "0"),
    ("quality.limmt_score", "LIMMT's score of motions", 1.0, "", "90 or more"),
    ("incoming.limmt_score", "… of the file that came in", 1.0, "", ""),
    ("quality.foot_sliding", "frames with a low foot in motion", 100.0, "%", "0"),
    ("incoming.foot_sliding", "… of the file that came in", 100.0, "%", ""),
    ("quality.penetration_max_m", "soles in the floor, greatest", 1e3, "mm", "0"),
    ("incoming.penetration_max_m", "… of the file that came in", 1e3, "mm", ""),
    ("quality.self_collision", "frames with bodies in one another", 100.0, "%", "0"),
    ("incoming.self_collision", "… of the file that came in", 100.0, "%", ""),
    ("quality.mpkpe_mm", "MPKPE, key bodies in the world", 1.0, "mm", "0"),
    ("quality.r_mpkpe_mm", "R-MPKPE, relative to the chest", 1.0, "mm", "0"),
    ("steps.footfalls", "the dancer's footfalls over 10 cm", 1.0, "", ""),
    ("steps.made", "… made within 15 cm", 1.0, "", "all"),
    ("steps.path_ratio", "way through the room, robot over human", 1.0, "", "1"),
    ("zmp.inside", "ticks with the ZMP inside the support", 100.0, "%", "100"),
    ("zmp.rms_to_planned_m", "ZMP off its plan", 1e3, "mm", "0"),
    ("zmp.min_margin_m", "ZMP to the support's edge, least", 1e3, "mm", "10 or more"),
    ("contacts.torque_step_max_nm", "torque step at a switch, greatest", 1.0, "N m", "0"),
    ("contacts.slip_max_m", "slip of a standing foot, greatest", 1e3, "mm", "0"),
    ("contacts.sole_tilt_max_deg", "tilt of a sole, greatest", 1.0, "deg", "0"),
    ("slide.way_m", "way of feet that slide", 1e2, "cm", ""),
    ("slide.contact", "… time in which the floor carries them", 100.0, "%", "90 or more"),
    ("slide.load_min", "… least load, over the weight", 100.0, "%", "2 or more"),
    ("slide.load_max", "… greatest load", 100.0, "%", "15 or less"),
    ("slide.zmp_inside", "… ticks with the ZMP in the other foot", 100.0, "%", "100"),
    ("slide.zmp_min_margin_m", "… its mean over 50 ms to the edge, least", 1e3, "mm", "above 0"),
    ("limits.position_max_excess_rad", "beyond a joint's range", 180.0 / math.pi, "deg", "0"),
    ("limits.velocity_max_excess", "beyond a joint's velocity", 100.0, "%", "0"),
    ("limits.torque_max_excess", "beyond a joint's torque", 100.0, "%", "0"),
    ("limits.self_collision_min_m", "least distance between own bodies", 1e3, "mm", "above 0"),
    ("estimator.position_end_m", "estimated base off the true one at the end", 1e3, "mm", "0"),
    ("estimator.position_end_share", "… over the way walked", 100.0, "%", "0"),
    ("estimator.tilt_rms_deg", "estimated tilt off the true one, rms", 1.0, "deg", "0"),
    ("estimator.velocity_rms_m_s", "estimated velocity off the true one, rms", 1e3, "mm/s", "0"),
    ("estimator_us.p50", "estimate, median", 1.0, "µs", ""),
    ("pushes.given", "pushes", 1.0, "", ""),
    ("pushes.survived", "pushes survived", 1.0, "", "all"),
    ("pushes.survived_max_ns", "strongest push survived", 1.0, "N s", ""),
    ("servo.error_rms_rad", "joint angles off the servos' targets", 180.0 / math.pi, "deg", "0"),
    ("servo.error_max_rad", "… greatest", 180.0 / math.pi, "deg", "0"),
    ("servo.sole_deflection_max_rad", "turn of a sole under its ankle, greatest", 180.0 / math.pi, "deg", ""),
    ("servo.sensed_zmp_rms_m", "ZMP of the force sensors off the floor's", 1e3, "mm", "0"),
    ("torque_saturated", "ticks with a torque at its limit", 100.0, "%", ""),
    ("power_w", "mechanical power, mean", 1.0, "W", ""),
    ("solver.infeasible_ticks", "ticks whose hard level had to give way", 1.0, "", "0"),
    ("solver.fallback_ticks", "ticks answered by a fallback", 1.0, "", "0"),
    ("solver.invalid_ticks", "ticks with values that cannot be used", 1.0, "", "0"),
)


def run_report(log: RunLog, info: RunInfo, wall_s: float, motion: Motion, plan: Performance | None) -> dict[str, Any]:
    """The figures of a run, None where there was nothing to measure; fractions and ratios are plain numbers.

    Args:
        log: rows of the run.
        info: facts about the run.
        wall_s: wall-clock time of controller, physics and recording [s].
        motion: the reference.
        plan: how the reference came from a human, if it did.
    """
    log = log.trimmed()
    robot = motion.robot
    duration, slid = log.ticks * log.period, slide_figures(log, motion)
    saturated = figures.saturated_joints(log, robot)
    report = {
        "command": command_line(),
        "seed": info.mismatch.seed,
        "revision": revision(),
        "clip": info.clip,
        "robot": info.robot,
        "solver": {
            "name": info.solver,
            **figures.solver(log),
            "conflicts": [{"t_s": round(t, 6), "rows": rows} for t, rows in log.conflicts],
            "fallbacks": _grouped_fallbacks(log),
            "invalid": _grouped_invalid(log),
        },
        "feet": info.feet,
        "rate_hz": info.rate_hz,
        "speed": info.speed,
        "speed_min": info.speed_min,
        "stretched_s": info.stretched_s,
        "duration_s": duration,
        "fell": info.fell_at_s is not None,
        "fell_at_s": info.fell_at_s,
        "fell_reason": info.reason or None,
        "real_time_factor": duration / wall_s,
        "tick_us": figures.tick_us(log),
        "reference_us": hot_reference_us(),
        "tracking": figures.tracking(log, motion),
        "likeness": figures.likeness(log, plan),
        "retarget": dict(plan.retarget) if plan else dict.fromkeys(RETARGET_KEYS),
        "quality": figures.quality(log, motion),
        "incoming": dict.fromkeys(QUALITY_KEYS),
        "steps": figures.steps(log, plan),
        "flights": figures.flights(plan),
        "remarks": [
            *robot.remarks,
            *(plan.remarks if plan else []),
            *overlap_remarks(robot, motion.times, motion.q),
            *_run_remarks(log),
            *figures.saturation_remark(saturated),
        ],
        "zmp": figures.zmp(log, motion),
        "contacts": figures.contacts(log, motion),
        "slide": worst_of_slides(slid),
        "slides": slid,
        "limits": figures.limits(log, robot) | {"saturated_joints": saturated},
        **figures.effort(log, robot),
        "estimator": estimator_figures(log, motion),
        "estimator_us": estimate_us(log),
        "pushes": figures.pushes(info, duration),
        "mismatch": asdict(info.mismatch),
        "plant": _plant(info.hardware),
        "servo": servo_figures(log, info, robot),
    }
    return {key: rounded(value) for key, value in report.items()}


def _plant(hardware: Hardware) -> dict[str, Any]:
    """What drives the joints, and how the feet give way."""
    soft = hardware.compliance
    return {
        "joints": "torque" if hardware.servo is None else "servo",
        "feet_compliance": None if soft is None else [soft.roll, soft.pitch, soft.vertical],
    }


def _grouped_fallbacks(log: RunLog) -> list[dict[str, Any]]:
    """Ticks that a fallback answered, those of one level and for one reason together, most first."""
    alike: dict[tuple[str, str], list[Fallback]] = {}
    for fallback in log.fallbacks:
        alike.setdefault((fallback.level, fallback.reason), []).append(fallback)
    return [
        {
            "level": level,
            "reason": reason,
            "ticks": len(ticks),
            "first_s": round(ticks[0].t, 6),
            "last_s": round(ticks[-1].t, 6),
            "max_residual": max(tick.residual for tick in ticks),
        }
        for (level, reason), ticks in sorted(alike.items(), key=lambda item: -len(item[1]))
    ]


def _grouped_invalid(log: RunLog) -> list[dict[str, Any]]:
    """Values that could not be used: which, in how many ticks, and when."""
    alike: dict[str, list[float]] = {}
    for t, what in log.invalid:
        alike.setdefault(what, []).append(t)
    return [
        {"what": what, "ticks": len(times), "first_s": round(times[0], 6), "last_s": round(times[-1], 6)}
        for what, times in alike.items()
    ]


def _run_remarks(log: RunLog) -> list[str]:
    return [
        f"The last torque was held in {_counted(entry['ticks'])} {_when(entry)}: {entry['what']}."
        for entry in _grouped_invalid(log)
    ]


def _counted(ticks: int) -> str:
    return f"{ticks} tick{'s' * (ticks > 1)}"


def _when(entry: Mapping[str, Any]) -> str:
    first, last = entry["first_s"], entry["last_s"]
    return f"at {first:.3f} s" if first == last else f"from {first:.3f} to {last:.3f} s"


def write_json(report: Mapping[str, Any], path: Path) -> None:
    """Write a report as JSON, as `rounded`; the file appears under its name once it is complete."""
    with atomic_write(path) as place:
        place.write_text(json.dumps(rounded(report), indent=2, allow_nan=False) + "\n", encoding="utf-8")


def print_table(reports: Sequence[Mapping[str, Any]], console: Console) -> None:
    """Print reports side by side as a table in plain words."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    table.add_column("", no_wrap=True)
    for report in reports:
        table.add_column(
            f"{report['clip']}\n{report['robot']}\n{report['solver']['name']}", justify="right", overflow="fold"
        )
    table.add_column("")
    table.add_column("aim", no_wrap=True)
    for words, values, unit, aim in table_rows(reports):
        table.add_row(words, *values, unit, aim)
    console.print(table)
    for report in reports:
        for line in _conflict_and_fallback_lines(report["solver"]):
            console.print(f"{report['clip']}: {line}", soft_wrap=True, markup=False, highlight=False)


def _conflict_and_fallback_lines(solver: Mapping[str, Any]) -> Iterator[str]:
    """A few lines on a run's conflicts and fallbacks."""
    conflicts, fallbacks = solver["conflicts"], solver["fallbacks"]
    for conflict in conflicts[:PRINTED_LINES_LIMIT]:
        yield f"no solution of the hard level at {conflict['t_s']:.3f} s: {conflict['rows']}"
    for fallback in fallbacks[:PRINTED_LINES_LIMIT]:
        when = f"{_counted(fallback['ticks'])} {_when(fallback)}"
        yield f"fallback, {when}, level {fallback['level']}: {fallback['reason']}"
    if left := len(conflicts[PRINTED_LINES_LIMIT:]) + len(fallbacks[PRINTED_LINES_LIMIT:]):
        yield f"{left} more of these are in the report"


def table_rows(reports: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, list[str], str, str]]:
    """Reports in plain words: what a line is about, its figure in each report, unit, and what to aim for.

    What no report has a figure of has no line: slides where no foot slid, pushes of a run that nobody pushed.

    Raises:
        KeyError: a report lacks a figure.
    """
    yield "how it ended", [_ending_text(report) for report in reports], "", ""
    pushed = any(report["pushes"]["given"] for report in reports)
    for place, words, factor, unit, aim in TABLE_ROWS:
        values = [figure_at(report, place) for report in reports]
        if (pushed or not place.startswith("pushes.")) and any(value is not None for value in values):
            yield words, ["-" if value is None else _formatted_number(factor * value) for value in values], unit, aim


def _ending_text(report: Mapping[str, Any]) -> str:
    return f"fell at {report['fell_at_s']:.2f} s: {report['fell_reason']}" if report["fell"] else "upright"


def figure_at(report: Mapping[str, Any], place: str) -> float | None:
    """A figure by its place, keys joined by dots.

    Raises:
        KeyError: there is none.
    """
    value: Any = report
    for key in place.split("."):
        value = value[key]
    return value


def _formatted_number(value: float) -> str:
    """Three digits, or all that stand before the point; a thousandth or less is nothing."""
    return f"{value:.0f}" if abs(value) >= 100 or abs(value) < 1e-3 else f"{value:.3g}"


def rounded(value: Any) -> Any:
    """Numbers to `SIGNIFICANT_DIGITS` digits; what is not a number becomes None."""
    if isinstance(value, Mapping):
        return {key: rounded(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(entry) for entry in value]
    if isinstance(value, float):
        return float(f"{value:.{SIGNIFICANT_DIGITS}g}") if math.isfinite(value) else None
    return value
