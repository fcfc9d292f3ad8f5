"""States of a robot to try things on, and derivatives by differences along its motion."""

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from sot.control.tick import Tick
from sot.robots.robot import Robot

Array = np.ndarray


def random_state(
    robot: Robot, rng: np.random.Generator, spread: float = 1.0, speed: float = 1.0
) -> tuple[Array, Array]:
    """A base anywhere and joints inside their range, both around the rest posture; all of it moving."""
    base = np.concatenate([rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3)])
    joints = rng.uniform(-0.6, 0.6, robot.na)
    q = pin.integrate(robot.model, robot.rest, spread * np.concatenate([base, joints]))
    q[7:] = np.clip(q[7:], robot.lower, robot.upper)
    return q, speed * rng.uniform(-1, 1, robot.nv)


def standing_state(robot: Robot, rng: np.random.Generator, speed: float = 0.3) -> tuple[Array, Array]:
    """Near rest with both soles where they are at rest: joints of the upper body anywhere near, velocities small."""
    q = robot.rest.copy()
    upper = np.array([k for k in range(robot.na) if k not in robot.groups["legs"]])
    q[7 + upper] += rng.uniform(-0.2, 0.2, len(upper))
    q[7:] = np.clip(q[7:], robot.lower + 0.01, robot.upper - 0.01)
    return q, speed * rng.uniform(-1, 1, robot.nv)


def rate(tick: Tick, q: Array, v: Array, quantity: Callable[[Tick], Array], step: float = 1e-5) -> Array:
    """Derivative of a quantity along the motion through (q, v) that does not accelerate, by central differences."""
    model = tick.robot.model
    after = np.array(quantity(tick.update(0.0, pin.integrate(model, q, step * v), v)))
    before = np.array(quantity(tick.update(0.0, pin.integrate(model, q, -step * v), v)))
    return (after - before) / (2.0 * step)


def turned(tick: Tick, point: str, q: Array, v: Array, step: float = 1e-5) -> Array:
    """Angular velocity of a point in world axes, by central differences of its rotation."""
    model = tick.robot.model
    after = tick.update(0.0, pin.integrate(model, q, step * v), v).frame(point).rotation.copy()
    before = tick.update(0.0, pin.integrate(model, q, -step * v), v).frame(point).rotation.copy()
    return pin.log3(after @ before.T) / (2.0 * step)
