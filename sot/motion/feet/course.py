"""What a dance asks of a robot's body, over time: the human to look like, and the way of the feet."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sot.motion.feet.contacts import Phase, planted
from sot.motion.feet.footholds import Reach
from sot.motion.feet.footwork import Step
from sot.motion.feet.slides import Slide, slid_paths, slid_phases
from sot.motion.feet.stance import Build
from sot.motion.feet.swing import FootPath, foot_paths, phases_of, standing
from sot.motion.feet.travel import Travel, slowed_travel, travel
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
    """

    human: Human
    phases: tuple[Phase, ...]
    feet: Mapping[str, FootPath]
    clock: Array
    travel: Travel | None = None


def stay(human: Human, robot: Robot) -> Course:
    """Both feet stay where the rest posture puts them, for a human over them (see `stance.over_feet`)."""
    phases = planted(robot, human.duration)
    return Course(human, phases, standing(phases[0], human.count), human.times)


def slid(course: Course, robot: Robot, slides: Sequence[Slide]) -> Course:
    """The same course, whose feet stay, with some slides in it."""
    phases = slid_phases(course.phases, slides, robot)
    return replace(course, phases=phases, feet=slid_paths(course.feet, slides, robot, course.human.times))


def go(human: Human, robot: Robot, build: Build, contacts: Sequence[Step] | None) -> Course:
    """The feet step where and when the human's do.

    contacts: the steps to make, in the clip's time, instead of those found.
    """
    return _along(travel(human, build, Reach.of(robot), contacts), robot)


def slowed_down(course: Course, robot: Robot, clock: Array) -> Course:
    """A course that steps, at the times (T,) that a clock shows at its frames, later than its own."""
    if course.travel is None:
        raise ValueError("feet that stay have no steps to slow down")
    return _along(slowed_travel(course.travel, clock), robot)


def _along(going: Travel, robot: Robot) -> Course:
    human, reach = going.human, Reach.of(robot)
    phases = phases_of(robot, going.stands, going.steps, human.duration)
    feet = foot_paths(robot, going.stands, going.steps, going.lifts, reach, human.times)
    return Course(human, phases, feet, going.clock, going)
