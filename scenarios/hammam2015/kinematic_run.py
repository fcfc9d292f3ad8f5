"""A robot that follows key points without dynamics, and what it violates on its way."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np
import pinocchio as pin

from scenarios.hammam2015.key_point_reference import RATE, KeyPointReference
from scenarios.hammam2015.methods import TASK_SETS, Method
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.resolved.pairs import NearestPairs

Array = np.ndarray

RUNAWAY_SPEED = 1000.0
"""Joint speed beyond which a run is given up [rad/s]."""
RANGE_TOLERANCE = 1e-6
"""Excess of a range that is rounding [rad]."""
WATCHED_DISTANCE = 0.05
"""Distance below which pairs are looked at for overlaps [m]."""


@dataclass(frozen=True)
class KinematicRun:
    """A run at RATE, a row a frame; shorter than its reference if it ran away.

    Attributes:
        names: Of the points that it followed.
        times: (T,) [s].
        q, v, a: (T, nq), (T, nv), (T, nv).
        wanted, reached: (T, n, 3) positions of the points [m].
        foot_errors: Largest distance of a foot from its place, (T,) [m].
        beyond: How far each joint is outside its range, (T, na), negative inside [rad].
        overlaps: Number of pairs, of all, that overlap, (T,).
        nearest: Distance of the nearest pair, (T,) [m].
        powers: Power (43), ``|τᵀ q̇|``, (T,) [W].
        frame_us: Time of a frame, model and all [µs], (T,).
        ran_away: Whether it was given up.
    """

    names: tuple[str, ...]
    times: Array
    q: Array
    v: Array
    a: Array
    wanted: Array
    reached: Array
    foot_errors: Array
    beyond: Array
    overlaps: Array
    nearest: Array
    powers: Array
    frame_us: Array
    ran_away: bool

    @property
    def joints_out(self) -> Array:
        """Number of joints outside their ranges, (T,)."""
        count: Array = (self.beyond > RANGE_TOLERANCE).sum(axis=1)
        return count

    @property
    def violations(self) -> Array:
        """Joints outside their ranges and pairs that overlap, (T,)."""
        return self.joints_out + self.overlaps

    @property
    def errors(self) -> Array:
        """Distances of the points from where they were to be, (T, n) [m]."""
        return np.linalg.norm(self.wanted - self.reached, axis=2)


def follow_key_points(robot: Robot, method: Method, reference: KeyPointReference, task_set: int) -> KinematicRun:
    """Follow the key points of a task set from rest, at RATE."""
    names, period = TASK_SETS[task_set], 1.0 / RATE
    law = method.law(robot, names, reference.of(names))
    watch = NearestPairs(robot, len(robot.shapes.collisionPairs), WATCHED_DISTANCE)
    tick, q, v = Tick(robot, period), robot.rest.copy(), np.zeros(robot.nv)
    places = [tick.frame(foot).position.copy() for foot in robot.feet]
    rows: list[tuple[Array | float, ...]] = []
    ran_away = False
    for t in reference.times:
        begun = perf_counter()
        tick.update(float(t), q, v)
        try:
            answer = law(tick)
        except (ArithmeticError, np.linalg.LinAlgError):
            ran_away = True
            break
        took = 1e6 * (perf_counter() - begun)
        a = (answer - v) / period if method.velocities else answer
        feet = max(float(np.linalg.norm(tick.frame(f).position - p)) for f, p in zip(robot.feet, places, strict=True))
        near = watch(tick).values
        reached = np.array([tick.frame(name).position for name in names])
        outside = np.maximum(q[7:] - robot.upper, robot.lower - q[7:])
        nearest = float(near.min(initial=WATCHED_DISTANCE))
        # With standing feet contact forces do no work: this is what the joints do.
        power = abs(float(v @ (tick.M @ a + tick.h)))
        rows.append((q, v, a, reached, feet, outside, int((near < 0.0).sum()), nearest, power, took))
        if method.velocities:
            q, v = pin.integrate(robot.model, q, period * answer), answer
        else:
            q, v = pin.integrate(robot.model, q, period * v + 0.5 * period**2 * a), v + period * a
        if not np.abs(v).max() < RUNAWAY_SPEED:
            ran_away = True
            break
    q_rows, v_rows, a_rows, reached_rows, foot_rows, outside_rows, overlap_rows, nearest_rows, power_rows, time_rows = (
        np.array(column) for column in zip(*rows, strict=True)
    )
    count = len(rows)
    return KinematicRun(
        names=names,
        times=reference.times[:count],
        q=q_rows,
        v=v_rows,
        a=a_rows,
        wanted=np.stack([reference.positions[name][:count] for name in names], axis=1),
        reached=reached_rows,
        foot_errors=foot_rows,
        beyond=outside_rows,
        overlaps=overlap_rows,
        nearest=nearest_rows,
        powers=power_rows,
        frame_us=time_rows,
        ran_away=ran_away,
    )
