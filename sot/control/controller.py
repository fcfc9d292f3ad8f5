"""State in, torques out: one tick of the stack of tasks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from solvers.compiled import compiled
from solvers.rows import Level, LevelResult, Solution, Solver, Status
from sot.control.contact import Contact
from sot.control.dynamics import Decoded, Dynamics, FormName
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.errors import InvalidRowsError
from sot.robots.robot import Robot
from sot.robots.system import System

Array = np.ndarray

EXPLANATION_INTERVAL = 1.0
"""Shortest time between two infeasible level-0 problems that are kept for `solvers.conflict.find_conflict` [s]."""
HOLD_DAMPING = 5.0
"""Joint damping [N m s/rad] that is added when the last torque is held because no new one was found."""


@dataclass(slots=True)
class Command:
    """What a tick commands, and what it knows about it.

    Args:
        torque: τ, shape (na,), within the limits, the robot's first [N m].
        acceleration: v̇ that the controller expects, shape (nv,).
        wrenches: On the first surface of each contact of the stack, at its origin, world axes, shape (contacts, 6)
            [N, N m].
        zmp: Predicted zero-moment point, Ramos (11), shape (2,) [m]; nan without load.
        solution: The solver's answer, level by level.
        status: The solution's. If level 0 has none (`Status.FAILED` or `INVALID` there), the torque is a damped hold of
            the last one that was solved for.
        model_us, assemble_us, solve_us: Where the time went [µs].
        invalid: If a state, a task or the solver gave values that cannot be used (not finite, of a wrong shape), which
            and why; the torque is then the damped hold, and the status `Status.INVALID`. Empty otherwise.
        unsolved: If level 0 had no solution, a copy of it, now and then: `solvers.conflict.find_conflict` says which of
            its rows contradict each other, but takes as long as hundreds of ticks.
    """

    torque: Array
    acceleration: Array
    wrenches: Array
    zmp: Array
    solution: Solution
    status: Status
    model_us: float
    assemble_us: float
    solve_us: float
    invalid: str = ""
    unsolved: Level | None = None


class Controller:
    """Runs a stack on a robot.

    Args:
        robot: The robot, or the system of it and of the things that it handles.
        stack: What it is asked for; may be changed between ticks.
        solver: `Cascade`, `Weighted`, ...
        period: Control period [s].
        schedule: Changes of the stack over time.
        form: "condensed" (the one that runs) or "full" (the paper's variables; equal, slower).
    """

    def __init__(
        self,
        robot: Robot | System,
        stack: Stack,
        solver: Solver,
        period: float = 0.001,
        schedule: Schedule | None = None,
        form: FormName = "condensed",
    ) -> None:
        self.system, self.stack, self.solver, self.schedule = System.of(robot), stack, solver, schedule
        self.dynamics = Dynamics(self.system, form)
        self.tick = Tick(self.system, period)
        self._last_torque = np.zeros(self.system.na)
        self._last_explained = -np.inf
        self._contacts_off: list[Contact] = []  # contacts that were, a tick ago
        self._started = False
        stack.settle()

    def __call__(self, t: float, q: Array, v: Array, loads: Mapping[str, float] | None = None) -> Command:
        """One tick: the state at time `t` [s], Pinocchio's conventions, to torques.

        `loads` are the measured normal forces of the contacts, by their names [N]; a schedule may use them.

        Raises:
            InputError: In the first tick, if a task's rows cannot be used; later on the last torque is held. Also
                whatever a task of one's own raises.
        """
        start = perf_counter()
        stack, tick = self.stack, self.tick
        if self.schedule is not None:
            self.schedule.apply(t, stack, loads)
        else:
            stack.advance(t)
        self._note_arrivals(stack.contacts)
        tick.contacts, tick.loads, tick.carried = stack.contacts, stack.loads, tuple(stack.carried)
        tick.update(t, q, v)
        modelled = assembled = perf_counter()
        invalid, unsolved = "", None
        if not tick.finite:
            invalid = "the state holds a value that is not finite"
        else:
            if self.schedule is not None:
                self.schedule.observe(tick)
            modelled = perf_counter()
            try:
                levels = self.dynamics.assemble(tick, stack.contacts, stack.hard, stack.levels)
                assembled = perf_counter()
                solution, decoded = self._solve(levels)
            except InvalidRowsError as error:
                if not self._started:
                    raise
                invalid = str(error)
        self._started = True
        if invalid:
            solution, decoded = _no_solution(stack, invalid), None
        elif solution.levels[0].status >= Status.RELAXED and t >= self._last_explained + EXPLANATION_INTERVAL:
            self._last_explained, unsolved = t, levels[0].copy()
        if decoded is not None:
            torque, acceleration, wrenches, zmp = decoded.torque, decoded.acceleration, decoded.wrenches, decoded.zmp
            self._last_torque, tick.acceleration = torque, acceleration
        else:
            torque, acceleration = self._held_torque(v), np.zeros(self.system.nv)
            wrenches, zmp = np.full((len(stack.contacts), 6), np.nan), np.full(2, np.nan)
        tick.torque = torque
        solved = perf_counter()
        return Command(
            torque,
            acceleration,
            wrenches,
            zmp,
            solution,
            solution.status,
            1e6 * (modelled - start),
            1e6 * (assembled - modelled),
            1e6 * (solved - assembled),
            invalid,
            unsolved,
        )

    def _solve(self, levels: list[Level]) -> tuple[Solution, Decoded | None]:
        """Solution of the levels, and what it means within the torque limits; None of that if level 0 has none.

        Raises:
            InvalidRowsError: If the solver raises, or its solution is not finite.
        """
        try:
            solution = self.solver.solve(levels)
        except (ArithmeticError, ValueError) as error:
            raise InvalidRowsError(f"solver '{self.solver.name}': {type(error).__name__}: {error}") from error
        if solution.levels[0].status == Status.FAILED:
            return solution, None
        decoded = self.dynamics.decode(solution.x)
        # Only rounding is left to clip: the bounds are rows of level 0.
        decoded.torque, finite = _within(decoded.torque, self.system.effort, solution.x)
        if not finite:
            raise InvalidRowsError(f"solver '{self.solver.name}': its answer is not finite")
        return solution, decoded

    def _held_torque(self, v: Array) -> Array:
        """The last torque that was solved for, damped where the joint velocities are finite.

        Never a held one: damping added to damping would become a stiffness.
        """
        speeds = v[self.system.driven]
        damping = np.where(np.isfinite(speeds), HOLD_DAMPING * speeds, 0.0)
        held: Array = np.clip(self._last_torque - damping, -self.system.effort, self.system.effort)
        return held

    def _note_arrivals(self, contacts: Sequence[Contact]) -> None:
        """Give contacts that have just been made the acceleration with which their points arrive."""
        for contact in self._contacts_off:
            if contact.mode != "off" and self.tick.finite:
                frame = contact.motion(self.tick)  # of the last tick still
                contact.arrival_acceleration = frame.jacobian @ self.tick.acceleration + frame.drift
        self._contacts_off = [contact for contact in contacts if contact.mode == "off"]


def compile_ticks(controller: Controller, t: float, q: Array) -> None:
    """Compile what ticks need, from a time on [s], by running some: at rest, and with all joints at their speed limits,
    so that limbs approach each other and joints the ends of their ranges."""
    robot = controller.system.robot
    for k, share in enumerate((0.0, 1.0, -1.0)):
        v = np.zeros(controller.system.nv)
        v[6 : robot.nv] = share * robot.velocity
        controller(t + k * controller.tick.period, q, v)


def _no_solution(stack: Stack, reason: str) -> Solution:
    """Solution of a tick without levels to solve."""
    nothing = np.zeros(0)
    names = ["hard", *[name for name, _ in stack.levels]]
    levels = [Level(name, 0, [], np.zeros((0, 0)), nothing, nothing) for name in names]
    results = [LevelResult(level, nothing, False, 0.0, Status.INVALID, reason=reason) for level in levels]
    return Solution(nothing, results, Status.INVALID)


@compiled
def _within(torque: Array, effort: Array, x: Array) -> tuple[Array, bool]:
    """Torques within the effort limits, and whether they and a solution are finite."""
    total = 0.0  # nan as soon as a value is not finite
    out = np.empty(len(torque))
    for k in range(len(torque)):
        total += 0.0 * torque[k]
        out[k] = min(max(torque[k], -effort[k]), effort[k])
    for k in range(len(x)):
        total += 0.0 * x[k]
    return out, total == 0.0
