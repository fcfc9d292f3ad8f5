"""How fast a knee has to bend and stretch in a step."""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.behaviours.stride import bump
from sot.motion.feet.footwork import Foothold
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

MAX_SPEED_SHARE = 1.15
"""Share of a knee's speed limit that a step may ask for: a foot that is late by little lands in time all the same."""
SAMPLES = 13
"""Moments of a step that are looked at."""
MAX_LENGTH_SHARE = 0.999
"""Share of a stretched leg's length that it is taken to have at most."""


class KneeSpeed:
    """Speed of the knee of a foot in the air over the greatest that a step may ask for.

    A leg is as long as its hip is from its ankle, and that says how far its knee is bent. The hips go with the centre
    of mass, as high as they are now; the foot goes as a `Stride` does.

    Args:
        robot: who steps.
    """

    def __init__(self, robot: Robot) -> None:
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, robot.rest)
        com = pin.centerOfMass(robot.model, data, robot.rest).copy()
        self._hips, self._links = dict[str, Array](), dict[str, tuple[float, float]]()
        for foot in robot.feet:
            frames = [robot.point(foot.replace("foot", name)) for name in ("hip", "knee", "ankle")]
            hip, knee, ankle = (data.oMf[frame].translation for frame in frames)
            self._hips[foot] = hip - com
            self._links[foot] = float(np.linalg.norm(hip - knee)), float(np.linalg.norm(knee - ankle))
            self._ankle_height = float(ankle[2])
        self._limit = MAX_SPEED_SHARE * float(robot.velocity[robot.model.frames[frames[1]].parentJoint - 2])

    def __call__(
        self, foot: str, start: Foothold, place: Foothold, span: float, rise: float, com: Array, heading: float
    ) -> float:
        """The greatest share that a step takes of that speed.

        Args:
            foot: which one steps.
            start, place: from where to where.
            span: in which time [s].
            rise: how high the foot gets [m].
            com: the centre of mass at `SAMPLES` moments of the step (n, 3) [m].
            heading: of the pelvis [rad].
        """
        share = np.linspace(0.0, 1.0, SAMPLES)
        cosine, sine = np.cos(heading), np.sin(heading)
        hip = com + np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]]) @ self._hips[foot]
        way = np.array([place.x - start.x, place.y - start.y, 0.0])
        ankle = np.array([start.x, start.y, self._ankle_height]) + minimum_jerk(share)[:, None] * way
        ankle[:, 2] += rise * bump(share)
        thigh, shank = self._links[foot]
        length = np.minimum(np.linalg.norm(hip - ankle, axis=1), MAX_LENGTH_SHARE * (thigh + shank))
        bend = np.arccos(np.clip((length**2 - thigh**2 - shank**2) / (2.0 * thigh * shank), -1.0, 1.0))
        return float(np.abs(np.diff(bend)).max()) * (SAMPLES - 1) / span / self._limit
