"""The methods that are compared: what each makes of a state, from the same references."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from scenarios.hammam2015.key_point_reference import SampledPoints
from solvers import Cascade, Level, ResolvedAcceleration
from solvers.rows import Status
from sot.control.task import Task
from sot.control.tick import Tick
from sot.motion.human.key_points import KEY_POINTS
from sot.robots.robot import Robot
from tasks import JointBounds, Posture, SelfCollision
from tasks.resolved.control import ConstrainedResolvedAcceleration, towards_rest
from tasks.resolved.pairs import PAPER_PAIR_COUNT, NearestPairs
from tasks.resolved.points import PointsSample, ResolvedPoints
from tasks.resolved.weighting import (
    DynamicOnly,
    DynamicWeight,
    MendedWeighting,
    PrintedWeighting,
    Weighting,
    inertia_weight,
    unit_weight,
)

Array = np.ndarray
Law = Callable[[Tick], Array]
"""A state to accelerations, or to velocities."""

TASK_SETS = {
    1: KEY_POINTS,
    2: ("waist", "left_wrist", "right_wrist"),
    3: ("waist", "right_wrist"),
}
"""Section 5: over-constrained; some redundancy; one arm."""
KP, VELOCITY_GAIN, PRINTED_DAMPING = 300.0, 30.0, 0.1
"""K_p of (11) [1/s²], G_v [1/s] and λ of the paper."""
MENDED_VELOCITY_KP = 20.0
"""K_p of (15) as mended [1/s]. The paper gives one K_p of 300: in (15), at 100 Hz, it overshoots threefold."""
MENDED_DAMPING = (0.03, PRINTED_DAMPING)
"""λ as mended: of the feet, and of the points."""
REST_RATE = 5.0
"""Rate at which joints go to rest where the points leave them free [1/s]."""
PAIR_REACH = 0.2
"""Distance above which a pair's weight is nothing [m]: e^(−10) of (25)."""
CASCADE_POSTURE_KP, CASCADE_POSTURE_WEIGHT = 25.0, 0.05
"""Stiffness [1/s²] and weight, in the points' level, with which the cascade keeps the rest posture."""


@dataclass(frozen=True)
class Method:
    """A named way to follow key points.

    Args:
        name: In tables.
        law: Makes the law for a robot, its points' names and reference.
        velocities: Whether the law gives velocities instead of accelerations.
    """

    name: str
    law: Callable[[Robot, Sequence[str], SampledPoints], Law]
    velocities: bool = False


def resolved(
    weighting: Callable[[Robot], Weighting],
    velocity_kp: float = MENDED_VELOCITY_KP,
    damping: Sequence[float] = MENDED_DAMPING,
    exact_projectors: bool = True,
    velocity_gain: float = VELOCITY_GAIN,
    rest_rate: float = 0.0,
) -> Callable[[Robot, Sequence[str], SampledPoints], Law]:
    """Resolved acceleration, or velocities if G_v is infinite, by some weighting; with a `rest_rate`, ζ of (32)."""

    def make(robot: Robot, names: Sequence[str], reference: SampledPoints) -> Law:
        feet = ResolvedPoints(robot, robot.feet, standing_feet(robot), KP, velocity_kp, velocity_gain)
        points = ResolvedPoints(robot, names, reference, KP, velocity_kp, velocity_gain)
        pairs = NearestPairs(robot, PAPER_PAIR_COUNT, PAIR_REACH, 1.0 / velocity_gain)
        solver = ResolvedAcceleration(damping, exact_projectors)
        preferred = towards_rest(robot, rest_rate, velocity_gain) if rest_rate else None
        return ConstrainedResolvedAcceleration([feet, points], pairs, weighting(robot), solver, preferred)

    return make


def cascade(robot: Robot, names: Sequence[str], reference: SampledPoints) -> Law:
    """This project's strict hierarchy: bounds and distances are rows of level 0, then the feet, then the points."""
    limits: list[Task] = [JointBounds(robot), SelfCollision(robot)]
    feet = ResolvedPoints(robot, robot.feet, standing_feet(robot), KP, velocity_gain=0.0)
    points = ResolvedPoints(robot, names, reference, KP, velocity_gain=0.0)
    posture = Posture(robot, robot.rest[7:], kp=CASCADE_POSTURE_KP, weight=CASCADE_POSTURE_WEIGHT)
    solver = Cascade()

    def law(tick: Tick) -> Array:
        levels = [
            Level.stack(name, [task.rows(tick) for task in tasks], robot.nv)
            for name, tasks in (("hard", limits), ("feet", [feet]), ("points", [points, posture]))
        ]
        solution = solver.solve(levels)
        if solution.status >= Status.FAILED:
            raise ArithmeticError("the cascade has no answer")
        return solution.x

    return law


def standing_feet(robot: Robot) -> Callable[[float], PointsSample]:
    """Both feet where they are at rest."""
    tick, still = Tick(robot), np.zeros((len(robot.feet), 6))
    frames = [tick.frame(foot) for foot in robot.feet]
    sample = PointsSample(
        np.array([frame.position for frame in frames]), still, still, np.array([frame.rotation for frame in frames])
    )
    return lambda t: sample


def _mended(dynamic: DynamicWeight, velocity_gain: float = VELOCITY_GAIN) -> Callable[[Robot], Weighting]:
    return lambda robot: MendedWeighting(robot, dynamic, velocity_gain)


METHODS = {
    method.name: method
    for method in (
        Method("no constraints", resolved(lambda robot: DynamicOnly(inertia_weight))),
        Method(
            "CRAC as printed",
            resolved(lambda robot: PrintedWeighting(robot, inertia_weight), KP, (PRINTED_DAMPING,), False),
        ),
        Method("CRAC mended", resolved(_mended(inertia_weight))),
        Method("CRAC mended, ζ", resolved(_mended(inertia_weight), rest_rate=REST_RATE)),
        Method("CRAC mended, I", resolved(_mended(unit_weight))),
        Method("CCLIK mended", resolved(_mended(inertia_weight, np.inf), velocity_gain=np.inf), velocities=True),
        Method("cascade", cascade),
    )
}
"""By name. W_D is H where nothing else is said; ζ is 0 where nothing else is said."""
