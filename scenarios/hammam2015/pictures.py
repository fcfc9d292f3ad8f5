"""Hammam's Figures 3 to 13 of our own runs, as pictures that any browser shows."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from scenarios.hammam2015.figures import TRACKED
from scenarios.hammam2015.kinematic_run import KinematicRun
from sim.reporting.chart import Curve, Panel, limit_lines, write_panels
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot

Array = np.ndarray
Runs = Mapping[tuple[int, str], KinematicRun]
"""Runs of one clip by task set and method."""

COLORS = {
    "no constraints": "#999",
    "CRAC as printed": "#d9762b",
    "CRAC mended": "#2b6fd9",
    "cascade": "#2a9d5c",
    "reference": "#333",
}
BEFORE, PRINTED, AFTER, OURS = "no constraints", "CRAC as printed", "CRAC mended", "cascade"
WHEN = {BEFORE: "before", AFTER: "after"}
HANDS: dict[str, tuple[str, str | None]] = {
    "right hand, trunk": ("right_hand", None),
    "left hand, trunk": ("left_hand", None),
    "hands": ("right_hand", "left_hand"),
}
"""Pairs of which distances are drawn: parts of the body, None for what is no limb."""
LARGEST_DISTANCE_DRAWN, LARGEST_ANGLE_DRAWN_DEG = 0.3, 250.0
DRAWN_EVERY = 2
"""Frames of a run of which distances are drawn: one in so many."""


def draw_pictures(folder: Path, robot: Robot, runs: Runs, label: str) -> None:
    """Draw all of them from the runs of one clip."""
    _draw_violations(folder / "violations.svg", runs, label)
    _draw_distances(folder / "distances.svg", robot, runs, label)
    _draw_joints(folder / "joints.svg", robot, runs, label)
    _draw_tracking(folder / "tracking.svg", runs, label)


def draw_powers(path: Path, powers: Mapping[str, Mapping[str, Mapping[str, float]]]) -> None:
    """Figure 9: mean power by clip, W_D = H against I. `powers`: task set -> clip -> "H" or "I" -> W."""
    panels = []
    for task_set, clips in powers.items():
        curves = [
            _bars([k + shift for k in range(len(clips))], [of[kind] for of in clips.values()], color, kind)
            for kind, color, shift in (("H", COLORS[AFTER], -0.2), ("I", COLORS[PRINTED], 0.2))
        ]
        panels.append(Panel(f"Task set {task_set}", ", ".join(clips), "W", curves))
    write_panels(path, "Mean power (43) of the mended CRAC, W_D = H and W_D = I", panels, 1, (760.0, 220.0))


def _draw_violations(path: Path, runs: Runs, label: str) -> None:
    """Figures 3, 4 and 11: how many limits are violated at once, before and after."""
    panels = []
    for task_set in (1, 2, 3):
        curves = []
        for k, method in enumerate((BEFORE, PRINTED, AFTER, OURS)):
            counts = np.bincount(runs[task_set, method].violations)
            places = np.arange(len(counts)) + 0.2 * (k - 1.5)
            curves.append(_bars(places, 100.0 * counts / counts.sum(), COLORS[method], method))
        panels.append(Panel(f"Task set {task_set}", "limits violated at once", "% of frames", curves))
    write_panels(path, f"Violations of joint ranges and distances, {label}", panels, 1, (760.0, 210.0))


def _draw_distances(path: Path, robot: Robot, runs: Runs, label: str) -> None:
    """Figures 5, 8 and 13: distances of the arms, and the way of the right wrist sideways."""
    panels = []
    for task_set in (1, 2, 3):
        near = {
            method: arm_distances(robot, runs[task_set, method].times, runs[task_set, method].q, HANDS)
            for method in (BEFORE, AFTER)
        }
        for group in list(HANDS)[: 1 if task_set == 3 else 3]:
            curves = [
                Curve(times, np.minimum(found[group], LARGEST_DISTANCE_DRAWN), COLORS[method], WHEN[method])
                for method, (times, found) in near.items()
            ]
            curves += limit_lines([0.0], float(runs[task_set, AFTER].times[-1]), "")
            panels.append(Panel(f"Set {task_set}: {group}", "s", "m", curves))
        if task_set == 3:
            panels += [_way_panel(runs, 3, axis, (AFTER,)) for axis in (0, 1)]
    write_panels(path, f"Least distances with and without constraints, {label}", panels, 3)


def _draw_joints(path: Path, robot: Robot, runs: Runs, label: str) -> None:
    """Figure 6: the joints of the right arm within their ranges, task set 1."""
    panels = []
    for joint in robot.groups["right_arm"]:
        curves = []
        for method in (BEFORE, PRINTED, AFTER):
            run = runs[1, method]
            angles = np.degrees(run.q[:, 7 + joint])
            curves.append(
                Curve(
                    run.times,
                    np.clip(angles, -LARGEST_ANGLE_DRAWN_DEG, LARGEST_ANGLE_DRAWN_DEG),
                    COLORS[method],
                    method,
                )
            )
        ends = [float(np.degrees(side[joint])) for side in (robot.lower, robot.upper)]
        curves += limit_lines(ends, float(runs[1, AFTER].times[-1]), "")
        panels.append(Panel(robot.joints[joint], "s", "deg", curves))
    write_panels(path, f"Joints of the right arm, task set 1, {label}", panels, 3)


def _draw_tracking(path: Path, runs: Runs, label: str) -> None:
    """Figures 7 and 12: the right wrist, task sets 1 and 2."""
    panels = [_way_panel(runs, task_set, axis, (AFTER, OURS)) for task_set in (1, 2) for axis in range(3)]
    write_panels(path, f"Way of the right wrist, {label}", panels, 3)


def _way_panel(runs: Runs, task_set: int, axis: int, methods: Sequence[str]) -> Panel:
    reference = runs[task_set, methods[0]]
    k = reference.names.index(TRACKED)
    curves = [Curve(reference.times, reference.wanted[:, k, axis], COLORS["reference"], "wanted", dashed=True)]
    for method in methods:
        run = runs[task_set, method]
        curves.append(Curve(run.times, run.reached[:, k, axis], COLORS[method], method))
    return Panel(f"Set {task_set}: right wrist, {'xyz'[axis]}", "s", "m", curves)


def arm_distances(
    robot: Robot, times: Array, q: Array, groups: Mapping[str, tuple[str, str | None]]
) -> tuple[Array, dict[str, Array]]:
    """Times (k,), and least distances (k,) [m] by name, between parts of the body along a motion.

    Parts are limbs, hands (from the wrist on), and None for what is no limb.
    """
    data, results = robot.model.createData(), robot.shapes.createData()
    chosen = {name: _pairs_between(robot, *limbs) for name, limbs in groups.items()}
    needed = sorted({k for pairs in chosen.values() for k in pairs})
    rows = np.arange(0, len(q), DRAWN_EVERY)
    distances = np.full((len(rows), len(robot.shapes.collisionPairs)), np.inf)
    for row, configuration in zip(distances, q[rows], strict=True):
        pin.updateGeometryPlacements(robot.model, data, robot.shapes, results, configuration)
        for k in needed:
            row[k] = pin.computeDistance(robot.shapes, results, k).min_distance
    return times[rows], {name: distances[:, pairs].min(axis=1) for name, pairs in chosen.items()}


def _pairs_between(robot: Robot, part: str, other: str | None) -> list[int]:
    model, shapes = robot.model, robot.shapes.geometryObjects
    limbs = {2 + joint for name in ("arms", "legs") for joint in robot.groups[name]}
    roots = {f"{side}_hand": model.frames[robot.point(f"{side}_wrist")].parentJoint for side in SIDES}
    roots |= {f"{side}_arm": 2 + min(robot.groups[f"{side}_arm"]) for side in SIDES}

    def belongs(shape: int, to: str | None) -> bool:
        chain = model.supports[shapes[shape].parentJoint].tolist()
        return roots[to] in chain if to else not limbs & set(chain)

    return [
        k
        for k, pair in enumerate(robot.shapes.collisionPairs)
        if (belongs(pair.first, part) and belongs(pair.second, other))
        or (belongs(pair.second, part) and belongs(pair.first, other))
    ]


def _bars(places: Any, heights: Any, color: str, label: str) -> Curve:
    """Upright lines from zero, as one curve."""
    x = np.repeat(np.asarray(places, dtype=float), 3)
    y = np.column_stack([np.zeros(len(x) // 3), heights, np.full(len(x) // 3, np.nan)]).ravel()
    return Curve(x, y, color, label, width=8.0)
