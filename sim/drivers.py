"""Drivers: what runs a controller tick by tick, of torques or of joint targets, and logs what it knows of each."""

from collections.abc import Sequence
from functools import partial
from math import sqrt
from time import perf_counter
from typing import Protocol, runtime_checkable

import numpy as np
import pinocchio as pin

from sim.estimation.source import EstimatedState, SimulatedState, StateSource
from sim.log import FOOT_FIXED, FOOT_OFF, FOOT_ROLLING, FOOT_SLIDING, Fallback, RunLog
from sim.touch import Touch
from sim.world import World
from solvers.conflict import find_conflict
from solvers.rows import Level, Solution, Status
from sot.control.contact import Contact
from sot.control.controller import Command, Controller
from sot.control.pose import Pose
from sot.control.schedule import Schedule
from sot.errors import InputError
from sot.estimation import LEVEL_GROUND, Estimator, Footing
from sot.hardware.readings import Readings
from sot.hardware.servo import JointTargets
from sot.motion.feet.contacts import Phase, phase_at
from sot.motion.trajectory import Motion, Reference

Array = np.ndarray

_MODES = {"off": FOOT_OFF, "fixed": FOOT_FIXED, "sliding": FOOT_SLIDING}


class PositionController(Protocol):
    """State and readings in, joint targets out: a controller of a robot whose joints have servos.

    Attributes:
        period: control period [s].
    """

    period: float

    def __call__(self, t: float, q: Array, v: Array, readings: Readings) -> JointTargets:
        """One tick at a time [s].

        Args:
            t: since the start of the run [s].
            q, v: state of the robot as far as it is known (nq,), (nv,), Pinocchio's conventions.
            readings: of its sensors; their stamp says of when.
        """
        ...


@runtime_checkable
class HasPhase(Protocol):
    """A position controller whose feet may stand otherwise than its motion has them."""

    def phase(self, t: float) -> Phase:
        """The feet that stand at a time [s], the last one or the next, and where."""
        ...


class Driver(Protocol):
    """Runs a controller in a world.

    Attributes:
        period: control period [s].
        schedule: of the controller, if it has one.
        contacts: that the controller relies on, as they are planned now.
        source: where its state comes from.
    """

    period: float
    schedule: Schedule | None
    source: StateSource

    @property
    def contacts(self) -> Sequence[Contact]: ...

    def empty_log(self, ticks: int) -> RunLog:
        """A log with room for a number of ticks; the robot is about to start."""
        ...

    def __call__(self, k: int, t: float, q: Array, v: Array, log: RunLog) -> Array | JointTargets:
        """The command of tick k at a time [s], for the simulated state of the system; the time it took is logged."""
        ...

    def write(self, k: int, t: float, log: RunLog) -> None:
        """Log what is known of tick k, once the world has moved."""
        ...

    def end(self, log: RunLog) -> None:
        """Log what takes long to find out, when the run is over."""
        ...


def driver_of(
    controller: Controller | PositionController, world: World, motion: Reference, estimator: Estimator | None = None
) -> Driver:
    """What runs a controller in a world along a motion, on the state of an estimator if there is one.

    Raises:
        InputError: there is an estimator, and the stack has contacts other than of soles with the world.
    """
    if isinstance(controller, Controller):
        return StackDriver(controller, world, motion, estimator)
    if not isinstance(motion, Motion):
        raise TypeError("a position controller follows a motion whose phases are known")
    return TargetDriver(controller, world, motion, estimator)


class StackDriver:
    """Runs a stack of tasks: torques out.

    Args:
        controller: of the stack.
        world: that it acts on.
        motion: the reference, for where feet are to stand.
        estimator: of its state; the controller is told the simulated one unless given.
    """

    def __init__(
        self, controller: Controller, world: World, motion: Reference, estimator: Estimator | None = None
    ) -> None:
        self.period, self.schedule = controller.tick.period, controller.schedule
        self._controller, self._world = controller, world
        self._data = world.robot.model.createData()
        self.source: StateSource = SimulatedState(world)
        if estimator is not None:
            others = [c.name for c in controller.stack.contacts if c.point not in world.robot.feet or not c.is_footing]
            if others:
                raise InputError(f"a state cannot be estimated with contacts other than of soles: {', '.join(others)}")
            self.source = EstimatedState(world, estimator, self._footings)
            self._footholds = {foot: motion.pose(foot) for foot in world.robot.feet}
        self._unsolved: list[tuple[float, Level]] = []

    @property
    def contacts(self) -> Sequence[Contact]:
        return self._controller.stack.contacts

    def empty_log(self, ticks: int) -> RunLog:
        controller, robot = self._controller, self._world.robot
        controller.stack.settle()
        entries = [(level, task) for level, tasks in controller.stack.levels for task in tasks]
        if controller.schedule is not None:
            entries += controller.schedule.tasks
        self._columns = {task.name: k for k, (_, task) in enumerate(entries)}
        contacts = controller.stack.contacts
        log = RunLog.allocate(
            self._world.system,
            ticks,
            [f"{level}: {task.name}" for level, task in entries],
            [task.error_unit for _, task in entries],
            [] if all(contact.name in robot.feet for contact in contacts) else [contact.name for contact in contacts],
            self._world.hardware,
            isinstance(self.source, EstimatedState),
        )
        self._sense(log)
        return log

    def __call__(self, k: int, t: float, q: Array, v: Array, log: RunLog) -> Array:
        system = self._controller.system
        sensed = self.source(k, t, q[: system.nq], v[: system.nv], log)
        loads = dict(self.source.loads())
        if log.contact_names:
            loads |= {name: self._touches[name].normal if name in self._touches else 0.0 for name in log.contact_names}
        begin = perf_counter()
        self._command, self._q = self._controller(t, *sensed, loads), q[: system.nq]
        log.tick_us[k] = 1e6 * (perf_counter() - begin)
        return self._command.torque

    def _footings(self, t: float) -> dict[str, Footing]:
        """The feet that are to carry now, and what is under them."""
        played = t if self.schedule is None else self.schedule.motion_time(t)
        standing = (
            c for c in self._controller.stack.contacts if c.mode == "fixed" and c.load > 0.0 and not c.is_rolling
        )
        return {c.point: Footing(c.on.placement, _placed(self._footholds[c.point](played))) for c in standing}

    def _sense(self, log: RunLog) -> None:
        """Measure the touches for the next tick; feet have sensors of their own."""
        self._touches: dict[str, Touch] = self._world.contact_touches(self.contacts) if log.contact_names else {}

    def write(self, k: int, t: float, log: RunLog) -> None:
        self._sense(log)
        command, robot, stack = self._command, self._world.robot, self._controller.stack
        log.torque[k], log.acceleration[k] = command.torque[: robot.na], command.acceleration[: robot.nv]
        log.zmp_control[k], log.com[k] = command.zmp, self._simulated_com()
        for contact in stack.contacts:
            if contact.point in robot.feet and contact.is_footing:
                i = robot.feet.index(contact.point)
                log.foot_mode[k, i] = FOOT_ROLLING if contact.is_rolling else _MODES[contact.mode]
                log.foot_ramp[k, i] = contact.load
        self._write_solution(k, t, log, command)
        if log.contact_names:
            self._write_contacts(k, log)
        if command.unsolved is not None:
            self._unsolved.append((t, command.unsolved))

    def _simulated_com(self) -> Array:
        """Of the simulated robot; the controller has it if that is the robot that it knows of."""
        if isinstance(self.source, SimulatedState):
            return self._controller.tick.com
        return np.asarray(pin.centerOfMass(self._world.robot.model, self._data, self._q))

    def _write_solution(self, k: int, t: float, log: RunLog, command: Command) -> None:
        solution, stack = command.solution, self._controller.stack
        log.status[k], log.hard_status[k] = command.status, solution.levels[0].status
        log.residual[k] = max(level.residual for level in solution.levels)
        if command.invalid:
            log.invalid.append((t, command.invalid))
        if command.status in (Status.SECOND_SOLVER, Status.FAILED):
            log.fallbacks.append(_describe_fallback(t, solution))
        shares = stack.transition_shares
        for place, ((_, tasks), level) in enumerate(zip(stack.levels, solution.levels[1:], strict=True), 1):
            slack = level.error
            active = np.count_nonzero(level.active) if len(level.level.lower) else 0
            for task in tasks:
                column = self._columns.get(task.name)
                if column is not None:
                    log.level_error[k, column] = sqrt(task.error @ task.error)
                    log.level_slack[k, column], log.level_active[k, column] = slack, active
                    log.level_place[k, column], log.level_share[k, column] = place, shares.get(task.name, 1.0)
        log.model_us[k], log.assemble_us[k] = command.model_us, command.assemble_us
        log.solve_us[k] = command.solve_us

    def _write_contacts(self, k: int, log: RunLog) -> None:
        log.contact_force[k], log.contact_normal[k] = 0.0, 0.0
        tick = self._controller.tick
        for contact, wrench in zip(self._controller.stack.contacts, self._command.wrenches, strict=True):
            if contact.name in log.contact_names:
                i = log.contact_names.index(contact.name)
                log.contact_commanded[k, i] = -wrench[:3] @ tick.surface_axes(contact.surface).rotation[:, 2]
                log.contact_mode[k, i], log.contact_ramp[k, i] = _MODES[contact.mode], contact.load
                if contact.name in self._touches:
                    log.contact_force[k, i] = self._touches[contact.name].force
                    log.contact_normal[k, i] = self._touches[contact.name].normal

    def end(self, log: RunLog) -> None:
        explained = ((t, find_conflict([level])) for t, level in self._unsolved)
        log.conflicts = [(t, str(conflict)) for t, conflict in explained if conflict is not None]


class TargetDriver:
    """Runs a position controller: joint targets out. Feet stand, slide and swing as it has them, or else its motion.

    Args:
        controller: the controller.
        world: whose robot has servos and sensors.
        motion: that it follows.
        estimator: of its state; the controller is told the simulated one unless given.
    """

    schedule: Schedule | None = None
    contacts: Sequence[Contact] = ()

    def __init__(
        self, controller: PositionController, world: World, motion: Motion, estimator: Estimator | None = None
    ) -> None:
        self.period = controller.period
        self._controller, self._world = controller, world
        self._phase = controller.phase if isinstance(controller, HasPhase) else partial(phase_at, motion.phases)
        self._data = world.robot.model.createData()
        self.source: StateSource = SimulatedState(world)
        if estimator is not None:
            self.source = EstimatedState(world, estimator, self._footings)

    def empty_log(self, ticks: int) -> RunLog:
        estimated = isinstance(self.source, EstimatedState)
        return RunLog.allocate(self._world.system, ticks, hardware=self._world.hardware, estimated=estimated)

    def __call__(self, k: int, t: float, q: Array, v: Array, log: RunLog) -> JointTargets:
        robot = self._world.robot
        sensed, readings = self.source(k, t, q[: robot.nq], v[: robot.nv], log), self._world.readings()
        begin = perf_counter()
        self._targets, self._q = self._controller(t, *sensed, readings), q[: robot.nq]
        log.tick_us[k] = 1e6 * (perf_counter() - begin)
        return self._targets

    def write(self, k: int, t: float, log: RunLog) -> None:
        robot = self._world.robot
        log.torque[k], log.target[k] = self._world.applied_torque(), self._targets.position
        log.com[k] = pin.centerOfMass(robot.model, self._data, self._q)
        phase = self._phase(t)
        for i, foot in enumerate(robot.feet):
            log.foot_mode[k, i] = _foot_mode(foot, phase)
            log.foot_ramp[k, i] = float(foot in phase.feet or foot in phase.sliding)

    def _footings(self, t: float) -> dict[str, Footing]:
        """The feet that are to stand flat now, on level ground."""
        phase = self._phase(t)
        standing = ((foot, place) for foot, place in phase.feet.items() if _foot_mode(foot, phase) == FOOT_FIXED)
        return {foot: LEVEL_GROUND._replace(foothold=place) for foot, place in standing}

    def end(self, log: RunLog) -> None:
        pass


def _foot_mode(foot: str, phase: Phase) -> int:
    """How a foot is to touch in a phase: one of the modes of the log."""
    if foot in phase.sliding:
        return FOOT_SLIDING
    if foot not in phase.feet:
        return FOOT_OFF
    return FOOT_ROLLING if foot in phase.rising else FOOT_FIXED


def _placed(pose: Pose) -> pin.SE3:
    return pin.SE3(pose.rotation, pose.position)


def _describe_fallback(t: float, solution: Solution) -> Fallback:
    """The record of a tick whose answer was not the solver's own."""
    worst = max(solution.levels, key=lambda level: level.status)
    served = ""
    if worst.status == Status.FAILED:
        served = "; the last torque was held" if worst is solution.levels[0] else "; the levels above kept theirs"
    return Fallback(t, worst.name, worst.reason + served, worst.residual)
