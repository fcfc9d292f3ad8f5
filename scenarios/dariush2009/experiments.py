"""The paper's experiments, each on one clip."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from scenarios.dariush2009.time_modulation import duration_keeping_times, modulated_times, modulation_factors
from scenarios.dariush2009.velocity_runs import GAIN, VelocityRun, follow_by_velocities
from scenarios.hammam2015.key_point_reference import RATE, KeyPointReference
from scenarios.hammam2015.kinematic_run import RANGE_TOLERANCE
from scenarios.hammam2015.pictures import HANDS, arm_distances
from sot.motion.human.key_points import KEY_POINTS
from sot.robots.robot import Robot
from tasks.resolved.redirection import Redirection
from tasks.resolved.weighting import LimitWeighting

Array = np.ndarray

THREE_POINTS = ("waist", "left_wrist", "right_wrist")
FOUR_POINTS = (*THREE_POINTS, "head")
PRIORITIES = (("waist",), ("left_wrist", "right_wrist"), tuple(n for n in KEY_POINTS if n not in THREE_POINTS))
"""The paper's three levels of Figure 6."""
HIGH_GAIN = 150.0
"""K of the point that counts most in Figure 5 [1/s]."""
NOISE_M, NOISE_SEED = 0.05, 9
"""Noise of elbows that a camera sees badly [m]."""
LOW_CONFIDENCE = 0.05
"""Confidence in them."""
COLLISION_DAMPING = 0.1
SHIFTS = {"δ = 0.5": 0.5, "δ = 1": 1.0}
ARMS: dict[str, tuple[str, str | None]] = {
    "left arm, trunk": ("left_arm", None),
    "right arm, trunk": ("right_arm", None),
    "arms": ("left_arm", "right_arm"),
}
"""Parts of the body of which the least distance of a run is."""


@dataclass(frozen=True)
class PriorityRun:
    """A run with its figures: rms of each level's points [m]."""

    run: VelocityRun
    figures: dict[str, float]


@dataclass(frozen=True)
class LimitRuns:
    """Runs without and with the weight of (14), and their figures."""

    free: VelocityRun
    kept: VelocityRun
    lower: Array
    upper: Array
    figures: dict[str, Any]


@dataclass(frozen=True)
class CollisionRuns:
    """Least distances over time by way of redirection, name -> pair -> (k,) [m], and the least of all by name [m]."""

    times: Array
    distances: dict[str, dict[str, Array]]
    figures: dict[str, float]


def gain_figures(robot: Robot, reference: KeyPointReference) -> dict[str, dict[str, float]]:
    """Figure 5: rms errors [m] of three points, for the point that has the higher gain."""
    figures = {}
    for favoured in THREE_POINTS:
        gains = {name: HIGH_GAIN if name == favoured else GAIN for name in THREE_POINTS}
        run = follow_by_velocities(robot, reference, [THREE_POINTS], gains.__getitem__)
        figures[favoured] = {name: run.rms(name) for name in THREE_POINTS}
    return figures


def confidence_figures(robot: Robot, reference: KeyPointReference) -> dict[str, dict[str, float]]:
    """4.3.1: rms errors [m] from the true points where elbows are seen badly: confidence as a gain, or a weight."""
    rng = np.random.default_rng(NOISE_SEED)
    noisy = dict(reference.positions)
    for name in ("left_elbow", "right_elbow"):
        noisy[name] = noisy[name] + rng.normal(0.0, NOISE_M, noisy[name].shape)
    seen = KeyPointReference.through(reference.times, noisy)
    # A noisy point has no rate worth following.
    for name in ("left_elbow", "right_elbow"):
        seen.velocities[name][:] = 0.0

    def confidence(name: str) -> float:
        return LOW_CONFIDENCE if name.endswith("elbow") else 1.0

    runs = {
        "true": follow_by_velocities(robot, reference, [KEY_POINTS]),
        "unsaid": follow_by_velocities(robot, seen, [KEY_POINTS], judged_by=reference),
        "gain": follow_by_velocities(robot, seen, [KEY_POINTS], confidence=confidence, judged_by=reference),
        "weight": follow_by_velocities(robot, seen, [KEY_POINTS], point_weights=confidence, judged_by=reference),
    }
    return {
        kind: {
            "elbows": run.rms("left_elbow", "right_elbow"),
            "wrists": run.rms("left_wrist", "right_wrist"),
            "joint_speed_rms": float(np.sqrt(np.mean(np.square(np.diff(run.q[:, 7:], axis=0) * RATE)))),
        }
        for kind, run in runs.items()
    }


def priority_runs(robot: Robot, reference: KeyPointReference) -> dict[str, PriorityRun]:
    """Figure 6: three priorities by Algorithm 1, as printed and with exact null spaces; and all on one level."""
    runs = {
        "augmentation": follow_by_velocities(robot, reference, [KEY_POINTS]),
        "Algorithm 1": follow_by_velocities(robot, reference, PRIORITIES, exact_projectors=False),
        "Algorithm 1, exact": follow_by_velocities(robot, reference, PRIORITIES),
    }
    return {
        name: PriorityRun(run, {" ".join(level): run.rms(*level) for level in PRIORITIES}) for name, run in runs.items()
    }


def limit_runs(robot: Robot, reference: KeyPointReference, lower: Array, upper: Array) -> LimitRuns:
    """Figure 7: all eight points without and with the weight of (14), within given ranges."""
    free = follow_by_velocities(robot, reference, [KEY_POINTS])
    kept = follow_by_velocities(robot, reference, [KEY_POINTS], weighting=LimitWeighting(robot, lower, upper))

    def figures(run: VelocityRun) -> dict[str, float]:
        beyond = np.maximum(run.q[:, 7:] - upper, lower - run.q[:, 7:])
        return {
            "beyond_rad": float(beyond.max()),
            "joints_out": float((beyond > RANGE_TOLERANCE).sum(axis=1).mean()),
            "points_rms_m": run.rms(*KEY_POINTS),
        }

    return LimitRuns(free, kept, lower, upper, {"without": figures(free), "with": figures(kept)})


def velocity_figures(robot: Robot, run: VelocityRun) -> dict[str, float | None]:
    """4.5: how much longer a motion takes whose clock keeps velocity limits, and whether its duration can be kept."""
    factors = modulation_factors(run.q[:, 7:], 1.0 / RATE, robot.velocity)
    duration, keeping = float(run.times[-1]), duration_keeping_times(factors, 1.0 / RATE)
    return {
        "most": float(factors.max()),
        "late_s": float(modulated_times(factors, 1.0 / RATE)[-1]) - duration,
        "fastest_play": None if keeping is None else float(1.0 / (RATE * np.diff(keeping).min())),
    }


def collision_runs(robot: Robot, reference: KeyPointReference) -> CollisionRuns:
    """Figures 11 and 12: four points without redirection, with it as printed, and mended."""
    pairs = range(len(robot.shapes.collisionPairs))
    runs = {"without": follow_by_velocities(robot, reference, [FOUR_POINTS])}
    for name, shift in SHIFTS.items():
        runs[name] = follow_by_velocities(
            robot, reference, [FOUR_POINTS], redirection=Redirection(robot, pairs, shift, COLLISION_DAMPING)
        )
    runs["mended"] = follow_by_velocities(robot, reference, [FOUR_POINTS], keep_apart=True)
    found = {name: arm_distances(robot, run.times, run.q, {**HANDS, **ARMS}) for name, run in runs.items()}
    times = found["without"][0]
    distances = {name: of for name, (_, of) in found.items()}
    figures = {name: float(min(of[pair].min() for pair in ARMS)) for name, of in distances.items()}
    figures |= {f"wrists {name}": run.rms("left_wrist", "right_wrist") for name, run in runs.items()}
    return CollisionRuns(times, distances, figures)
