"""A position-controlled robot: accelerations from tasks, integrated, without dynamics or contacts."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
import pinocchio as pin

from solvers import Level, Solver
from sot.control.task import Task
from sot.control.tick import Tick
from sot.robots.robot import Robot

Array = np.ndarray


@dataclass(frozen=True)
class KinematicRun:
    """Commands of a position-controlled robot, one row a tick.

    Attributes:
        time: Start of the tick [s], (T,).
        q, v, a: Configuration, velocity and acceleration in Pinocchio's conventions, (T, nq), (T, nv), (T, nv).
        qps: Quadratic programs, (T,).
        slack: Norm of each level's violation, level 0 first, (T, L).
        status: `solvers.rows.Status`, (T,).
        solve_us: Time of the solver [µs], (T,).
    """

    time: Array
    q: Array
    v: Array
    a: Array
    qps: Array
    slack: Array
    status: Array
    solve_us: Array


def assemble_levels(tick: Tick, limits: Sequence[Task], levels: Sequence[tuple[str, Sequence[Task]]]) -> list[Level]:
    """Levels of rows on v̇: the limits as level 0, then the tasks."""
    nv = tick.robot.nv
    hard = Level.stack("hard", [limit.rows(tick) for limit in limits], nv)
    return [hard, *(Level.stack(name, [task.rows(tick) for task in tasks], nv) for name, tasks in levels)]


def follow_tasks(
    robot: Robot,
    q: Array,
    limits: Sequence[Task],
    levels: Sequence[tuple[str, Sequence[Task]]],
    solver: Solver,
    period: float,
    duration: float,
    tell: Callable[[float], object] = lambda share: None,
) -> KinematicRun:
    """Integrate the accelerations that follow the tasks from rest; each is constant over a period.

    Args:
        robot: The robot.
        q: Where it starts, (nq,).
        limits: Of level 0.
        levels: Names and tasks of the levels below, in order.
        solver: Whose accelerations are integrated.
        period: Of the control [s].
        duration: How long [s].
        tell: Told which share is done.
    """
    tick, v = Tick(robot, period), np.zeros(robot.nv)
    columns: dict[str, list[Any]] = {name: [] for name in KinematicRun.__dataclass_fields__}
    ticks = round(duration / period)
    for k in range(ticks):
        tick.update(k * period, q, v)
        rows = assemble_levels(tick, limits, levels)
        begun = perf_counter()
        solution = solver.solve(rows)
        took = 1e6 * (perf_counter() - begun)
        a, told = solution.x, solution.levels
        row = (k * period, q, v, a, sum(r.needed_qp for r in told), [r.error for r in told], solution.status, took)
        for name, value in zip(columns, row, strict=True):
            columns[name].append(value)
        q, v = pin.integrate(robot.model, q, period * v + 0.5 * period**2 * a), v + period * a
        tell((k + 1) / ticks)
    return KinematicRun(**{name: np.array(values) for name, values in columns.items()})
