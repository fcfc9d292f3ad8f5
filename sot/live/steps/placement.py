"""A person in the robot's size over the robot's feet where they are now, as both of them go."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sot.control.pose import Pose
from sot.live.person import Moment, Person
from sot.live.placement import MomentTargets, person_placed, turn_about_z
from sot.live.steps.foot_sense import wrapped
from sot.motion.feet.stance import Build
from sot.motion.human.human import SIDES

Array = NDArray[np.float64]


PELVIS_TWIST_SHARE = 0.5
"""Share of the person's turn of the pelvis over the feet that the robot's makes: its strides are shorter."""


class SteppingPlacement:
    """Puts the middle of the person's ankles over the middle of the robot's feet, and turns both alike.

    Args:
        build: the robot's sizes.
        person: the person's.
        turn: from the person's heading to the robot's [rad].
    """

    def __init__(self, build: Build, person: Person, turn: float) -> None:
        self._build, self._person, self._turn = build, person, turn

    def __call__(self, moment: Moment, level: float, feet: Mapping[str, Pose]) -> MomentTargets:
        """Targets of a person over feet.

        level: height of the person's standing ankle [m].
        """
        build = self._build
        middle = np.mean([pose.position[:2] for pose in feet.values()], axis=0)
        ahead = np.sum([pose.rotation[:2, 0] for pose in feet.values()], axis=0)
        heading = float(np.arctan2(ahead[1], ahead[0]))
        pelvis = moment.frames["pelvis"]
        facing = float(np.arctan2(pelvis[1, 0], pelvis[0, 0]))
        twist = wrapped(facing + self._turn - heading)
        turn = heading + PELVIS_TWIST_SHARE * float(np.clip(twist, -build.turn, build.turn)) - facing
        ankles = np.mean([moment.points[f"{side}_ankle"][:2] for side in SIDES], axis=0)
        origin = np.append(ankles, level)
        over = np.append(middle, 0.0) + build.ankles * [0.0, 0.0, 1.0]
        return person_placed(moment, build, self._person, turn_about_z(turn), origin, over)
