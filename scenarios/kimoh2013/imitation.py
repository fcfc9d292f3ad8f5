"""Imitation of a captured human with the ranges of a knee and a hip roll narrowed, Kim & Oh 5.3."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.inputs.clips import find_clip
from scenarios.kimoh2013.imitation_view import draw_picture
from scenarios.kimoh2013.kinematic import KinematicRun, follow_tasks
from scenarios.kimoh2013.rivals import LevelByLevel
from scenarios.replay import Dance, ProgressCallback
from solvers import Cascade, Solver, Status, TaskCorrection
from sot.control.contact import Contact
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.control.task import Task
from sot.control.tick import Tick
from sot.motion import plan, read, recognise
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from tasks import CenterOfMass, JointBounds, LeastForces, OperationalPoint, Posture, TorqueBounds, TorqueRateBounds

Array = np.ndarray

SOLVER = "iktc"
CLIP = "groove"
NARROWED_SIDE = "left"
KEPT_RANGE_SHARE = 0.7
"""Share of the range used by the reference that a narrowed joint keeps."""
CONTROL_PERIOD = 0.005
"""Period of the position control, the paper's for the legs [s]."""
SOLVERS: dict[str, Callable[[], Solver]] = {
    "iktc": TaskCorrection,
    "cascade": Cascade,
    "a QP a level": LevelByLevel,
}
PICTURE_FILE = "imitation.svg"
GIVEN_UP_SLACK = 1e-4
UPPER_BODY = ("chest", "head", "left_arm", "right_arm")


def motion(robot: Robot, rate: float) -> Motion:
    """The clip that ships with the project, with planted feet."""
    return plan(recognise(read(find_clip(CLIP))), robot, "planted", rate).motion


def task_levels(robot: Robot, motion: Motion) -> dict[str, Sequence[Task]]:
    """Table 1 below the feet: 2 + 3 + 1 rows, and the joints of the upper body."""
    upper = [robot.joints[k] for group in UPPER_BODY for k in robot.groups[group]]
    return {
        "com": [CenterOfMass(lambda t: motion.balance(t)[:3], axes="xy")],
        "attitude": [OperationalPoint(robot, "waist", motion.pose("waist"), axes="RPY")],
        "height": [OperationalPoint(robot, "waist", motion.pose("waist"), axes="z")],
        "upper body": [Posture(robot, motion.joints, upper, name="Posture upper body")],
    }


def stack(robot: Robot, motion: Motion) -> Stack:
    """Table 1 under dynamics: the feet are contacts."""
    return Stack(
        contacts=[Contact(robot.surface(foot)) for foot in robot.feet],
        hard=[TorqueBounds(robot), TorqueRateBounds(robot), JointBounds(narrowed_robot(robot, motion))],
        levels={**task_levels(robot, motion), "forces": [LeastForces()]},
    )


def schedule(robot: Robot, motion: Motion) -> Schedule:
    """Nothing changes."""
    return Schedule()


def findings(danced: Dance, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Table 1 by a position-controlled robot too, all five levels of it; the picture of Figures 18–20 of both.

    Returns:
        What the position-controlled robot took and gave up, by solver, and how far it came beyond its limits.
    """
    motion = danced.motion
    robot = narrowed_robot(motion.robot, motion)
    feet = [OperationalPoint(robot, foot, motion.pose(foot)) for foot in robot.feet]
    asked = [("feet", feet), *task_levels(robot, motion).items()]
    position_runs = {}
    for name, solver in SOLVERS.items():
        tell(f"position control, {name}", None)
        limits = [JointBounds(robot)]
        position_runs[name] = follow_tasks(robot, motion.q[0], limits, asked, solver(), CONTROL_PERIOD, motion.duration)
    out.mkdir(parents=True, exist_ok=True)
    draw_picture(out / PICTURE_FILE, danced, position_runs[SOLVER], robot, narrowed_joints(robot))
    names = [name for name, _ in asked]
    return {name: _figures(position_run, robot, names, motion) for name, position_run in position_runs.items()}


def show(figures: dict[str, Any], console: Console) -> None:
    """Print what the position-controlled robot did."""
    found = figures["imitation"]
    table = Table(box=None, padding=(0, 2, 0, 0))
    for words in ("position control", *found):
        table.add_column(words, justify="right" if words in found else "left")
    for level in found[SOLVER]["given_up"]:
        shares = (f"{100.0 * figure['given_up'][level]:.1f}" for figure in found.values())
        table.add_row(f"ticks that give up some '{level}' [%]", *shares)
    for key, words, digits in (
        ("qps_mean", "quadratic programs a tick, mean", ".2f"),
        ("qps_most", "… most", ".0f"),
        ("free_us", "solver, median while nothing is given up [µs]", ".0f"),
        ("bound_us", "… while something is [µs]", ".0f"),
        ("beyond_rad", "beyond a range [rad]", ".1e"),
        ("beyond_velocity", "beyond a velocity, over the limit", ".1e"),
        ("beyond_acceleration", "beyond an acceleration, over the limit", ".1e"),
        ("upper_body_rad", "upper body off its reference, most [rad]", ".2f"),
        ("unsolved", "ticks without an answer at some level", ".0f"),
    ):
        values = (figure[key] for figure in found.values())
        table.add_row(words, *("-" if value is None else f"{value:{digits}}" for value in values))
    console.print(table)


def narrowed_robot(robot: Robot, motion: Motion) -> Robot:
    """The robot with narrower ranges of a knee and a hip roll than the motion uses."""
    lower, upper = robot.lower.copy(), robot.upper.copy()
    angles = motion.q[:, 7:]
    for joint in narrowed_joints(robot):
        used = angles[:, joint]
        room = 0.5 * (1.0 - KEPT_RANGE_SHARE) * np.ptp(used)
        # Where the motion starts has to be inside.
        lower[joint] = max(lower[joint], min(used.min() + room, used[0] - 0.02))
        upper[joint] = min(upper[joint], max(used.max() - room, used[0] + 0.02))
    return replace(robot, lower=lower, upper=upper, acceleration_hard=robot.acceleration)


def narrowed_joints(robot: Robot) -> tuple[int, int]:
    """Numbers of the knee joint and of the hip joint that turns about the forward axis."""
    tick = Tick(robot).update(0.0, robot.rest, np.zeros(robot.nv))
    leg = robot.groups[f"{NARROWED_SIDE}_leg"]
    frame = robot.model.frames[robot.point(f"{NARROWED_SIDE}_knee")]
    knee = robot.joints.index(robot.model.names[frame.parentJoint])
    forward = np.abs(tick.frame(f"{NARROWED_SIDE}_foot").jacobian[3, 6:])
    above = leg[: leg.index(knee)]
    return knee, max(above, key=lambda joint: forward[joint])


def _figures(position_run: KinematicRun, robot: Robot, names: Sequence[str], motion: Motion) -> dict[str, Any]:
    given_up = position_run.slack[:, 1:] > GIVEN_UP_SLACK
    bound = given_up.any(axis=1)
    q, v, a = position_run.q[:, 7:], np.abs(position_run.v[:, 6:]), np.abs(position_run.a[:, 6:])
    upper = [k for group in UPPER_BODY for k in robot.groups[group]]
    wanted = np.array([motion.joints(t)[0] for t in position_run.time])
    return {
        "given_up": dict(zip(names, given_up.mean(axis=0).tolist(), strict=True)),
        "qps_mean": float(position_run.qps.mean()),
        "qps_most": int(position_run.qps.max()),
        "free_us": _median(position_run.solve_us[~bound]),
        "bound_us": _median(position_run.solve_us[bound]),
        "beyond_rad": float(max(np.max(q - robot.upper), np.max(robot.lower - q), 0.0)),
        "beyond_velocity": float(max((v / robot.velocity).max() - 1.0, 0.0)),
        "beyond_acceleration": float(max((a / robot.acceleration).max() - 1.0, 0.0)),
        "upper_body_rad": float(np.abs(q - wanted)[:, upper].max()),
        "unsolved": int(np.count_nonzero(position_run.status >= Status.RELAXED)),
    }


def _median(values: Array) -> float | None:
    return float(np.median(values)) if len(values) else None
