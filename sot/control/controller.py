"""State in, torques out: one tick of the stack of tasks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from solvers.rows import Level, Solution, Solver, Status
from sot.control.contact import Contact
from sot.control.dynamics import Dynamics, FormName
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.control.tick import Tick
from sot.robots.robot import Robot

Array = np.ndarray

EXPLANATION_INTERVAL = 1.0
"""Shortest time between two infeasible level-0 problems that are kept for `solvers.conflict.find_conflict` [s]."""
HOLD_DAMPING = 5.0
"""Joint damping [N m s/rad] that is added when the last torque is held because no new one was found."""


@dataclass(slots=True)
class Command:
    """What a tick commands, and what it knows about it.

    Args:
        torque: τ, shape (na,), within the robot's limits [N m].
        acceleration: v̇ that the controller expects, shape (nv,).
        wrenches: Floor on each contact of the stack, at its point, world axes, shape (contacts, 6) [N, N m].
        zmp: Predicted zero-moment point, Ramos (11), shape (2,) [m]; nan without load.
        solution: The solver's answer, level by level.
        status: The solution's. If its level 0 has none (`Status.FAILED` there), the torque is a damped hold of the last
            that was solved for.
        model_us, assemble_us, solve_us: Where the time went [µs].
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
    unsolved: Level | None = None


class Controller:
    """Runs a stack on a robot.

    Args:
        robot: The robot.
        stack: What it is asked for; may be changed between ticks.
        solver: `Cascade`, `Weighted`, ...
        period: Control period [s].
        schedule: Changes of the stack over time.
        form: "condensed" (the one that runs) or "full" (the paper's variables; equal, slower).
    """

    def __init__(
        self,
        robot: Robot,
        stack: Stack,
        solver: Solver,
        period: float = 0.001,
        schedule: Schedule | None = None,
        form: FormName = "condensed",
    ) -> None:
        self.robot, self.stack, self.solver, self.schedule = robot, stack, solver, schedule
        self.dynamics = Dynamics(robot, form)
        self.tick = Tick(robot, period)
        self._last_torque, self._min_torque = np.zeros(robot.na), -robot.effort
        self._last_explained = -np.inf
        self._contacts_off: list[Contact] = []  # contacts that were, a tick ago

    def __call__(self, t: float, q: Array, v: Array, loads: Mapping[str, float] | None = None) -> Command:
        """One tick: the state at time `t` [s], Pinocchio's conventions, to torques.

        `loads` are the measured normal forces on the feet [N]; a schedule may use them.
        """
        start = perf_counter()
        stack, robot = self.stack, self.robot
        if self.schedule is not None:
            self.schedule.apply(t, stack, loads)
        self._note_arrivals(stack.contacts)
        self.tick.contacts = stack.contacts
        self.tick.update(t, q, v)
        if self.schedule is not None:
            self.schedule.observe(self.tick)
        modelled = perf_counter()
        levels = self.dynamics.assemble(self.tick, stack.contacts, stack.hard, stack.levels)
        assembled = perf_counter()
        solution = self.solver.solve(levels)
        usable = solution.levels[0].status != Status.FAILED
        if usable:
            decoded = self.dynamics.decode(solution.x)
            # Only rounding is left to clip: the bounds are rows of level 0.
            torque = np.minimum(np.maximum(decoded.torque, self._min_torque), robot.effort)
            acceleration, wrenches, zmp = decoded.acceleration, decoded.wrenches, decoded.zmp
            self._last_torque, self.tick.acceleration = torque, acceleration
        else:
            # Always from the last torque that was solved for: damping added to damping would become a stiffness.
            torque = np.clip(self._last_torque - HOLD_DAMPING * v[6:], -robot.effort, robot.effort)
            acceleration, wrenches = np.zeros(robot.nv), np.full((len(stack.contacts), 6), np.nan)
            zmp = np.full(2, np.nan)
        solved = perf_counter()
        unsolved = None
        if solution.levels[0].status >= Status.RELAXED and t >= self._last_explained + EXPLANATION_INTERVAL:
            self._last_explained, unsolved = t, levels[0].copy()
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
            unsolved,
        )

    def _note_arrivals(self, contacts: Sequence[Contact]) -> None:
        """Give contacts that have just been made the acceleration with which their points arrive."""
        for contact in self._contacts_off:
            if contact.mode != "off":
                frame = self.tick.frame(contact.point)  # of the last tick still
                contact.arrival_acceleration = frame.jacobian @ self.tick.acceleration + frame.drift
        self._contacts_off = [contact for contact in contacts if contact.mode == "off"]
