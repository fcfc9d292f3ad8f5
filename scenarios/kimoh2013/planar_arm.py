"""The planar arm of Kim & Oh, section 3.3: three links of one metre, three tasks, limits on every joint."""

from dataclasses import dataclass

import numpy as np

Array = np.ndarray

DEGREE = np.pi / 180.0
LOWER = DEGREE * np.array([60.0, -120.0, -120.0])
UPPER = DEGREE * np.array([180.0, 120.0, 120.0])
VELOCITY = np.full(3, 180.0 * DEGREE)
ACCELERATION = np.full(3, 1800.0 * DEGREE)
START_ANGLES = DEGREE * np.array([90.0, -90.0, 90.0])
DURATION = 1.0
TASK_NAMES = ("P_y", "P_x", "θ_3")
"""Most important first: height of the tip [m], its way forward [m], direction of the last link [rad]."""
KP = 100.0
"""Stiffness of the tasks, critically damped [1/s²]; the paper names no gains."""


@dataclass(frozen=True, slots=True)
class TaskState:
    """Values, Jacobian and drift of the three tasks at a state.

    Args:
        value: Their values, in the order of `TASK_NAMES`, shape (3,).
        jacobian: Shape (3, 3).
        drift: J̇ q̇, shape (3,).
    """

    value: Array
    jacobian: Array
    drift: Array


@dataclass(frozen=True)
class ArmRun:
    """Run of the arm under one method, one row a tick.

    Attributes:
        time: Start of the tick [s], (T,).
        q, v, a: Joint angles, speeds and accelerations, (T, 3).
        error: Wanted minus reached, in the order of `planar_arm.TASKS`, (T, 3) [m, m, rad].
        qps: Quadratic programs, (T,).
        solve_us: Time of the solver [µs], (T,).
        max_beyond_range: Most beyond a position limit, between ticks too [rad].
    """

    time: Array
    q: Array
    v: Array
    a: Array
    error: Array
    qps: Array
    solve_us: Array
    max_beyond_range: float

    @property
    def task_given_up(self) -> Array:
        """Whether some task was given up for a bound at each tick, (T,)."""
        return np.abs(self.error).max(axis=1) > 1e-3


def task_state(q: Array, v: Array) -> TaskState:
    """The tasks at joint angles q that move with v, shapes (3,) [rad, rad/s]."""
    angle, rate = np.cumsum(q), np.cumsum(v)
    c, s = np.cos(angle), np.sin(angle)
    # A joint moves all links from its own on.
    along, across = np.cumsum(c[::-1])[::-1], np.cumsum(s[::-1])[::-1]
    value = np.array([s.sum(), c.sum(), angle[-1]])
    jacobian = np.array([along, -across, np.ones(3)])
    return TaskState(value, jacobian, np.array([-(s @ rate**2), -(c @ rate**2), 0.0]))


def link_ends(q: Array) -> Array:
    """Ends of the links for each of T postures q, shape (T, 4, 2) [m]."""
    angle = np.cumsum(q, axis=1)
    ends = np.cumsum(np.stack([np.cos(angle), np.sin(angle)], axis=-1), axis=1)
    return np.concatenate([np.zeros((len(q), 1, 2)), ends], axis=1)


def desired_tasks(t: float) -> tuple[Array, Array, Array]:
    """Values of the tasks at a time [s], their rates and accelerations: the tip goes 1 m forward on half a cosine."""
    w = np.pi / DURATION
    value = np.array([2.0, 1.5 - 0.5 * np.cos(w * t), 0.5 * np.pi])
    rate, acceleration = 0.5 * w * np.sin(w * t), 0.5 * w**2 * np.cos(w * t)
    return value, np.array([0.0, rate, 0.0]), np.array([0.0, acceleration, 0.0])


def task_rows(t: float, q: Array, v: Array) -> tuple[Array, Array]:
    """Rows ``J q̈ = h`` of the three tasks, Kim (3) and (11): J, shape (3, 3), and h, shape (3,)."""
    seen = task_state(q, v)
    value, rate, acceleration = desired_tasks(t)
    error, slip = value - seen.value, rate - seen.jacobian @ v
    return seen.jacobian, acceleration + 2.0 * np.sqrt(KP) * slip + KP * error - seen.drift
