"""A run as a rerun recording: the robot beside its reference and the human, and its curves over time."""

import os
from pathlib import Path

import numpy as np
import rerun as rr

from sim.blueprint import LIMBS, layout
from sim.columns import Columns
from sim.log import RunInfo, RunLog, nearest_frames
from sim.support import planned_support
from sim.visuals import FRAME_RATE, METRES_PER_NEWTON, send_visuals
from sot.motion.human import Human
from sot.motion.trajectory import Motion
from sot.robot import Robot

MM = 1e3


def record(path: Path, log: RunLog, info: RunInfo, motion: Motion, human: Human | None) -> None:
    """Write a run to a rerun recording (`.rrd`), which appears under its name once it is complete.

    Args:
        path: file to write.
        log: rows of the run.
        info: facts about the run.
        motion: the reference.
        human: whom the reference follows, in the robot's size and on its time line, if it follows someone.
    """
    log, robot = log.trimmed(), motion.robot
    partial = path.with_name(f".{path.name}.part")
    stream = rr.RecordingStream("humanoid-sot")
    stream.save(partial, default_blueprint=layout(robot, log))
    stream.send_recording_name(f"{info.clip}, {robot.label}")
    columns = Columns(stream)
    columns.static("about", rr.TextDocument(_about(info, robot), media_type=rr.MediaType.MARKDOWN))
    send_visuals(columns, log, info, motion, human)
    _send_balance(columns, log, motion)
    _send_joints(columns, log, motion)
    _send_ticks(columns, log)
    columns.send()
    stream.disconnect()
    os.replace(partial, path)


def _send_balance(columns: Columns, log: RunLog, motion: Motion) -> None:
    sides = np.full((log.ticks, 2, 2), np.nan)
    for rows, polygon in planned_support(log, motion):
        sides[rows] = [polygon.vertices.min(axis=0), polygon.vertices.max(axis=0)]
    frames = log.rows_at(FRAME_RATE)
    for axis, name in enumerate("xy"):
        zmps = np.column_stack([log.zmp_measured[:, axis], log.zmp_control[:, axis], log.zmp_planned[:, axis]])
        names = ("measured", "controller", "planned")
        columns.curves(f"balance/{name}/zmp", log.time, MM * zmps, names, names)
        columns.curves(
            f"balance/{name}/support",
            log.time[frames],
            MM * sides[frames, :, axis],
            ("support, least", "support, greatest"),
            "limit",
        )
    planned = motion.com[nearest_frames(log.time, motion.rate, len(motion.com))]
    columns.curves("balance/com_error", log.time, MM * (log.com - planned), ("x", "y", "z"))
    columns.curves("balance/load", log.time, log.foot_wrench[:, :, 2], motion.robot.feet)


def _send_joints(columns: Columns, log: RunLog, motion: Motion) -> None:
    robot, ends = motion.robot, log.time[[0, -1]]
    angle = log.q[:, 7:]
    error = angle - motion.q[nearest_frames(log.time, motion.rate, len(motion.q)), 7:]
    room = np.minimum(angle - robot.lower, robot.upper - angle)
    for limb, groups in LIMBS.items():
        joints = [joint for group in groups for joint in robot.groups[group]]
        names = [robot.joints[joint] for joint in joints]
        entity = f"joints/{limb}"
        columns.curves(f"{entity}/angle", log.time, np.rad2deg(angle[:, joints]), names)
        columns.curves(f"{entity}/error", log.time, np.rad2deg(error[:, joints]), names)
        columns.curves(f"{entity}/room/joints", log.time, np.rad2deg(room[:, joints]), names)
        columns.curves(f"{entity}/room/limit", ends, np.zeros(2), ["limit"], "limit")
        columns.curves(f"{entity}/torque/joints", log.time, log.torque[:, joints], names)
        efforts = np.unique(robot.effort[joints])
        limits = np.concatenate([efforts, -efforts])
        named = [f"limit {limit:+g}" for limit in limits]
        columns.curves(f"{entity}/torque/limits", ends, np.tile(limits, (2, 1)), named, "limit")


def _send_ticks(columns: Columns, log: RunLog) -> None:
    for index, level in enumerate(log.level_names):
        columns.curves(["tasks", level], log.time, log.level_error[:, index], ["error"])
    if log.level_names:
        columns.curves("tick/slack", log.time, log.level_slack, log.level_names)
        columns.curves("tick/active", log.time, log.level_active, log.level_names)
    parts = np.column_stack([log.tick_us, log.model_us, log.assemble_us, log.solve_us])
    columns.curves("tick/time", log.time, parts, ("tick", "model", "assemble", "solve"))
    columns.curves("tick/status", log.time, log.status, ["status"])
    columns.curves("tick/residual", log.time, log.residual, ["residual"])


def _about(info: RunInfo, robot: Robot) -> str:
    ending = "upright to the end" if info.fell_at_s is None else f"fell at {info.fell_at_s:.2f} s: {info.reason}"
    return f"""# {info.clip}

{robot.label}, solver {info.solver}, feet {info.feet}, {info.rate_hz:.0f} Hz: {ending}.

In 3D, from left to right: the human in the robot's size, the simulated robot, the reference that it follows.
Arrows from below are the floor's force on each foot (1 m is {1 / METRES_PER_NEWTON:.0f} N), the green outline is the
planned support. Dots on the floor are the ZMP: measured (orange), predicted by the controller (blue), planned
(green). The yellow ball is the centre of mass. A red arrow is a push. Red lines in the curves are limits.
"""
