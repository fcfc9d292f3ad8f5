"""Where a robot's foot goes for a step of the person."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sot.live.steps.foot_sense import wrapped
from sot.live.steps.knee_speed import SAMPLES, KneeSpeed
from sot.live.steps.reachable import foothold_between, reachable_foothold
from sot.live.steps.step_plan import DecidedStep, lift_height
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import Foothold
from sot.robots.robot import Robot

Array = NDArray[np.float64]

SHORTENED_PARTS = (0.85, 0.7, 0.55, 0.4)
"""Parts of the way to a foothold that are tried where the knee would have to be too fast."""


class StepPlace:
    """The robot's foothold for a person's step, relative to the foot that stands.

    It is the nearest that the legs reach, and no farther than the knee of the foot in the air is fast enough: that is
    told once, when the step begins, for a place that went to and fro with each plan would leave no balance over.

    Args:
        robot: who steps.
        reach: of its legs, as of `live_reach`.

    Attributes:
        scale: lengths of the robot over the person's.
        turn: from the person's heading to the robot's [rad].
    """

    def __init__(self, robot: Robot, reach: LegReach) -> None:
        self._reach, self._knees = reach, KneeSpeed(robot)
        self.scale, self.turn = 1.0, 0.0

    def __call__(self, step: DecidedStep, beside: Foothold) -> Foothold:
        """The foothold, with the step's part of the way; beside: where the other foot stands meanwhile."""
        asked, start = step.asked, step.start
        cosine, sine = np.cos(self.turn), np.sin(self.turn)
        x, y = asked.place.x - asked.beside.x, asked.place.y - asked.beside.y
        wanted = Foothold(
            beside.x + self.scale * float(cosine * x - sine * y),
            beside.y + self.scale * float(sine * x + cosine * y),
            start.heading + wrapped(asked.place.heading + self.turn - start.heading),
        )
        far = self.reachable(step, beside, wanted)
        if step.part == 1.0:
            return far
        return self.reachable(step, beside, replace(foothold_between(start, far, step.part), heading=far.heading))

    def shorten(self, step: DecidedStep, beside: Foothold, com_at: Callable[[Array], Array]) -> None:
        """Let a step be as long as its knee is fast.

        Args:
            step: which has its place with all of the way.
            beside: where the other foot stands meanwhile.
            com_at: the centre of mass at times (n,) [s], (n, 3) [m].
        """
        com = com_at(np.linspace(step.lift, step.land, SAMPLES))
        heading, span = step.start.heading + 0.5 * wrapped(beside.heading - step.start.heading), step.land - step.lift
        for part in SHORTENED_PARTS:
            if self._knees(step.foot, step.start, step.place, span, self.rise(step), com, heading) < 1.0:
                return
            step.part = part
            step.place = self(step, beside)

    def reachable(self, step: DecidedStep, beside: Foothold, wanted: Foothold) -> Foothold:
        """The foothold nearest to a wanted one that a step reaches."""
        return reachable_foothold(self._reach, step.foot, wanted, step.start, beside, step.land - step.lift)

    def rise(self, step: DecidedStep) -> float:
        """How high its foot gets in a step [m]."""
        return lift_height(step, self._reach.leg_length, self.scale)
