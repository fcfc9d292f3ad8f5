"""Closed-loop inverse kinematics, Dariush (9), (10): a robot that follows key points by velocities."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from scenarios.hammam2015.key_point_reference import RATE, KeyPointReference
from scenarios.hammam2015.methods import standing_feet
from solvers import ResolvedAcceleration
from sot.control.tick import Tick
from sot.robots.robot import Robot
from tasks.resolved.control import ConstrainedResolvedAcceleration
from tasks.resolved.pairs import PAPER_PAIR_COUNT, NearestPairs
from tasks.resolved.points import ResolvedPoints
from tasks.resolved.redirection import CRITICAL_DISTANCE, Redirection, kept_apart, upper_body_velocities
from tasks.resolved.weighting import DynamicOnly, Weighting, unit_weight

Array = np.ndarray
Names = tuple[str, ...]
Confidence = Callable[[str], float]
Law = Callable[[Tick], Array]

GAIN = 50.0
"""K of (9) [1/s], the paper's lower one."""
DAMPING = 0.1
"""λ of (10); the paper names none."""
APART_DAMPING = 0.01
"""λ of the inverse that keeps shapes apart."""


@dataclass(frozen=True)
class VelocityRun:
    """A run at RATE.

    Attributes:
        times: (T,) [s].
        q: (T, nq).
        errors: Distances of each point from its reference, name -> (T,) [m].
    """

    times: Array
    q: Array
    errors: dict[str, Array]

    def rms(self, *names: str) -> float:
        """Root mean square over all frames of some points [m]."""
        return float(np.sqrt(np.mean([np.square(self.errors[name]) for name in names])))


def follow_by_velocities(
    robot: Robot,
    reference: KeyPointReference,
    levels: Sequence[Names],
    gains: Callable[[str], float] = lambda name: GAIN,
    weighting: Weighting | None = None,
    exact_projectors: bool = True,
    redirection: Redirection | None = None,
    keep_apart: bool = False,
    confidence: Confidence | None = None,
    point_weights: Confidence | None = None,
    judged_by: KeyPointReference | None = None,
) -> VelocityRun:
    """Follow key points from rest, the feet above them.

    Args:
        robot: The robot.
        reference: Of the key points.
        levels: Names of the points of each priority, Algorithm 1; one level is task augmentation.
        gains: K of each point [1/s].
        weighting: What makes W; the identity unless given.
        exact_projectors: Whether null spaces are exact, or of the damped inverses.
        redirection: Of points of collision.
        keep_apart: Whether shapes are kept apart by `kept_apart`.
        confidence: In each point, as a gain.
        point_weights: Of each point.
        judged_by: Reference that errors are of, if not the one that is followed.
    """
    period = 1.0 / RATE
    points = [
        ResolvedPoints(
            robot,
            names,
            reference.of(names),
            velocity_kp=np.array([gains(name) for name in names]),
            velocity_gain=np.inf,
            confidence=_of_points(confidence, names),
            point_weights=_of_points(point_weights, names),
        )
        for names in levels
    ]
    feet = ResolvedPoints(robot, robot.feet, standing_feet(robot), velocity_kp=GAIN, velocity_gain=np.inf)
    solver = ResolvedAcceleration((DAMPING,), exact_projectors)
    pairs = NearestPairs(robot, 0, 0.0)  # (14) knows none
    law = ConstrainedResolvedAcceleration([feet, *points], pairs, weighting or DynamicOnly(unit_weight), solver)
    follower: Law = law
    if redirection is not None:
        follower = _Redirected(law, points[0], redirection)
    elif keep_apart:
        near, moving = NearestPairs(robot, PAPER_PAIR_COUNT, 2.0 * CRITICAL_DISTANCE), upper_body_velocities(robot)
        follower = lambda tick: kept_apart(near(tick), law(tick), moving, APART_DAMPING)  # noqa: E731
    tick, q, v = Tick(robot, period), robot.rest.copy(), np.zeros(robot.nv)
    truth = judged_by or reference
    names = tuple(name for level in levels for name in level)
    way, reached = [], []
    for t in reference.times:
        tick.update(float(t), q, v)
        way.append(q)
        reached.append([tick.frame(name).position.copy() for name in names])
        v = follower(tick)
        q = pin.integrate(robot.model, q, period * v)
    away = np.array(reached) - truth.of(names).positions
    return VelocityRun(
        reference.times, np.array(way), {name: np.linalg.norm(away[:, k], axis=1) for k, name in enumerate(names)}
    )


def _of_points(values: Confidence | None, names: Names) -> Array | None:
    return None if values is None else np.array([values(name) for name in names])


class _Redirected:
    """Dariush (19)-(22) around a law: the tasks' reference is redirected and integrated, and followed by (21)."""

    def __init__(self, law: ConstrainedResolvedAcceleration, points: ResolvedPoints, redirection: Redirection) -> None:
        self._law, self._points, self._redirection = law, points, redirection
        self._human, self._gains = points.reference, points.velocity_kp
        self._positions: Array | None = None

    def __call__(self, tick: Tick) -> Array:
        points, human = self._points, self._human(tick.t)
        points.reference, points.velocity_kp = self._human, self._gains
        velocities = self._law(tick)
        redirected, share, least = self._redirection.blended(tick, velocities)
        jacobian = points.observe(tick)[2]
        task = (1.0 - share) * human.velocities + share * (jacobian @ redirected).reshape(-1, 3)  # (22)
        self._positions = human.positions if self._positions is None else self._positions + tick.period * task
        sample = human._replace(positions=self._positions, velocities=task)
        points.reference = lambda t: sample
        points.velocity_kp = self._gains * float(np.clip(least / CRITICAL_DISTANCE, 0.0, 1.0))  # K'
        return self._law(tick)
