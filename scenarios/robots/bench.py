"""`sot bench --robots`: the robots that have a name, each with four dances, and what a robot of its size may be off."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from scenarios.replay import Dance, ProgressCallback, Replay
from scenarios.suite import Columns, Piece, SuccessRule, Suite, bench_suite, show
from sot.errors import InputError
from sot.robots.robot import Robot, robot_names
from sot.robots.size import leg_length

GROOVE = Piece("groove", "groove", feet="planted")
CLIP_PIECES = (  # clips of a folder that --mocap names
    Piece("planted", "perfume_A.bvh", feet="planted"),
    Piece("stepping 20 s", "perfume_A.bvh", duration=20.0, feet="auto"),
    Piece("walk", "bandai_walk.bvh", feet="auto"),
)
ALLOWED_MM_PER_LEG_M = 15.0 / 0.6  # of key bodies off their reference, by the leg's length
MIN_ALLOWED_MM = 8.0  # that is allowed on the shortest legs
MAX_SATURATED_SHARE = 0.05  # share of ticks in which a joint may have no torque left
COLUMNS: Columns = (
    ("tracking.mpjpe_mm", "off mm", 1.0, 1),
    ("allowed_mm", "allowed", 1.0, 1),
    ("solver.infeasible_ticks", "infeas", 1.0, 0),
    ("torque_saturated", "saturated %", 100.0, 1),
    ("speed", "speed", 1.0, 2),
)
JOINTS_COLUMN = "saturated joints"
MAX_NAMED_JOINTS = 4  # that are named, those that saturate most often


def robot_pieces(mocap: Path | None, robots: Sequence[str] | None = None) -> list[Piece]:
    """The dances of all robots: a groove, and those that a folder has clips for.

    Raises:
        InputError: one of the clips is not in the folder.
    """
    given = []
    for piece in CLIP_PIECES if mocap is not None else ():
        path = Path(mocap or "") / piece.clip
        if not path.is_file():
            raise InputError(
                f"{path}: no such clip; `sot bench --robots` needs {', '.join(sorted({p.clip for p in CLIP_PIECES}))}"
            )
        given.append(Piece(piece.name, str(path), piece.start, piece.duration, feet=piece.feet))
    return [
        Piece(f"{robot} {piece.name}", piece.clip, piece.start, piece.duration, robot, piece.feet)
        for robot in robots or robot_names()
        for piece in (GROOVE, *given)
    ]


def bench_robots(request: Replay, pieces: Sequence[Piece], out: Path | None, tell: ProgressCallback) -> dict[str, Any]:
    """Dance them all, as `bench_suite` does.

    A success is upright, no farther off than a robot of its size may be, without a tick whose hard level had to give
    way, and with torques that saturate rarely: where a clip asks for more, it is to be slowed down.
    """
    return bench_suite(request, pieces, out, tell, ROBOTS)


def show_robots(table: Mapping[str, Any], console: Console) -> None:
    """Print the rows."""
    show(table, console, COLUMNS, (JOINTS_COLUMN,))


def allowed_mm(robot: Robot) -> float:
    """How far key bodies may be off their reference on average [mm]."""
    return max(ALLOWED_MM_PER_LEG_M * leg_length(robot), MIN_ALLOWED_MM)


def _more(request: Replay, danced: Dance, report: Mapping[str, Any]) -> dict[str, Any]:
    joints = report["limits"].get("saturated_joints") or {}
    worst = sorted(joints, key=lambda joint: -joints[joint])[:MAX_NAMED_JOINTS]
    return {"allowed_mm": allowed_mm(danced.motion.robot), JOINTS_COLUMN: ", ".join(worst)}


def _meets_the_rule(row: Mapping[str, Any]) -> bool:
    near = row["tracking.mpjpe_mm"] is not None and row["tracking.mpjpe_mm"] <= row["allowed_mm"]
    strong = row["torque_saturated"] is not None and row["torque_saturated"] <= MAX_SATURATED_SHARE
    return near and strong and row["solver.infeasible_ticks"] == 0


SUCCESS = SuccessRule(
    "upright, key bodies as near to their reference as a robot's size allows, torques at their limit in"
    f" {100.0 * MAX_SATURATED_SHARE:.0f} % of the ticks at most, no tick whose hard level had to give way",
    _meets_the_rule,
)
ROBOTS = Suite(lambda mocap, from_format: robot_pieces(mocap), lambda request: COLUMNS, SUCCESS, _more)
