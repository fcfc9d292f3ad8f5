"""Soles, footholds, support polygon, CoM, DCM and ZMP in a recording."""

import numpy as np
import rerun as rr

from sim.hardware.sole_frames import sole_frames
from sim.log import RunLog
from sim.recording.columns import COLORS, Columns
from sim.recording.panels import FOOT_MODE_NAMES, measured_and_planned_dcm
from sim.support import ground_heights, planned_support
from sot.motion.feet.footfalls import Footfalls
from sot.motion.trajectory import Motion

FLOOR_OFFSET = 0.004  # m, height above the floor at which things on the floor are drawn


def send_footing(columns: Columns, log: RunLog, motion: Motion, rows: np.ndarray) -> None:
    """Send balance and contacts at some rows of a log."""
    _send_points(columns, log, motion, rows)
    _send_support(columns, log, motion, rows)
    _send_soles(columns, log, motion, rows)
    _send_plan(columns, motion)


def _send_points(columns: Columns, log: RunLog, motion: Motion, rows: np.ndarray) -> None:
    times, ground = log.time[rows], ground_heights(motion, log.time[rows])
    columns.points("world/balance/com", times, log.com[rows], "com", 0.03)
    measured, planned = measured_and_planned_dcm(log, motion)
    on_floor = {
        "zmp_measured": (log.zmp_measured, "measured"),
        "zmp_controller": (log.zmp_control, "controller"),
        "zmp_planned": (log.zmp_planned, "planned"),
        "dcm_measured": (measured, "dcm"),
        "dcm_planned": (planned, "dcm_planned"),
    }
    for name, (place, color) in on_floor.items():
        columns.points(f"world/balance/{name}", times, _on_ground(place[rows], ground), color, 0.012)


def _send_support(columns: Columns, log: RunLog, motion: Motion, rows: np.ndarray) -> None:
    outlines: dict[int, np.ndarray] = {}
    heights, is_shown = ground_heights(motion, log.time), np.zeros(log.ticks, dtype=bool)
    is_shown[rows] = True
    for shared, polygon in planned_support(log, motion):
        seen = shared[is_shown[shared]]
        if len(seen):
            ground = heights[seen[:1]]  # all are of one phase
            outline = _on_ground(_closed_outline(polygon.vertices), ground).astype(np.float32)
            outlines.update(dict.fromkeys(seen.tolist(), outline))
    columns.static("world/contact/support", rr.LineStrips3D.from_fields(colors=[COLORS["planned"]], radii=[0.005]))
    shown = [outlines[row] for row in rows.tolist() if row in outlines]
    lengths = [int(row in outlines) for row in rows.tolist()]
    strips = rr.LineStrips3D.columns(strips=shown)
    columns.over_time("world/contact/support", log.time[rows], strips.partition(lengths))


def _send_soles(columns: Columns, log: RunLog, motion: Motion, rows: np.ndarray) -> None:
    """Send the outline of each sole in the colour of its planned contact."""
    robot = motion.robot
    positions, rotations = sole_frames(robot, log.q[rows], log.sole_deflection[rows])
    shades = np.array([COLORS[mode] for mode in FOOT_MODE_NAMES], dtype=np.uint8)
    for index, foot in enumerate(robot.feet):
        corners = positions[index][:, None] + _closed_outline(robot.sole(foot)) @ rotations[index].swapaxes(1, 2)
        colors = shades[log.foot_mode[rows, index]]
        soles = rr.LineStrips3D.columns(strips=corners.astype(np.float32), colors=colors)
        entity = f"world/contact/{foot}/sole"
        columns.static(entity, rr.LineStrips3D.from_fields(radii=[0.006]))
        columns.over_time(entity, log.time[rows], soles)


def _send_plan(columns: Columns, motion: Motion) -> None:
    """Send all footholds, and the planned path of the centre of mass over the ground."""
    outlines = [outline + np.array([0.0, 0.0, FLOOR_OFFSET]) for outline in foothold_outlines(motion)]
    columns.static("world/plan/footholds", rr.LineStrips3D(outlines, colors=[COLORS["foothold"]], radii=[0.002]))
    shown = slice(None, None, max(1, round(motion.rate / 20.0)))
    way = _on_ground(motion.com[shown, :2], ground_heights(motion, motion.times[shown]))
    columns.static("world/plan/com", rr.LineStrips3D([way], colors=[COLORS["com_planned"]], radii=[0.002]))


def foothold_outlines(motion: Motion) -> list[np.ndarray]:
    """Closed outline (K, 3) of each sole where the plan puts it down [m]."""
    return [
        np.array([stance.pose.act(corner) for corner in _closed_outline(motion.robot.sole(foot))])
        for foot in motion.robot.feet
        for stance in Footfalls(motion.phases, foot).stances
    ]


def _closed_outline(corners: np.ndarray) -> np.ndarray:
    return np.vstack([corners, corners[:1]])


def _on_ground(places: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Places seen from above (T, 2) as points to draw (T, 3), over ground of heights (T,) or (1,) [m]."""
    return np.column_stack([places, np.broadcast_to(heights + FLOOR_OFFSET, len(places))])
