"""A box carried after a human who was recorded with one: the human's steps and box in the robot's size."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from sim.log import RunLog
from sot.errors import InputError
from sot.motion import read, recognise
from sot.motion.carrying.arms import palm_places
from sot.motion.carrying.carry import CarryPlan
from sot.motion.feet.stance import Build
from sot.motion.human.formats.omomo import read_omomo, read_omomo_object
from sot.motion.human.human import SIDES
from sot.motion.objects.pose_path import blended
from sot.motion.objects.retarget import Scale
from sot.motion.plan import PLAN_RATE, Plan, plan
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk

Array = np.ndarray

UPPER_BODY = ("chest", "head", *(f"{side}_{part}" for part in ("shoulder", "elbow", "wrist") for side in SIDES))
"""Points that tell how near the upper body is."""
LARGE_BOX_M = (0.46, 0.47, 0.41)
"""Size of OMOMO's large box, of which no recording says anything [m]."""
MOVED_M = 0.01
"""Way of an object from where it lies that is more than a recording's noise [m]."""
HANDS_PITCH = 0.8
"""Angle by which the fingers point down: between a box on the floor and one before the chest [rad]."""
GRIP_BELOW_TOP_M = 0.05
"""Distance of the palms' middle from the top of a box that stands on the floor [m]."""
EASING_S, HOLDING_S, LOWERING_S = 0.4, 0.1, 0.5
"""Time in which a box goes over from where it lies to its way, of a grip, and of lowering it [s]."""
PACE = 0.6
"""Speed of the robot's motion over the human's: its steps are as long as its legs admit, and it carries something."""
MAX_ASIDE_LEGS = 0.06
"""Greatest distance of the box's middle from where the shoulders face [leg lengths]."""
AHEAD_RANGE_LEGS = 0.48, 0.75
"""Least and greatest distance of the box's middle from the waist, as far as arms hold it level [leg lengths]."""


@dataclass(frozen=True)
class ClipCarry:
    """A carrying after a clip.

    Attributes:
        carry: what the robot is to do.
        plan: how its motion came from the human's.
        way: of the human's box in the robot's size (T, 3), from where the robot takes it, at the carry's knots [m].
    """

    carry: CarryPlan
    plan: Plan
    way: Array


def carry_after(clip: Path, robot: Robot, mass: float, rate: float) -> ClipCarry:
    """The carrying of a recorded human for a robot, on its own steps.

    Args:
        clip: a recording with a box, as OMOMO's (.pt).
        robot: who carries.
        mass: of the box [kg].
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: no such recording, or a robot that cannot do it.
    """
    if clip.suffix != ".pt":
        raise InputError(f"{clip}: holds no box to carry; `--clip` of otani carry takes a recording of OMOMO (.pt)")
    human = recognise(read(clip))
    human = replace(human, rate=PACE * human.rate)
    planned = plan(human, _loaded(robot, mass), "steps", rate)
    motion = replace(planned.motion, robot=robot)
    scale = Build.of(robot).leg / human.leg
    depth, width, height = (scale * length for length in LARGE_BOX_M)
    knots = np.arange(round(motion.duration * PLAN_RATE) + 1) / PLAN_RATE
    clip_times = np.interp(knots, planned.clock, np.arange(len(planned.clock)) / PLAN_RATE)
    at = _along(_object_path(clip), human.rate, clip_times)
    lifted, placed = _moved(at, knots)
    way = Scale.of(human, Build.of(robot))(at)
    way[:, 2] = 0.5 * height + scale * np.maximum(at[:, 2] - at[0, 2], 0.0)
    taken = _reachable(motion, knots, way)[int(np.searchsorted(knots, lifted - 1e-9))].translation
    way[:, :2] += taken[:2] - way[0, :2]
    box = _resting(_reachable(motion, knots, way), knots, lifted, placed, 0.5 * height)
    grip = np.array([0.0, 0.0, 0.5 * height - GRIP_BELOW_TOP_M])
    times = lifted - HOLDING_S, lifted, max(placed - LOWERING_S, lifted), placed, placed + HOLDING_S
    hands = palm_places(robot, width, HANDS_PITCH, grip)
    carry = CarryPlan(motion, box, knots, *times, hands, (depth, width, height))
    return ClipCarry(carry, planned, way)


def _loaded(robot: Robot, mass: float) -> Robot:
    """The robot with half of a load in each hand: what its balance is planned with."""
    model = pin.Model(robot.model)
    for side in ("left", "right"):
        palm = robot.surface(f"{side}_palm")
        assert palm.point is not None
        frame = model.frames[robot.point(palm.point)]
        half = pin.Inertia(0.5 * mass, palm.placement.translation, np.zeros((3, 3)))
        model.appendBodyToJoint(frame.parentJoint, half, frame.placement)
    return replace(robot, model=model)


def _object_path(clip: Path) -> Array:
    """Positions of a recording's object (T, 3) in the world in which the human is read [m]."""
    raw, human, track = read_omomo(clip), read(clip), read_omomo_object(clip)
    turn = human.rotations[0, 0] @ raw.rotations[0, 0].T
    path: Array = (track.position - raw.positions[0, 0]) @ turn.T + human.positions[0, 0]
    return path


def _along(values: Array, rate: float, times: Array) -> Array:
    """Values (T, n) at a rate [Hz], at other times."""
    frames = np.arange(len(values)) / rate
    return np.column_stack([np.interp(times, frames, column) for column in values.T])


def _moved(at: Array, knots: Array) -> tuple[float, float]:
    """When an object leaves where it lies, and when it lies again [s].

    Raises:
        InputError: it never does.
    """
    left, lies = (np.linalg.norm(at - end, axis=1) > MOVED_M for end in (at[0], at[-1]))
    if not left.any() or not lies.any():
        raise InputError("the recording's object is not carried anywhere")
    return float(knots[np.flatnonzero(left)[0] - 1]), float(knots[np.flatnonzero(lies)[-1] + 1])


def _reachable(motion: Motion, knots: Array, way: Array) -> list[pin.SE3]:
    """Level places nearest to a way (T, 3) in which arms hold a box: ahead of the waist, where the shoulders face."""
    waist, chest = motion.pose("waist"), motion.pose("chest")
    low, high = (share * Build.of(motion.robot).leg for share in AHEAD_RANGE_LEGS)
    aside = MAX_ASIDE_LEGS * Build.of(motion.robot).leg
    found = []
    for t, wanted in zip(knots.tolist(), way, strict=True):
        left = chest(t).rotation[:, 1]  # level even if the trunk is pitched far
        turn = pin.utils.rotate("z", float(np.arctan2(-left[0], left[1])))
        local = turn.T @ (wanted - waist(t).position)
        local[:2] = np.clip(local[:2], [low, -aside], [high, aside])
        found.append(pin.SE3(turn, waist(t).position + turn @ local))
    return found


def _resting(way: Sequence[pin.SE3], knots: Array, lifted: float, placed: float, height: float) -> list[pin.SE3]:
    """A way that begins where it is when it is lifted and ends where it is placed, at rest, a height over the floor."""
    ends = []
    for time in (lifted, placed):
        end = way[int(np.searchsorted(knots, time - 1e-9))]
        ends.append(pin.SE3(end.rotation, np.array([*end.translation[:2], height])))
    first, second = minimum_jerk((knots - lifted) / EASING_S), minimum_jerk((knots - placed) / EASING_S + 1.0)
    position, rotation = blended([ends[0]] * len(way), way, first)
    eased = [pin.SE3(turn, place) for turn, place in zip(rotation, position, strict=True)]
    position, rotation = blended(eased, [ends[1]] * len(way), second)
    return [pin.SE3(turn, place) for turn, place in zip(rotation, position, strict=True)]


def clip_figures(
    after: ClipCarry, log: RunLog, rows: Array, at: Array, clock: Array, robot: Robot
) -> dict[str, float | None]:
    """How near a run came to the clip while the box was held.

    Args:
        after: What was planned.
        log: Of the run.
        rows: Its rows (n,) that count.
        at: Where the box was in these rows, seen from above (n, 2) [m].
        clock: The demonstration's time at every tick (T,) [s].
        robot: Who carried.

    Returns:
        The box's greatest distance from the clip's way, and the upper body's mean distances, seen from the waist, from
        the reference and from the human in the robot's size [m, mm].
    """
    if not len(rows):
        return {"off_clip_max_m": None, "upper_body_mpjpe_mm": None, "upper_body_human_mm": None}
    times, motion, human = clock[rows], after.carry.motion, after.plan.human
    way = np.column_stack([np.interp(times, after.carry.knots, after.way[:, k]) for k in range(2)])
    data, own, meant, shown = robot.model.createData(), [], [], []

    def points(q: Array) -> Array:
        pin.framesForwardKinematics(robot.model, data, q)
        places = np.array([data.oMf[robot.point(name)].translation for name in ("waist", *UPPER_BODY)])
        return places[1:] - places[0]

    for row, t in zip(rows.tolist(), times.tolist(), strict=True):
        own.append(points(log.q[row]))
        meant.append(points(motion.sample(t).q))
        k = min(round(t * human.rate), human.count - 1)
        shown.append([human.points[name][k] - human.points["waist"][k] for name in UPPER_BODY])

    def mean_mm(other: list[Any]) -> float:
        return float(1e3 * np.linalg.norm(np.array(own) - np.array(other), axis=2).mean())

    return {
        "off_clip_max_m": float(np.linalg.norm(at - way, axis=1).max()),
        "upper_body_mpjpe_mm": mean_mm(meant),
        "upper_body_human_mm": mean_mm(shown),
    }
