"""A new person, calibrated from what comes in the first second: no pose is demanded."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.live.frame import Frame, Skeleton, capture_of
from sot.motion.human.calibration import Calibration, calibrate, canonical_points, upright_frames
from sot.motion.human.human import SEGMENTS, Human
from sot.motion.human.plausibility import check_plausible
from sot.motion.human.skeleton import named_joints

Array = NDArray[np.float64]

CALIBRATION_TIME = 1.0
"""Time from whose frames a person is calibrated [s]."""
MIN_CALIBRATION_FRAMES = 8
"""Least number of frames that a person is calibrated from."""


@dataclass(frozen=True)
class Moment:
    """A person at one time, under canonical names.

    Attributes:
        points: name -> (3,) position in the world [m], as in `Human`.
        frames: pelvis, chest, head -> (3, 3) rotation from body to world.
    """

    points: dict[str, Array]
    frames: dict[str, Array]


@dataclass(frozen=True)
class Person:
    """A calibrated person.

    Attributes:
        leg, arm, breadth: of thigh and shank, of upper arm and forearm, and of the shoulders [m].
        lengths: of the segments that a tracker measures [m].
        skeleton: of the source.
        calibration: of the skeleton's joints.
    """

    leg: float
    arm: float
    breadth: float
    lengths: dict[str, float]
    skeleton: Skeleton
    calibration: Calibration

    def moment(self, frame: Frame) -> Moment:
        """The person in a frame of the skeleton that was calibrated."""
        calibration = self.calibration
        if frame.rotations is None:
            joints = calibration.joints
            points = canonical_points(frame.positions[None], joints, calibration.chest, calibration.neck)
            frames = _frames_of_points(points)
            points["head_top"] = points["head"] + calibration.head_height * frames["head"][:, :, 2]
        else:
            human = calibration.human(capture_of([frame], 1.0, ""))
            points, frames = human.points, human.frames
        return Moment(
            {name: place[0] for name, place in points.items()}, {body: turn[0] for body, turn in frames.items()}
        )


class Acquaintance:
    """Gathers the first frames of a person until it is calibrated.

    Args:
        name: of the source, for errors.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._frames: list[Frame] = []

    def add(self, frame: Frame) -> Person | None:
        """The person, once enough was seen of it.

        Raises:
            InputError: the skeleton is not known, or is nobody's; it says what it has and what it lacks.
        """
        if self._frames and self._frames[0].skeleton != frame.skeleton:
            self._frames.clear()
        if not self._frames:
            named_joints(capture_of([frame], 1.0, self._name))
        self._frames.append(frame)
        seen = frame.stamp - self._frames[0].stamp
        if seen < CALIBRATION_TIME or len(self._frames) < MIN_CALIBRATION_FRAMES:
            return None
        return _person(self._frames, (len(self._frames) - 1) / seen, self._name)


def _person(frames: list[Frame], rate: float, name: str) -> Person:
    capture = capture_of(frames, rate, name)
    joints = named_joints(capture)
    calibration = calibrate(capture, joints)
    if frames[0].rotations is not None:
        human = calibration.human(capture)
    else:
        points = canonical_points(capture.positions, joints, calibration.chest, calibration.neck)
        points["head_top"] = points["head"]
        human = Human(name, rate, points, _frames_of_points(points))
    check_plausible(human)
    shoulders = human.points["left_shoulder"] - human.points["right_shoulder"]
    lengths = {
        segment: float(np.median(np.linalg.norm(human.points[far] - human.points[near], axis=1)))
        for segment, (near, far) in SEGMENTS.items()
        if segment != "head"
    }
    return Person(
        leg=human.leg,
        arm=human.arm,
        breadth=float(np.median(np.linalg.norm(shoulders, axis=1))),
        lengths=lengths,
        skeleton=frames[0].skeleton,
        calibration=calibration,
    )


def _frames_of_points(points: dict[str, Array]) -> dict[str, Array]:
    trunk = points["neck"] - points["waist"]
    tilt = np.arctan2(np.linalg.norm(trunk[:, :2], axis=1), trunk[:, 2])
    return upright_frames(points, tilt)
