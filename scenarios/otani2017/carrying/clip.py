"""A box carried after a human who was recorded with one: the human's steps and box in the robot's size."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion import read, recognise
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.limits import Limits
from sot.motion.body.spline import Spline
from sot.motion.body.targets import Targets
from sot.motion.carrying.arms import palm_places
from sot.motion.carrying.carry import STANDOFF, CarryPlan
from sot.motion.carrying.handling_times import CLOSING_TIME
from sot.motion.carrying.held_arms import HeldBox, held_places, with_box_held
from sot.motion.feet.stance import Build
from sot.motion.human.formats.omomo import read_omomo, read_omomo_object
from sot.motion.human.human import Human
from sot.motion.objects.pose_path import blended
from sot.motion.objects.retarget import Scale
from sot.motion.plan import PLAN_RATE, Plan, plan
from sot.robots.robot import Robot
from sot.smooth import low_passed, minimum_jerk

Array = np.ndarray

LARGE_BOX_M = (0.46, 0.47, 0.41)
"""Size of OMOMO's large box, of which no recording says anything [m]."""
MOVED_M = 0.01
"""Way of an object from where it lies that is more than a recording's noise [m]."""
HANDS_PITCH = 1.1
"""Angle by which the fingers point down: between a box on the floor and one before the chest [rad]."""
GRIP_BELOW_TOP = 0.07
"""Distance of the palms' middle from the top of the box [leg lengths]: lower, arms do not reach a box on the floor."""
REACHING_TIME, EASING_TIME, LOWERING_TIME, HOLDING_TIME = 4.0, 1.6, 2.0, 0.4
"""Times [√(leg / g)] of arms from the human's to beside the box, of a box from where it lies to its way, of lowering
it, and for which it is held when it is placed."""
PACE = 0.6
"""Speed of the robot's motion over the human's: its steps are as long as its legs admit, and it carries something."""
FACING_SHARE = 0.8
"""Share of the way from where the chest faces to where the box is by which the box, and so the chest, turns: arms hold
a box straight ahead, and the waist sways from foot to foot."""
TURN_RATE = 0.25
"""Fastest turning of the box that is not smoothed away, per √(leg / g)."""


@dataclass(frozen=True)
class ClipCarry:
    """A carrying after a clip.

    Attributes:
        carry: what the robot is to do.
        plan: how its motion came from the human's.
        way: of the human's box in the robot's size (T, 3) at the carry's knots [m].
    """

    carry: CarryPlan
    plan: Plan
    way: Array

    @property
    def remarks(self) -> list[str]:
        """What the robot does otherwise than the human, a sentence each."""
        return [
            *self.plan.remarks,
            f"The robot is {PACE:g} times as fast as the human.",
            "While palms lie flat on the box's sides, arms are not the human's, and chest and box turn together.",
        ]


@dataclass(frozen=True)
class ClipBox:
    """A recorded box in the size of a robot that holds it.

    Attributes:
        robot: who carries.
        size: of the box [m].
        path: of its middle (T, 3) [m].
        lifted, placed: when it leaves where it lies, and when it lies again, in the clip's time [s].
        rate: of the path [Hz].
        unit: of times, √(leg / g) [s].
    """

    robot: Robot
    size: tuple[float, float, float]
    path: Array
    lifted: float
    placed: float
    rate: float
    unit: float

    @classmethod
    def of(cls, clip: Path, human: Human, robot: Robot) -> "ClipBox":
        """The box of a clip.

        Args:
            clip: the recording.
            human: who is recorded, at the pace at which the robot follows.
            robot: who carries.

        Raises:
            InputError: it is carried nowhere.
        """
        build = Build.of(robot)
        scale, at = Scale.of(human, build), _object_path(clip)
        depth, width, height = (scale.factor * length for length in LARGE_BOX_M)
        path = scale(at)
        path[:, 2] = 0.5 * height + scale.factor * np.maximum(at[:, 2] - at[0, 2], 0.0)
        lifted, placed = _moved(at)
        unit = float(np.sqrt(build.leg / GRAVITY))
        return cls(robot, (depth, width, height), path, lifted / human.rate, placed / human.rate, human.rate, unit)

    @property
    def hands(self) -> dict[str, pin.SE3]:
        """Where hands hold it, in its axes."""
        grip = np.array([0.0, 0.0, 0.5 * self.size[2] - GRIP_BELOW_TOP * Build.of(self.robot).leg])
        return palm_places(self.robot, self.size[1], HANDS_PITCH, grip)

    def way(self, knots: Array, clock: Array) -> Array:
        """Where it is (T, 3) at times (T,) [s] of a motion that shows the clip's frames at times (n,) at PLAN_RATE."""
        clip_times, frames = np.interp(knots, clock, _frame_times(clock)), np.arange(len(self.path)) / self.rate
        return np.column_stack([np.interp(clip_times, frames, column) for column in self.path.T])

    def moved(self, clock: Array) -> tuple[float, float]:
        """When it is lifted and placed by a motion that shows the clip's frames at times (n,) at PLAN_RATE [s]."""
        lifted, placed = np.interp([self.lifted, self.placed], _frame_times(clock), clock).tolist()
        return lifted, placed

    def limbs(self, clock: Array, wanted: Targets, limits: Limits, body_motion: Spline) -> Spline:
        """The `sot.motion.plan.LimbFit` of arms that hold it; the box turns to be ahead of the chest."""
        y, (lifted, placed) = body_motion.knots, self.moved(clock)
        knots = body_motion.period * np.arange(len(y))
        way, cutoff = self.way(knots, clock), TURN_RATE / self.unit
        turned, chest = Kinematics(JointTree(self.robot), y).frame_pose(self.robot.point("chest"))
        left, ahead = turned[:, :2, 1], low_passed((way - chest)[:, :2], PLAN_RATE, cutoff)
        faced, seen = np.unwrap(np.arctan2(-left[:, 0], left[:, 1])), np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
        turn = low_passed(faced + FACING_SHARE * (seen - faced), PLAN_RATE, cutoff)
        closing, reaching = CLOSING_TIME * self.unit, REACHING_TIME * self.unit
        gripped, released = lifted - closing, placed + HOLDING_TIME * self.unit

        def share(start: float, duration: float) -> Array:
            return np.asarray(minimum_jerk(np.asarray((knots - start) / duration, dtype=float)))

        away = 1.0 - share(gripped, closing) + share(released, closing)
        for_box = share(gripped - reaching, reaching) - share(released + closing, reaching)
        box = HeldBox(way, turn, self.hands, STANDOFF * Build.of(self.robot).leg * away, for_box)
        return with_box_held(self.robot, wanted, limits, body_motion, box)


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
    box = ClipBox.of(clip, human, robot)
    planned = plan(human, _loaded(robot, mass), "steps", rate, limbs=box.limbs, heels=False)
    motion, (lifted, placed) = replace(planned.motion, robot=robot), box.moved(planned.clock)
    knots = np.arange(round(motion.duration * PLAN_RATE) + 1) / PLAN_RATE
    y = from_configuration(np.array([motion.sample(t).q for t in knots.tolist()]))
    easing = EASING_TIME * box.unit
    held = _resting(held_places(robot, y, box.hands), knots, (lifted, placed), easing, 0.5 * box.size[2])
    gripped, released = lifted - CLOSING_TIME * box.unit, placed + HOLDING_TIME * box.unit
    times = gripped, lifted, max(placed - LOWERING_TIME * box.unit, lifted), placed, released
    return ClipCarry(
        CarryPlan(motion, held, knots, *times, box.hands, box.size), planned, box.way(knots, planned.clock)
    )


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


def _frame_times(clock: Array) -> Array:
    """The clip's times (n,) at the frames of a clock [s]."""
    return np.arange(len(clock)) / PLAN_RATE


def _moved(at: Array) -> tuple[int, int]:
    """The last frame before an object (T, 3) leaves where it lies, and the first one when it lies again.

    Raises:
        InputError: it never does.
    """
    left, lies = (np.linalg.norm(at - end, axis=1) > MOVED_M for end in (at[0], at[-1]))
    if not left.any() or not lies.any():
        raise InputError("the recording's object is not carried anywhere")
    return int(np.flatnonzero(left)[0]) - 1, int(np.flatnonzero(lies)[-1]) + 1


def _resting(
    way: Sequence[pin.SE3], knots: Array, moved: tuple[float, float], easing: float, height: float
) -> list[pin.SE3]:
    """A way that begins where it is when it is lifted and ends where it is placed, at rest, a height over the floor."""
    ends = []
    for time in moved:
        end = way[int(np.searchsorted(knots, time - 1e-9))]
        ends.append(pin.SE3(end.rotation, np.array([*end.translation[:2], height])))
    first, second = minimum_jerk((knots - moved[0]) / easing), minimum_jerk((knots - moved[1]) / easing + 1.0)
    position, rotation = blended([ends[0]] * len(way), way, first)
    eased = [pin.SE3(turn, place) for turn, place in zip(rotation, position, strict=True)]
    position, rotation = blended(eased, [ends[1]] * len(way), second)
    return [pin.SE3(turn, place) for turn, place in zip(rotation, position, strict=True)]
