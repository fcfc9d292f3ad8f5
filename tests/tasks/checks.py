"""What every task on a motion must satisfy, by finite differences and by integration."""

import numpy as np
import pinocchio as pin

from sot.control.task import MotionTask, Task
from sot.control.tick import Tick
from sot.robots.robot import Robot

Array = np.ndarray


def assert_jacobian_and_drift(task: MotionTask, tick: Tick, q: Array, v: Array) -> None:
    """With a reference at rest, x(q) moves as ``J v`` and, without acceleration, accelerates as ``J̇ v``."""
    _, rate, J, drift, _ = (np.array(part) for part in task.observe(tick.update(0.0, q, v)))
    np.testing.assert_allclose(rate, -J @ v, atol=1e-9)
    step, model = 1e-5, tick.robot.model

    def at(time: float) -> tuple[Array, Array]:
        error, rate, *_ = task.observe(tick.update(0.0, pin.integrate(model, q, time * v), v))
        return np.array(error), np.array(rate)

    (after, rate_after), (before, rate_before) = at(step), at(-step)
    np.testing.assert_allclose((after - before) / (2.0 * step), -J @ v, atol=1e-6)
    np.testing.assert_allclose((rate_after - rate_before) / (2.0 * step), -drift, atol=1e-5)


def followed(task: Task, robot: Robot, q: Array, v: Array, duration: float, step: float) -> list[Array]:
    """Errors while the joints and the base do what the task alone asks for, ``v̇ = J⁺ (ẍ* − J̇ v)``."""
    tick, errors = Tick(robot, step), []
    for k in range(round(duration / step)):
        rows = task.rows(tick.update(k * step, q, v))
        errors.append(np.array(task.error))
        acceleration = np.linalg.lstsq(rows.A, rows.lower, rcond=1e-8)[0]
        q = pin.integrate(robot.model, q, step * v + 0.5 * step**2 * acceleration)
        v = v + step * acceleration
    return errors
