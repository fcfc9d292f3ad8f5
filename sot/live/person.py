"""A new person, calibrated from what comes in the first second: no pose is demanded."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.errors import UnknownSkeletonError
from sot.live.frame import Frame, Skeleton, capture_of
from sot.motion.body.targets import UPPER_BODY_SEGMENTS
from sot.motion.human.calibration import calibrate, canonical_points, upright_frames
from sot.motion.human.capture import Capture
from sot.motion.human.human import SEGMENTS, Human
from sot.motion.human.key_points import KEY_POINTS, LEG_PER_TRUNK, UpperBodyLengths, human_from_key_points
from sot.motion.human.plausibility import check_plausible
from sot.motion.human.skeleton import JointAliases, named_joints

Array = NDArray[np.float64]

CALIBRATION_TIME = 1.0
"""Time from whose frames a person is calibrated [s]."""
MIN_CALIBRATION_FRAMES = 8
"""Least number of frames that a person is calibrated from."""
NOMINAL_RATE = 50.0
"""Rate that a `Human` of a few live frames is said to have [Hz]; nothing here depends on it but what is implausible."""

HumanReader = Callable[[Sequence[Frame]], Human]
"""Frames of a skeleton -> the human in them."""


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
        human_in: makes frames of that skeleton a human.
    """

    leg: float
    arm: float
    breadth: float
    lengths: dict[str, float]
    skeleton: Skeleton
    human_in: HumanReader

    def moment(self, frame: Frame) -> Moment:
        """The person in a frame of the skeleton that was calibrated."""
        human = self.human_in([frame])
        return Moment(
            {name: place[0] for name, place in human.points.items()},
            {body: turn[0] for body, turn in human.frames.items()},
        )


class Acquaintance:
    """Gathers the first frames of a person until it is calibrated.

    Args:
        name: of the source, for errors.
        mapping: names of the joints of an unknown skeleton, as of `named_joints`.
    """

    def __init__(self, name: str, mapping: JointAliases | None = None) -> None:
        self._name, self._mapping = name, mapping
        self._frames: list[Frame] = []

    def add(self, frame: Frame) -> Person | None:
        """The person, once enough was seen of it.

        Raises:
            InputError: the skeleton is not known, or is nobody's; it says what it has and what it lacks.
        """
        if self._frames and self._frames[0].skeleton != frame.skeleton:
            self._frames.clear()
        if not self._frames and not _is_upper_body(frame.skeleton):
            _check_known(capture_of([frame], 1.0, self._name), self._mapping)
        self._frames.append(frame)
        seen = frame.stamp - self._frames[0].stamp
        if seen < CALIBRATION_TIME or len(self._frames) < MIN_CALIBRATION_FRAMES:
            return None
        return _person(self._frames, self._name, self._mapping)


def _check_known(capture: Capture, mapping: JointAliases | None) -> None:
    """Check that the joints of a stream have names that are known; the error says what it has, too."""
    try:
        named_joints(capture, mapping)
    except UnknownSkeletonError as error:
        lacking = f"{error.lacking}; its joints are {', '.join(capture.joints)}"
        raise UnknownSkeletonError(lacking, error.mapping) from None


def _person(frames: Sequence[Frame], name: str, mapping: JointAliases | None) -> Person:
    skeleton = frames[0].skeleton
    if _is_upper_body(skeleton):
        read, measured = _key_point_reader(frames, name), UPPER_BODY_SEGMENTS
    else:
        read, measured = _whole_body_reader(frames, name, mapping), tuple(SEGMENTS)
    human = read(frames)
    check_plausible(human)
    shoulders = human.points["left_shoulder"] - human.points["right_shoulder"]
    lengths = {
        segment: float(np.median(np.linalg.norm(human.points[far] - human.points[near], axis=1)))
        for segment in measured
        if segment != "head"
        for near, far in (SEGMENTS[segment],)
    }
    breadth = float(np.median(np.linalg.norm(shoulders, axis=1)))
    return Person(human.leg, human.arm, breadth, lengths, skeleton, read)


def _whole_body_reader(frames: Sequence[Frame], name: str, mapping: JointAliases | None) -> HumanReader:
    """Reads a skeleton of which the joints' rotations are known, or their positions only."""
    capture = capture_of(frames, NOMINAL_RATE, name)
    joints = named_joints(capture, mapping)
    calibration = calibrate(capture, joints)
    if frames[0].rotations is not None:
        return lambda moments: calibration.human(capture_of(moments, NOMINAL_RATE, name))

    def of_positions(moments: Sequence[Frame]) -> Human:
        positions = np.array([frame.positions for frame in moments])
        points = canonical_points(positions, joints, calibration.chest, calibration.neck)
        trunk = points["neck"] - points["waist"]
        bodies = upright_frames(points, np.arctan2(np.linalg.norm(trunk[:, :2], axis=1), trunk[:, 2]))
        points["head_top"] = points["head"] + calibration.head_height * bodies["head"][:, :, 2]
        return Human(name, NOMINAL_RATE, points, bodies)

    return of_positions


def _key_point_reader(frames: Sequence[Frame], name: str) -> HumanReader:
    """Reads the key points of an upper body; legs that nobody sees are assumed to stand below it."""

    def points_in(moments: Sequence[Frame]) -> dict[str, Array]:
        return {
            point: np.array([frame.positions[frame.skeleton.joints.index(point)] for frame in moments])
            for point in KEY_POINTS
        }

    leg = LEG_PER_TRUNK * UpperBodyLengths.of(points_in(frames)).trunk
    return lambda moments: human_from_key_points(points_in(moments), NOMINAL_RATE, name, leg)


def _is_upper_body(skeleton: Skeleton) -> bool:
    return set(KEY_POINTS) <= set(skeleton.joints) and "left_ankle" not in skeleton.joints
