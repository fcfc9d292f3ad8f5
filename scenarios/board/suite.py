"""The suite of the board: the G1 dances each clip in its own time and along its own way, twenty seconds of it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenarios.board.protocol import MAX_STEPS, RATE_HZ, board_figures, laid_at
from scenarios.inputs.dancer import robot_motion
from scenarios.replay import Dance, Replay
from scenarios.suite import Columns, Piece, SuccessRule, Suite, folder_pieces
from sim.log import RunLog, nearest_frames
from sim.reporting.simulated import MIN_LOAD_SHARE
from sot.gravity import GRAVITY
from sot.motion.body.coordinates import to_pinocchio
from sot.motion.plan import Plan
from sot.robots.robot import Robot

Array = NDArray[np.float64]

ROBOT = "g1"
SECONDS = MAX_STEPS / RATE_HZ
NAMED = ("lafan1_dance1_subject2", "lafan1_aiming", "cmu_01_01")
MOTIONS_FORMAT, MOTIONS = "holosoma-npz", ("sub3_largebox_003_mj", "motion_crawl_slope")
MOTIONS_FOLDER = "motions/g1_29dof/whole_body_tracking"  # in the package that brings the robot
COLUMNS: Columns = (
    ("board.completion", "done %", 100.0, 1),
    ("board.mjlab_completion", "mjlab %", 100.0, 1),
    ("board.local_mpjpe_mm", "local mm", 1.0, 1),
    ("board.joint_mae_rad", "joints rad", 1.0, 3),
    ("board.root_drift_mm", "drift mm", 1.0, 0),
    ("board.slip_m_s", "slip m/s", 1.0, 3),
    ("board.loaded_slip_m_s", "loaded m/s", 1.0, 4),
    ("board.power_w", "power W", 1.0, 0),
    ("board.planned_s", "added s", 1.0, 2),
)
SHARES = ("board.completion", "board.mjlab_completion")  # of all steps there are


def board_pieces(folder: Path | None, from_format: str | None) -> list[Piece]:
    """The clips: those of a folder, robot's motions if a format is named, or those that packages bring.

    Raises:
        InputError: no such folder or format, or no clip in it.
    """
    if folder is not None:
        return [piece.part(0.0, SECONDS) for piece in folder_pieces(folder, from_format)]
    motions = Robot.load(ROBOT).path.parents[2] / MOTIONS_FOLDER
    return [
        *(Piece(name, str(motions / f"{name}.npz"), 0.0, SECONDS, from_format=MOTIONS_FORMAT) for name in MOTIONS),
        *(Piece(name, name, 0.0, SECONDS) for name in NAMED),
    ]


def board_row(request: Replay, danced: Dance, report: Mapping[str, Any]) -> dict[str, Any]:
    """The board's columns of a dance, from where the clip starts on: before, the robot comes from rest to its first
    pose, and the reference is laid where it then is."""
    planned, robot, log = danced.plan, danced.motion.robot, danced.run.log.trimmed()
    assert isinstance(planned, Plan)
    reference = _reference(request, planned, robot)
    times = planned.start + np.arange(len(reference)) / RATE_HZ
    times = times[times <= log.time[-1]]
    if not len(times):
        return {place: 0.0 if place in SHARES else None for place, *_ in COLUMNS} | {"board.steps": 0.0}
    rows = nearest_frames(times, 1.0 / log.period, log.ticks)
    done = log.q[rows]
    loaded = log.foot_wrench[rows, :, 2] > MIN_LOAD_SHARE * robot.mass * GRAVITY
    figures = board_figures(robot, laid_at(reference, done[0]), done, _power(log, rows), loaded)
    return {f"board.{name}": value for name, value in figures.items()} | {"board.planned_s": planned.added_time}


def board_average(place: str, rows: Sequence[Mapping[str, Any]]) -> float | None:
    """What the rows come to in a column: means over all steps that were done, as the board's."""
    if place in SHARES:
        return fmean(row[place] or 0.0 for row in rows)
    told = [row for row in rows if row[place] is not None]
    steps = sum(row["board.steps"] for row in told)
    return float(sum(row["board.steps"] * row[place] for row in told) / steps) if steps else None


def _reference(request: Replay, planned: Plan, robot: Robot) -> Array:
    """Configurations (T, nq) at the board's rate: of a robot's motion its own, of a human's clip those of the body that
    looks like the human before anything of it is balanced."""
    if request.from_format is not None:
        motion = robot_motion(request, robot).part(request.start, request.duration)
        return motion.resampled(RATE_HZ).q[:MAX_STEPS]
    times = planned.start + np.arange(int((planned.end - planned.start) * RATE_HZ + 1e-6) + 1) / RATE_HZ
    imitation = (planned.imitation(times[:MAX_STEPS], derivative) for derivative in range(3))
    q: Array = to_pinocchio(*imitation)[0]
    return q


def _power(log: RunLog, rows: NDArray[np.int_]) -> Array:
    """Mean mechanical power Σ|τ q̇| [W] in the steps that begin at rows (n,)."""
    ticks = np.abs(log.torque * log.v[:, 6:]).sum(axis=1)
    ends = [*rows[1:], min(rows[-1] + round(1.0 / (RATE_HZ * log.period)), log.ticks)]
    return np.array([ticks[first : max(last, first + 1)].mean() for first, last in zip(rows, ends, strict=True)])


SUCCESS = SuccessRule(
    "upright to the end, in the reference's own time, within the board's bounds in every step; means are over steps",
    lambda row: row["board.completion"] == 1.0 and not row["board.planned_s"],
)
BOARD = Suite(
    pieces=board_pieces,
    columns=lambda request: COLUMNS,
    success=SUCCESS,
    more=board_row,
    average=board_average,
    robot=ROBOT,
    as_danced=True,
)
