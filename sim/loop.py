"""The closed loop: state from the world, commands from the controller, one row of the log a tick."""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count, takewhile
from math import isfinite
from time import perf_counter
from typing import Protocol

import numpy as np
import pinocchio as pin
from threadpoolctl import threadpool_limits

from sim.drivers import Driver, PositionController, driver_of
from sim.log import RunLog
from sim.world import World
from sot.control.controller import Controller
from sot.estimation import Estimator
from sot.hardware.servo import JointTargets
from sot.motion.trajectory import Reference

MIN_WAIST_HEIGHT_RATIO = 0.6
"""Height of the waist over its reference height below which the robot counts as fallen."""
MIN_TRUNK_TILT_COSINE = np.cos(np.deg2rad(60.0))
"""Cosine of the angle between the chest's axis and its reference beyond which the robot counts as fallen."""
SLOW_SENSOR_RATE = 60.0
"""Rate at which costly quantities are measured and progress is told [Hz]."""

UNBOUNDED_LOG_S = 60.0
"""Time for which rows of the log are allocated at first where a run has no known end [s]."""


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
        """Called with the commanded joint torques [N m] before the world moves; of servos, with their last ones."""
        ...


def run(
    controller: Controller | PositionController,
    world: World,
    motion: Reference,
    progress: Callable[[float], object] | None = None,
    companion: Companion | None = None,
    estimator: Estimator | None = None,
) -> Run:
    """Run a controller in a world for as long as a reference lasts, from the reference's first configuration.

    A schedule may make the motion wait, and may end the run.

    Args:
        controller: Of torques, or of joint targets if the world's robot has servos and sensors and the reference is a
            `Motion`. Its period is the world's timestep.
        world: Reset to the reference's start, things in their places. What the controller does not know of comes last.
        motion: The reference, for the planned quantities in the log and the signs of a fall; its duration may be
            infinite if a companion ends the run.
        progress: Told the time [s] now and then.
        companion: Goes along with every tick.
        estimator: Tells the controller its state from the readings of the robot's sensors; it is told the simulated
            one unless given.
    """
    driver = driver_of(controller, world, motion, estimator)
    if abs(world.timestep - driver.period) > 1e-12:
        raise ValueError(f"the world steps by {world.timestep} s, the controller by {driver.period} s")
    start = motion.sample(0.0)
    world.reset(start.q, start.v)
    driver.source.reset(start.q, start.v)
    longest = _max_duration(driver, motion)
    log = driver.empty_log(round((longest if isfinite(longest) else UNBOUNDED_LOG_S) / world.timestep))
    # The matrices of a tick are far too small to share between threads.
    with threadpool_limits(1), _garbage_collection_off():
        done = _run_ticks(driver, world, motion, log, progress or (lambda t: None), companion)
    driver.end(log)  # now that nobody waits for a command
    return done


def _run_ticks(
    driver: Driver,
    world: World,
    motion: Reference,
    log: RunLog,
    progress: Callable[[float], object],
    companion: Companion | None,
) -> Run:
    """Run tick by tick, to the end or to a fall."""
    ticks_per_slow_sample = max(1, round(1.0 / (SLOW_SENSOR_RATE * world.timestep)))
    watch = _FallWatch(world, motion)
    start = perf_counter()

    def wall_s() -> float:
        return perf_counter() - start - (companion.waited_s if companion else 0.0)

    end = _max_duration(driver, motion) - 0.5 * world.timestep
    for k in takewhile(lambda k: k * world.timestep < end, count()):
        t = k * world.timestep
        q, v = world.state()
        if not isfinite(q @ q + v @ v):
            return Run(log, wall_s(), t, "the simulation diverged")
        if companion and not companion.tick_begins(t, q, v):
            break
        if k == len(log.time):
            log.lengthen()
        deflections = world.sole_deflections()
        command = driver(k, t, q, v, log)
        if companion:
            companion.command_given(t, world.applied_torque() if isinstance(command, JointTargets) else command)
        world.step(command)
        _write_log_row(log, k, t, q, v, deflections, world, motion)
        driver.write(k, t, log)
        log.ticks = k + 1
        if k % ticks_per_slow_sample == 0:
            log.self_distance[k] = world.self_distance()
            progress(t)
            if reason := watch(t, q, driver):
                return Run(log, wall_s(), t, reason)
        if driver.schedule is not None and driver.schedule.finished:
            break
    return Run(log, wall_s())


def _max_duration(driver: Driver, motion: Reference) -> float:
    """Longest time that a run may last [s]: the motion's, and what its schedule may wait."""
    return motion.duration + (driver.schedule.extra_time if driver.schedule is not None else 0.0)


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
    """Tells whether the simulated robot has fallen, and by which sign."""

    def __init__(self, world: World, motion: Reference) -> None:
        self._world = world
        self._data = world.robot.model.createData()
        self._waist, self._chest = motion.pose("waist"), motion.pose("chest")

    def __call__(self, t: float, q: np.ndarray, driver: Driver) -> str:
        robot = self._world.robot
        played = t if driver.schedule is None else driver.schedule.motion_time(t)
        pin.forwardKinematics(robot.model, self._data, q[: robot.nq])
        waist, chest = (
            pin.updateFramePlacement(robot.model, self._data, robot.point(point)) for point in ("waist", "chest")
        )
        if waist.translation[2] < MIN_WAIST_HEIGHT_RATIO * self._waist(played).position[2]:
            return "the waist sank below 60 % of its reference height"
        if chest.rotation[:, 2] @ self._chest(played).rotation[:, 2] < MIN_TRUNK_TILT_COSINE:
            return "the trunk tilted by more than 60° from its reference"
        meant = [c.point for c in driver.contacts if c.mode != "off" and c.is_footing]
        if bodies := self._world.touching([point for point in meant if point in robot.points]):
            return f"{', '.join(bodies)} touched the floor"
        return ""


def _write_log_row(
    log: RunLog,
    k: int,
    t: float,
    q: np.ndarray,
    v: np.ndarray,
    deflections: np.ndarray,
    world: World,
    motion: Reference,
) -> None:
    """Write what the world did in a tick. The forces are those of the physics step that the command has just driven."""
    robot = world.robot
    log.time[k], log.q[k], log.v[k] = t, q[: robot.nq], v[: robot.nv]
    log.thing_q[k], log.thing_v[k] = q[robot.nq :], v[robot.nv :]
    log.zmp_measured[k], log.zmp_planned[k] = world.zmp(), motion.balance(t)[3]
    wrenches = world.foot_wrenches()
    for i, foot in enumerate(robot.feet):
        log.foot_wrench[k, i] = wrenches[foot]
    if world.hardware.compliance is not None:
        log.sole_deflection[k] = deflections
    if world.hardware.sensors is not None:
        readings = world.readings()
        for i, foot in enumerate(robot.feet):
            log.foot_reading[k, i] = readings.foot_wrench[foot]
