"""A rehearsal of a motion with its stack, and the balance planned anew for the momentum that it shows.

A plan's balance counts on the angular momentum of the planned motion. A stack whose posture lags behind, or that
changes the dance, has another one: where the difference is more than the soles can take, the posture has to give way.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from solvers.rows import Solver
from sot.control.controller import Controller
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.errors import InputError
from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.programme import plan_balance
from sot.motion.feet.support import supports
from sot.motion.trajectory import Motion

Array = NDArray[np.float64]

KNOT_RATE, TICKS_PER_KNOT = 50.0, 5
"""Knots of a balance plan a second, and ticks that are rehearsed from one to the next."""
RUNAWAY_SPEED = 1e3
"""Speed beyond which a rehearsal counts as diverged [rad/s, m/s]."""


def rehearse(motion: Motion, stack: Stack, solver: Solver, schedule: Schedule | None = None) -> Centroidal:
    """Centre of mass and momentum of a motion as its stack carries it out, at `KNOT_RATE`, (T,) from start to end.

    The robot does what its controller commands, on feet that the floor holds whatever that takes: so the motion comes
    out as it is asked for, and with it what it would need.

    Args:
        motion: The reference.
        stack: Made for this alone; its contacts are made to stick.
        solver: Of the controller.
        schedule: Changes of the stack, made for this alone too.

    Raises:
        InputError: The stack drives the robot beyond all bounds.
    """
    robot, period = motion.robot, 1.0 / (KNOT_RATE * TICKS_PER_KNOT)
    for contact in stack.contacts:
        contact.unlimited_force = True
    controller = Controller(robot, stack, solver, period, schedule)
    knots = round(motion.duration * KNOT_RATE) + 1
    states: list[tuple[Array, Array, Array]] = []
    q, v = motion.q[0], motion.v[0]
    for k in range((knots - 1) * TICKS_PER_KNOT + 1):
        acceleration = controller(k * period, q, v).acceleration
        states.append((q, v, acceleration))
        v = v + period * acceleration
        if not np.abs(v).max() < RUNAWAY_SPEED:
            raise InputError(f"the stack drives the robot beyond all bounds, {k * period:.1f} s after the start")
        q = pin.integrate(robot.model, q, period * v)
    every = Centroidal.along(robot, *(np.array(column) for column in zip(*states, strict=True)))
    # A knot stands for the ticks about it.
    ends = np.clip(TICKS_PER_KNOT * (np.arange(knots + 1) - 0.5), 0, len(states)).astype(int)
    rate = np.array([every.rate[start:end].mean(axis=0) for start, end in pairwise(ends)])
    return Centroidal(every.com[::TICKS_PER_KNOT], every.momentum[::TICKS_PER_KNOT], rate, robot.mass)


def rebalance(motion: Motion, rehearsal: Centroidal) -> Motion:
    """The same motion with a centre of mass and zero-moment point planned for its rehearsal.

    Args:
        motion: Its joints are left as they are.
        rehearsal: Of the motion, see `rehearse`; gives height and angular momentum.
    """
    period, times = 1.0 / KNOT_RATE, motion.times
    knots = period * np.arange(len(rehearsal.com))
    rows = np.round(knots * motion.rate).astype(int).clip(max=len(times) - 1)
    plan = plan_balance(rehearsal, motion.com[rows, :2], supports(motion.robot, motion.phases), period)

    def over_time(values: Array) -> Array:
        return np.column_stack([np.interp(times, knots, column) for column in values.T])

    heights = over_time(
        np.column_stack([part[:, 2] for part in (rehearsal.com, rehearsal.velocity, rehearsal.acceleration)])
    )
    com, velocity, acceleration = (
        np.column_stack([plan.com(times, derivative), heights[:, derivative]]) for derivative in range(3)
    )
    return replace(motion, com=com, com_velocity=velocity, com_acceleration=acceleration, zmp=over_time(plan.zmp))
