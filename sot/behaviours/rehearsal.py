"""What a stack makes of a motion, and the balance planned anew for that.

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
from sot.motion.balance.balance import plan_balance
from sot.motion.balance.centroidal import Centroidal
from sot.motion.feet.support import supports
from sot.motion.trajectory import Motion

Array = NDArray[np.float64]

KNOT_RATE, TICKS = 50.0, 5
"""Knots of a balance plan a second, and ticks that are rehearsed from one to the next."""
RUNAWAY = 1e3
"""Speed [rad/s, m/s] that says that a stack is no good."""


def rehearsed(motion: Motion, stack: Stack, solver: Solver, schedule: Schedule | None = None) -> Centroidal:
    """Centre of mass and momentum of what a stack makes of a motion, at `KNOT_RATE`, (T,) from its start to its end.

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
    robot, period = motion.robot, 1.0 / (KNOT_RATE * TICKS)
    for contact in stack.contacts:
        contact.unlimited_force = True
    controller = Controller(robot, stack, solver, period, schedule)
    knots = round(motion.duration * KNOT_RATE) + 1
    states: list[tuple[Array, Array, Array]] = []
    q, v = motion.q[0], motion.v[0]
    for k in range((knots - 1) * TICKS + 1):
        acceleration = controller(k * period, q, v).acceleration
        states.append((q, v, acceleration))
        v = v + period * acceleration
        if not np.abs(v).max() < RUNAWAY:
            raise InputError(f"the stack drives the robot beyond all bounds, {k * period:.1f} s after the start")
        q = pin.integrate(robot.model, q, period * v)
    every = Centroidal.along(robot, *(np.array(column) for column in zip(*states, strict=True)))
    # A knot stands for the ticks about it.
    ends = np.clip(TICKS * (np.arange(knots + 1) - 0.5), 0, len(states)).astype(int)
    rate = np.array([every.rate[start:end].mean(axis=0) for start, end in pairwise(ends)])
    return Centroidal(every.com[::TICKS], every.momentum[::TICKS], rate, robot.mass)


def rebalanced(motion: Motion, made: Centroidal) -> Motion:
    """The same motion with the centre of mass and zero-moment point that suit what a stack makes of it.

    Args:
        motion: Its joints are left as they are.
        made: Of it, as `rehearsed`: height, and angular momentum.
    """
    period, times = 1.0 / KNOT_RATE, motion.times
    knots = period * np.arange(len(made.com))
    rows = np.round(knots * motion.rate).astype(int).clip(max=len(times) - 1)
    plan = plan_balance(made, motion.com[rows, :2], supports(motion.robot, motion.phases), period)

    def over_time(values: Array) -> Array:
        return np.column_stack([np.interp(times, knots, column) for column in values.T])

    heights = over_time(np.column_stack([part[:, 2] for part in (made.com, made.velocity, made.acceleration)]))
    com, velocity, acceleration = (
        np.column_stack([plan.com(times, derivative), heights[:, derivative]]) for derivative in range(3)
    )
    return replace(motion, com=com, com_velocity=velocity, com_acceleration=acceleration, zmp=over_time(plan.zmp))
