"""Whom the robot follows: the human in a clip, or a robot's motion that another retargeter made."""

from pathlib import Path
from typing import Protocol

from scenarios.inputs import clips
from sot.errors import InputError
from sot.exchange.registry import read_motion, readable_format
from sot.exchange.robot_as_human import human_of_robot
from sot.exchange.robot_motion import RobotMotion
from sot.motion import Human, read, recognise
from sot.motion.quality import motion_quality
from sot.robots.robot import Robot


class DancerRequest(Protocol):
    """What a request says of whom to follow; the attributes are those of `scenarios.replay.Replay`."""

    @property
    def clip(self) -> str: ...
    @property
    def from_format(self) -> str | None: ...
    @property
    def fps(self) -> float | None: ...
    @property
    def mapping(self) -> Path | None: ...
    @property
    def up(self) -> str | None: ...
    @property
    def forward(self) -> str | None: ...
    @property
    def unit(self) -> str | None: ...
    @property
    def start(self) -> float: ...
    @property
    def duration(self) -> float | None: ...


def requested_human(request: DancerRequest, robot: Robot) -> Human:
    """The human that a robot is to follow.

    Raises:
        InputError: a clip or motion that cannot be read, or nothing of it lies in the part that is asked for.
    """
    if request.from_format:
        human = human_of_robot(robot_motion(request, robot))
    else:
        capture = read(clips.find_clip(request.clip), request.up, request.forward, request.unit)
        human = recognise(capture, request.mapping)
    if request.start or request.duration is not None:
        return human.slice(request.start, request.duration)
    return human


def incoming_quality(request: DancerRequest, robot: Robot) -> dict[str, float | None]:
    """How good a robot's motion is that was asked for, by `sot.motion.quality`; nothing of a human's clip.

    Raises:
        InputError: the motion cannot be read.
    """
    if not request.from_format:
        return {}
    part = robot_motion(request, robot).part(request.start, request.duration)
    return dict(motion_quality(robot, part.q, part.rate))


def check_format(request: DancerRequest) -> None:
    """Check that a request says of a human's file, or of a robot's motion, only what is of that kind.

    Raises:
        InputError: it does not, or there is no such format to read.
    """
    if request.from_format is None:
        if request.fps is not None:
            raise InputError("--fps is the frame rate of a robot's motion: name its format with --from")
        return
    readable_format(request.from_format)
    told = {name: getattr(request, name) for name in ("mapping", "up", "forward", "unit")}
    if given := [f"--{name}" for name, value in told.items() if value is not None]:
        raise InputError(f"{', '.join(given)}: of a human's clip, and {request.from_format} holds a robot's motion")


def robot_motion(request: DancerRequest, robot: Robot) -> RobotMotion:
    """The robot's motion that a request names, all of it.

    Raises:
        InputError: it cannot be read.
    """
    assert request.from_format is not None
    return read_motion(Path(request.clip), request.from_format, robot, request.fps)
