"""Hammam (2), (30): resolved accelerations made torques, under physics."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from scenarios.hammam2015.key_point_reference import KeyPointReference
from scenarios.hammam2015.methods import METHODS, TASK_SETS, Law
from sim import World
from sim.log import RunLog
from sim.loop import run
from sim.reporting.figures import zmp
from solvers import Cascade
from solvers.rows import Rows
from sot.control import Contact, Controller, Stack
from sot.control.task import Task
from sot.control.tick import Tick
from sot.motion import Motion
from sot.robots.robot import Robot
from tasks import Balance, LeastForces, TorqueBounds

Array = np.ndarray

NAME = "ResolvedAccelerations"
METHOD = "CRAC mended"
TASK_SET = 2
STACKS = ("alone", "below balance")
"""The accelerations alone; and below a level that keeps the centre of mass over the middle of the feet."""
MAX_DURATION = 6.0
"""How much of a clip is followed, its lead-in included [s]."""
EVALUATION_RATE = 50.0
"""Rate at which points are evaluated [Hz]."""
GIVEN_UP_SLACK = 1.0
"""Norm of what is left of α_c [rad/s², m/s²] above which a tick counts as one that gave it up."""
ProgressCallback = Callable[[float], object]


class ResolvedAccelerations(Task):
    """Rows ``v̇ = α_c``: with the equation of motion as level 0, (30) with the forces of the contacts."""

    def __init__(self, robot: Robot, law: Law) -> None:
        super().__init__(NAME, "SI", "SI")
        self._law, self._A = law, np.eye(robot.nv)
        self.selects = slice(0, robot.nv)
        self.labels: Sequence[str] = ["base"] * 6 + list(robot.joints)

    def rows(self, tick: Tick) -> Rows:
        """The rows at this tick; no error, since they are a command."""
        wanted = self._law(tick)
        self.error = np.zeros(len(wanted))
        return self.make_rows(self._A, wanted, wanted)


def torque_law_run(
    robot: Robot, reference: KeyPointReference, kind: str, rate: float, progress: ProgressCallback | None = None
) -> dict[str, Any]:
    """Let the robot follow key points under physics, its feet planted.

    Args:
        robot: The robot.
        reference: Of the key points.
        kind: One of STACKS.
        rate: Of the control [Hz].
        progress: Told the time [s].

    Returns:
        "fell_at_s", None if it stayed upright; "points_rms_m"; "beyond_rad", how far a joint came out of its range;
        "given_up", the share of the ticks in which contacts, friction or torques did not allow α_c;
        "zmp_inside", the share of the ticks with the zero-moment point within the feet.
    """
    names = TASK_SETS[TASK_SET]
    law = METHODS[METHOD].law(robot, names, reference.of(names))
    stand = Motion.standing(robot, min(float(reference.times[-1]), MAX_DURATION), rate)
    accelerations = ResolvedAccelerations(robot, law)
    levels: dict[str, Sequence[Task]] = {"resolved": [accelerations], "forces": [LeastForces()]}
    if kind == "below balance":
        levels = {"balance": [Balance(stand.balance, axes="xy")], **levels}
    stack = Stack([Contact(robot.surface(foot)) for foot in robot.feet], [TorqueBounds(robot)], levels)
    done = run(Controller(robot, stack, Cascade(), 1.0 / rate), World(robot, 1.0 / rate), stand, progress)
    return {"fell_at_s": done.fell_at_s, **_figures(robot, done.log.trimmed(), stand, reference, names)}


def _figures(
    robot: Robot, log: RunLog, stand: Motion, reference: KeyPointReference, names: tuple[str, ...]
) -> dict[str, Any]:
    tick, errors, wanted = Tick(robot), [], reference.of(names)
    for row in log.rows_at(EVALUATION_RATE).tolist():
        tick.update(0.0, log.q[row], np.zeros(robot.nv))
        reached = np.array([tick.frame(name).position for name in names])
        errors.append(reached - wanted(float(log.time[row])).positions)
    joints = log.q[:, 7:]
    (level,) = (k for k, name in enumerate(log.level_names) if NAME in name)
    return {
        "points_rms_m": float(np.sqrt(np.mean(np.sum(np.square(errors), axis=2)))),
        "beyond_rad": float(max((joints - robot.upper).max(), (robot.lower - joints).max())),
        "given_up": float(np.mean(log.level_slack[:, level] > GIVEN_UP_SLACK)),
        "zmp_inside": zmp(log, stand)["inside"],
    }
