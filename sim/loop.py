"""The closed loop: state from the world, torques from the controller, one row of the log a tick."""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count, takewhile
from math import isfinite, sqrt
from time import perf_counter
from typing import Protocol

import numpy as np
from threadpoolctl import threadpool_limits

from sim.log import FOOT_FIXED, FOOT_OFF, FOOT_SLIDING, Fallback, RunLog
from sim.touch import Touch
from sim.world import World
from solvers.conflict import find_conflict
from solvers.rows import Level, Solution, Status
from sot.control.controller import Command, Controller
from sot.motion.trajectory import Reference

MIN_WAIST_HEIGHT_RATIO = 0.6
"""Height of the waist over its reference height below which the robot counts as fallen."""
MIN_TRUNK_TILT_COSINE = np.cos(np.deg2rad(60.0))
"""Cosine of the angle between the chest's axis and its reference beyond which the robot counts as fallen."""
SLOW_SENSOR_RATE = 60.0
"""Rate at which costly quantities are measured and progress is told [Hz]."""

UNBOUNDED_LOG_S = 60.0
"""Time for which rows of the log are allocated at first where a run has no known end [s]."""

_MODES = {"off": FOOT_OFF, "fixed": FOOT_FIXED, "sliding": FOOT_SLIDING}


@dataclass(slots=True)
class Run:
    """A run's log and how it ended.

    Args:
        log: One row a control tick, to the end or to the fall.
        wall_s: Wall-clock time of controller, physics and logging [s].
        fell_at_s: When the robot fell [s], None if it did not.
        reason: By which sign.
    """

    log: RunLog
    wall_s: float
    fell_at_s: float | None = None
    reason: str = ""


class Companion(Protocol):
    """Something that goes along with a run tick by tick: a stream to be read, a clock to be kept, a viewer."""

    waited_s: float
    """Wall-clock time that it has spent waiting [s]; it does not count as the run's."""

    def tick_begins(self, t: float, q: np.ndarray, v: np.ndarray) -> bool:
        """Called before the controller is, with the time [s] and the simulated state; False ends the run."""
        ...

    def command_given(self, t: float, torque: np.ndarray) -> None:
        """Called with the commanded joint torques [N m] before the world moves."""
        ...


def run(
    controller: Controller,
    world: World,
    motion: Reference,
    progress: Callable[[float], object] | None = None,
    companion: Companion | None = None,
) -> Run:
    """Run a controller in a world for as long as a reference lasts, from the reference's first configuration.

    A schedule may make the motion wait, and may end the run.

    Args:
        controller: Its period is the world's timestep.
        world: Reset to the reference's start, things in their places. What the controller does not know of comes last.
        motion: The reference, for the planned quantities in the log and the signs of a fall; its duration may be
            infinite if a companion ends the run.
        progress: Told the time [s] now and then.
        companion: Goes along with every tick.
    """
    robot = world.robot
    if abs(world.timestep - controller.tick.period) > 1e-12:
        raise ValueError(f"the world steps by {world.timestep} s, the controller by {controller.tick.period} s")
    start = motion.sample(0.0)
    world.reset(start.q, start.v)
    controller.stack.settle()
    entries = [(level, task) for level, tasks in controller.stack.levels for task in tasks]
    if controller.schedule is not None:
        entries += controller.schedule.tasks
    contacts = controller.stack.contacts
    longest = _max_duration(controller, motion)
    log = RunLog.allocate(
        world.system,
        round((longest if isfinite(longest) else UNBOUNDED_LOG_S) / world.timestep),
        [f"{level}: {task.name}" for level, task in entries],
        [task.error_unit for _, task in entries],
        [] if all(contact.name in robot.feet for contact in contacts) else [contact.name for contact in contacts],
    )
    columns = {task.name: k for k, (_, task) in enumerate(entries)}
    unsolved: list[tuple[float, Level]] = []
    # The matrices of a tick are far too small to share between threads.
    with threadpool_limits(1), _garbage_collection_off():
        done = _run_ticks(controller, world, motion, log, columns, unsolved, progress or (lambda t: None), companion)
    explained = ((t, find_conflict([level])) for t, level in unsolved)  # now that nobody waits for a torque
    log.conflicts = [(t, str(conflict)) for t, conflict in explained if conflict is not None]
    return done


def _run_ticks(
    controller: Controller,
    world: World,
    motion: Reference,
    log: RunLog,
    columns: dict[str, int],
    unsolved: list[tuple[float, Level]],
    progress: Callable[[float], object],
    companion: Companion | None,
) -> Run:
    """Run tick by tick, to the end or to a fall."""
    ticks_per_slow_sample = max(1, round(1.0 / (SLOW_SENSOR_RATE * world.timestep)))
    watch = _FallWatch(world, motion)
    start = perf_counter()

    def wall_s() -> float:
        return perf_counter() - start - (companion.waited_s if companion else 0.0)

    wrenches, touches = world.foot_wrenches(), _touches(world, controller, log)
    nq, nv = controller.system.nq, controller.system.nv
    end = _max_duration(controller, motion) - 0.5 * world.timestep
    for k in takewhile(lambda k: k * world.timestep < end, count()):
        t = k * world.timestep
        q, v = world.state()
        if not isfinite(q @ q + v @ v):
            return Run(log, wall_s(), t, "the simulation diverged")
        if companion and not companion.tick_begins(t, q, v):
            break
        if k == len(log.time):
            log.lengthen()
        sensed = world.measured(q[:nq], v[:nv])
        loads = {foot: float(wrench[2]) for foot, wrench in wrenches.items()}
        if log.contact_names:
            loads |= {name: touches[name].normal if name in touches else 0.0 for name in log.contact_names}
        begin = perf_counter()
        command = controller(t, *sensed, loads)
        log.tick_us[k] = 1e6 * (perf_counter() - begin)
        if companion:
            companion.command_given(t, command.torque)
        world.step(command.torque)
        wrenches, touches = world.foot_wrenches(), _touches(world, controller, log)
        _write_log_row(log, k, t, q, v, command, wrenches, controller, world, motion, columns)
        if log.contact_names:
            _write_contacts(log, k, controller, touches)
        if command.unsolved is not None:
            unsolved.append((t, command.unsolved))
        log.ticks = k + 1
        if k % ticks_per_slow_sample == 0:
            log.self_distance[k] = world.self_distance()
            progress(t)
            if reason := watch(t, controller):
                return Run(log, wall_s(), t, reason)
        if controller.schedule is not None and controller.schedule.finished:
            break
    return Run(log, wall_s())


def _max_duration(controller: Controller, motion: Reference) -> float:
    """Longest time that a run may last [s]: the motion's, and what its schedule may wait."""
    return motion.duration + (controller.schedule.extra_time if controller.schedule is not None else 0.0)


def _touches(world: World, controller: Controller, log: RunLog) -> dict[str, Touch]:
    """Touches of the contacts of a log; none if these are the feet's, which have sensors of their own."""
    return world.contact_touches(controller.stack.contacts) if log.contact_names else {}


@contextmanager
def _garbage_collection_off() -> Iterator[None]:
    """Turn the garbage collector off: a tick makes no cycles, and looking for them takes several ticks' time."""
    was = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


class _FallWatch:
    """Tells whether the robot has fallen, and by which sign."""

    def __init__(self, world: World, motion: Reference) -> None:
        self._world = world
        self._waist, self._chest = motion.pose("waist"), motion.pose("chest")

    def __call__(self, t: float, controller: Controller) -> str:
        played = t if controller.schedule is None else controller.schedule.motion_time(t)
        waist, chest = controller.tick.frame("waist"), controller.tick.frame("chest")
        if waist.position[2] < MIN_WAIST_HEIGHT_RATIO * self._waist(played).position[2]:
            return "the waist sank below 60 % of its reference height"
        if chest.rotation[:, 2] @ self._chest(played).rotation[:, 2] < MIN_TRUNK_TILT_COSINE:
            return "the trunk tilted by more than 60° from its reference"
        meant = [c.point for c in controller.stack.contacts if c.mode != "off" and c.is_footing]
        if bodies := self._world.touching([point for point in meant if point in self._world.robot.points]):
            return f"{', '.join(bodies)} touched the floor"
        return ""


def _write_log_row(
    log: RunLog,
    k: int,
    t: float,
    q: np.ndarray,
    v: np.ndarray,
    command: Command,
    wrenches: dict[str, np.ndarray],
    controller: Controller,
    world: World,
    motion: Reference,
    columns: dict[str, int],
) -> None:
    """Write one row of the log. The forces are those of the physics step that the command has just driven."""
    robot = world.robot
    log.time[k], log.q[k], log.v[k] = t, q[: robot.nq], v[: robot.nv]
    log.thing_q[k], log.thing_v[k] = q[robot.nq :], v[robot.nv :]
    log.torque[k], log.acceleration[k] = command.torque[: robot.na], command.acceleration[: robot.nv]
    log.zmp_control[k], log.zmp_measured[k] = command.zmp, world.zmp()
    log.zmp_planned[k], log.com[k] = motion.balance(t)[3], controller.tick.com
    for i, foot in enumerate(robot.feet):
        log.foot_wrench[k, i] = wrenches[foot]
    for contact in controller.stack.contacts:
        if contact.point in wrenches and contact.is_footing:
            i = robot.feet.index(contact.point)
            log.foot_mode[k, i], log.foot_ramp[k, i] = _MODES[contact.mode], contact.load
    solution = command.solution
    log.status[k], log.hard_status[k] = command.status, solution.levels[0].status
    log.residual[k] = max(level.residual for level in solution.levels)
    if command.invalid:
        log.invalid.append((t, command.invalid))
    if command.status in (Status.SECOND_SOLVER, Status.FAILED):
        log.fallbacks.append(_describe_fallback(t, solution))
    shares = controller.stack.transition_shares
    for place, ((_, tasks), level) in enumerate(zip(controller.stack.levels, solution.levels[1:], strict=True), 1):
        slack = level.error
        active = np.count_nonzero(level.active) if len(level.level.lower) else 0
        for task in tasks:
            column = columns.get(task.name)
            if column is not None:
                log.level_error[k, column] = sqrt(task.error @ task.error)
                log.level_slack[k, column], log.level_active[k, column] = slack, active
                log.level_place[k, column], log.level_share[k, column] = place, shares.get(task.name, 1.0)
    log.model_us[k], log.assemble_us[k], log.solve_us[k] = command.model_us, command.assemble_us, command.solve_us


def _write_contacts(log: RunLog, k: int, controller: Controller, touches: dict[str, Touch]) -> None:
    """Write the contacts of one row of the log."""
    log.contact_force[k], log.contact_normal[k] = 0.0, 0.0
    for contact in controller.stack.contacts:
        if contact.name in log.contact_names:
            i = log.contact_names.index(contact.name)
            log.contact_mode[k, i], log.contact_ramp[k, i] = _MODES[contact.mode], contact.load
            if contact.name in touches:
                log.contact_force[k, i] = touches[contact.name].force
                log.contact_normal[k, i] = touches[contact.name].normal


def _describe_fallback(t: float, solution: Solution) -> Fallback:
    """The record of a tick whose answer was not the solver's own."""
    worst = max(solution.levels, key=lambda level: level.status)
    served = ""
    if worst.status == Status.FAILED:
        served = "; the last torque was held" if worst is solution.levels[0] else "; the levels above kept theirs"
    return Fallback(t, worst.name, worst.reason + served, worst.residual)
