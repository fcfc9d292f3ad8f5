"""The course of a dance: the human to look like and the paths of the feet, over time."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.climbing.terrain import Terrain
from sot.motion.feet.contacts import Phase, planted_phases
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import Step
from sot.motion.feet.heel_rise import HeelRise, heel_rises
from sot.motion.feet.slides import Slide, paths_with_slides, phases_with_slides
from sot.motion.feet.stance import Build
from sot.motion.feet.swing import FootPath, contact_phases, foot_paths, mean_ground, standing_paths
from sot.motion.feet.travel import Travel, human_raised, plan_travel, travel_at_clock
from sot.motion.human.human import Human
from sot.robots.robot import Robot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Course:
    """A human in the robot's size and place on the motion's time line, and where the feet are then.

    Attributes:
        human: T frames.
        phases: which feet stand where, when.
        feet: their paths at the frames.
        clock: (n,) the motion's time at the dancer's frames, lead-in and tail included [s].
        travel: of feet that step.
        swing_shares: of each step, how much of its swing is the dancer's, 0 to 1; none where all are plain ones.
        swing_paths: the paths of the feet for such shares, once some are known.
        keeps_lifts: whether high lifts keep the dancer's time in the air, and half of their way before time is added.
        heels, rises: whether heels may rise, and the heel rise of each step.
    """

    human: Human
    phases: tuple[Phase, ...]
    feet: Mapping[str, FootPath]
    clock: Array
    travel: Travel | None = None
    swing_shares: tuple[float, ...] = ()
    swing_paths: Callable[[Sequence[float]], Mapping[str, FootPath]] | None = None
    keeps_lifts: bool = False
    heels: bool = False
    rises: tuple[HeelRise | None, ...] = ()


def standing_course(human: Human, robot: Robot) -> Course:
    """The course of feet that stay where the rest posture puts them, for a human over them (`human_over_feet`)."""
    phases = planted_phases(robot, human.duration)
    return Course(human, phases, standing_paths(phases[0], human.count), human.times)


def with_slides(course: Course, robot: Robot, slides: Sequence[Slide]) -> Course:
    """A course of standing feet with some slides in it."""
    phases = phases_with_slides(course.phases, slides, robot)
    return replace(course, phases=phases, feet=paths_with_slides(course.feet, slides, robot, course.human.times))


def stepping_course(
    human: Human,
    robot: Robot,
    build: Build,
    contacts: Sequence[Step] | None,
    keep_lifts: bool = False,
    as_danced: bool = False,
    heels: bool = True,
    terrain: Terrain | None = None,
) -> Course:
    """The course of feet that step where and when the human's do.

    contacts: the steps to make, in the clip's time, instead of those found.
    keep_lifts: whether high lifts keep the dancer's time in the air.
    as_danced: whether the dancer's time and way are kept.
    heels: whether heels may rise; on level ground alone.
    terrain: what there is to step on; the floor alone unless given.
    """
    travel = plan_travel(human, build, LegReach.of(robot), contacts, keep_lifts, as_danced, terrain)
    course = _course_along(travel, robot, heels and terrain is None)
    return replace(course, keeps_lifts=keep_lifts)


def with_clock(course: Course, robot: Robot, clock: Array) -> Course:
    """A course on a slower clock, which shows the times (T,) at the course's frames [s].

    Raises:
        ValueError: its feet slide, at a speed of their own.
    """
    if course.travel is not None:
        slow = _course_along(travel_at_clock(course.travel, clock), robot, course.heels)
        return replace(slow, keeps_lifts=course.keeps_lifts)
    if len(course.phases) > 1:
        raise ValueError("feet that slide have a speed of their own")
    human = course.human
    times = np.arange(round(clock[-1] * human.rate) + 1) / human.rate
    slow = standing_course(human.resampled_at(np.interp(times, clock, human.times), human.rate), robot)
    return replace(slow, clock=np.interp(course.clock, human.times, clock))


def _course_along(going: Travel, robot: Robot, heels: bool) -> Course:
    human, reach = going.human, LegReach.of(robot)
    rises: tuple[HeelRise | None, ...] = ()
    if heels:
        pelvis = human.frames["pelvis"]
        heading = np.arctan2(pelvis[:, 1, 0], pelvis[:, 0, 0])
        rises = heel_rises(robot, going.stands, going.steps, human.points["waist"], heading, human.times, reach)
    phases = contact_phases(robot, going.stands, going.steps, human.duration, rises)
    feet = foot_paths(robot, going.stands, going.steps, going.lifts, reach, human.times, rises)
    raised = human_raised(human, mean_ground(feet))
    return Course(raised, phases, feet, going.clock, going, heels=heels, rises=rises)
