"""A clip as eight key points in the robot's size, over its standing feet."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.interpolate import CubicSpline

from scenarios.inputs.clips import find_clip
from sot.motion import Human, read, recognise
from sot.motion.feet.stance import LEAD_IN_TIME, Build, human_on_time_line, human_over_feet
from sot.motion.human.human import SIDES
from sot.motion.human.key_points import KEY_POINTS, UpperBodyLengths, key_points_of
from sot.motion.plan import CAPTURE_NOISE_HZ
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk
from tasks.resolved.points import PointsSample

Array = np.ndarray

RATE = 100.0
"""Rate of the papers' reference and control [Hz]."""
MAX_LEG_REACH_SHARE = 0.97
"""Share of the legs' length up to which hips are asked for: a human's stretched legs are out of the robot's reach."""


@dataclass(frozen=True)
class ClipPart:
    """A part of a clip.

    Args:
        clip: A name of a clip, or a file.
        start, duration: Of the part [s]; to the clip's end if there is no duration.
    """

    clip: str
    start: float = 0.0
    duration: float | None = None

    @property
    def label(self) -> str:
        """Its name in tables."""
        name = self.clip.split("/")[-1].removesuffix(".bvh").removeprefix("lafan1_")
        return f"{name} {self.start:g} s" if self.start else name

    def human(self) -> Human:
        """The human of this part."""
        return recognise(read(find_clip(self.clip))).slice(self.start, self.duration)


@dataclass(frozen=True)
class KeyPointReference:
    """Key points over time, with their rates.

    Attributes:
        times: (T,) at RATE [s].
        positions, velocities, accelerations: name -> (T, 3) in the robot's world [m, m/s, m/s²].
    """

    times: Array
    positions: dict[str, Array]
    velocities: dict[str, Array]
    accelerations: dict[str, Array]

    def of(self, names: tuple[str, ...]) -> "SampledPoints":
        """Of some of the points, as `ResolvedPoints` takes it."""
        return SampledPoints(
            *(
                np.stack([part[name] for name in names], axis=1)
                for part in (self.positions, self.velocities, self.accelerations)
            )
        )

    @staticmethod
    def through(times: Array, positions: dict[str, Array]) -> "KeyPointReference":
        """Cubic splines through positions at times."""
        splines = {name: CubicSpline(times, place) for name, place in positions.items()}
        return KeyPointReference(
            times, *({name: spline(times, order) for name, spline in splines.items()} for order in range(3))
        )


@dataclass(frozen=True)
class SampledPoints:
    """Samples at RATE, shapes (T, n, 3); held beyond the last one."""

    positions: Array
    velocities: Array
    accelerations: Array

    def __call__(self, t: float) -> PointsSample:
        k = min(round(t * RATE), len(self.positions) - 1)
        return PointsSample(self.positions[k], self.velocities[k], self.accelerations[k])


def key_point_reference(human: Human, robot: Robot) -> KeyPointReference:
    """The human's key points in the robot's lengths, over its standing feet, led in from the robot's rest.

    The waist is where the human's legs, scaled to the robot's, put it, but no further from an ankle than the robot's
    legs reach with a knee that is not quite straight.
    """
    build = Build.of(robot)
    human = human_on_time_line(human_over_feet(human.low_passed(CAPTURE_NOISE_HZ), build), RATE)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    rest = {name: data.oMf[robot.point(name)].translation.copy() for name in KEY_POINTS}
    points = key_points_of(human)
    waist = points["waist"] - build.hips
    lowered = waist.copy()
    for side in SIDES:
        hip, ankle = (data.oMf[robot.point(f"{side}_{joint}")].translation for joint in ("hip", "ankle"))
        reach = MAX_LEG_REACH_SHARE * build.leg
        across = np.linalg.norm(waist[:, :2] + (hip - rest["waist"])[:2] - ankle[:2], axis=1)
        highest = ankle[2] + np.sqrt(np.maximum(reach**2 - across**2, 0.0)) - (hip - rest["waist"])[2]
        lowered[:, 2] = np.minimum(lowered[:, 2], highest)
    scaled = UpperBodyLengths.of(rest).applied_to(
        {name: place + (lowered - points["waist"]) for name, place in points.items()}
    )
    lead = minimum_jerk(human.times / LEAD_IN_TIME)[:, None]
    return KeyPointReference.through(
        human.times, {name: (1.0 - lead) * rest[name] + lead * place for name, place in scaled.items()}
    )
