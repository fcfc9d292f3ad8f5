"""A live run: a source, a robot that follows it under physics, and what is written of it."""

import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, sleep
from types import FrameType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenarios.inputs import clips
from scenarios.live.live_stack import live_stack
from scenarios.live.record import live_figures, record_of
from scenarios.replay import Dance, ProgressCallback, check_writable, make_solver, write_outputs
from sim.log import RunInfo
from sim.loop import run
from sim.mismatch import NO_MISMATCH, Mismatch
from sim.push import Push
from sim.world import World
from sot.control.controller import Controller, compile_ticks
from sot.errors import InputError
from sot.live.clip_source import ClipSource
from sot.live.follower import Follower
from sot.live.frame import Source
from sot.live.sensing.key_point_source import KeyPointSource
from sot.live.steps.follower import SteppingFollower
from sot.live.steps.schedule import LiveSteppingSchedule
from sot.live.streams.address import StreamAddress
from sot.motion import read
from sot.motion.human.key_points import parse_key_points
from sot.motion.human.skeleton import JointAliases
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Viewer = Callable[[float, Array, Follower], object]
"""Told the time [s] and the robot's configuration (nq,) each tick."""

CLIP_RATE = 50.0
"""Frames a second that a clip is played with [Hz]."""
TIME_AFTER_CLIP = 2.5
"""Time after the end of a clip, in which the robot eases to its safe posture [s]."""
WAIT_TIME = 60.0
"""Time for which the first frame of a stream is waited for [s]."""
COMPILING_STEP = 0.01
"""Time between the moments that are followed only to compile what that takes [s]."""
COMPILING_CLIPS = {"planted": "groove", "steps": "walk_turns"}
COMPILING_TIME = {"planted": 1.5, "steps": 4.0}
"""By the feet, the clip that is followed for that, and for how long [s]: until it has been met, or has stepped."""
FEET_MODES = ("planted", "steps")
POLL_PERIOD = 0.005
"""Time between looks for it [s]."""


@dataclass(frozen=True)
class LiveRequest:
    """Request to follow a source.

    Attributes:
        source: a clip, or the address of a stream.
        robot, solver, rate, pushes, mismatch: as of `scenarios.replay.Replay`.
        delay: by which everything is played later [s].
        duration: of the run [s]; to the end of a clip, or until interrupted, by default.
        bind: address of the interface to listen at, None for this machine alone.
        token: that frames of udp:// have to carry.
        points: the key points to which the person is reduced, as a list; all that comes by default.
        feet: one of FEET_MODES: "planted", they stay; "steps", they step as the person does.
        mapping: names of the joints of an unknown skeleton, as of `sot.motion.human.skeleton.named_joints`.
        keeps_time: whether it runs by the wall clock; otherwise the stream's time is that of the simulation, which
            however slow a machine does not change.
    """

    source: str
    robot: str = "hrp2"
    solver: str = "cascade"
    rate: float = 500.0
    delay: float = 0.0
    duration: float | None = None
    bind: str | None = None
    token: str = ""
    pushes: tuple[Push, ...] = ()
    mismatch: Mismatch = NO_MISMATCH
    points: str = ""
    feet: str = "planted"
    mapping: JointAliases | None = None
    keeps_time: bool = True


class LiveCompanion:
    """Goes along with the ticks of a run: feeds the reference, keeps the wall clock's time, shows, and ends it.

    Args:
        follower: whose reference is fed.
        end: of the run [s], infinite if only an interrupt ends it.
        mapping: names of the joints of an unknown skeleton, as of `sot.motion.human.skeleton.named_joints`.
        keeps_time: whether ticks wait for the wall clock.
        viewer: told of each tick.
    """

    def __init__(self, follower: Follower, end: float, keeps_time: bool, viewer: Viewer | None = None) -> None:
        self._follower, self._end, self._keeps_time, self._viewer = follower, end, keeps_time, viewer
        self.waited_s = 0.0
        self.is_interrupted = False
        self._began: float | None = None
        self._behind: list[float] = []

    @property
    def behind(self) -> Array:
        """How far each tick was behind the wall clock when it began [s], (T,)."""
        return np.array(self._behind)

    def tick_begins(self, t: float, q: Array, v: Array) -> bool:
        """Wait for the tick's time, and bring the reference up to it; whether the run goes on."""
        if self._keeps_time:
            now = perf_counter()
            self._began = now if self._began is None else self._began
            early = self._began + t - now
            self._behind.append(max(-early, 0.0))
            if early > 0.0:
                sleep(early)
                self.waited_s += perf_counter() - now
        self._follower.update(t)
        if self._viewer is not None:
            self._viewer(t, q, self._follower)
        if self._follower.source.ended:
            self._end = min(self._end, t + TIME_AFTER_CLIP)
        return t < self._end and not self.is_interrupted

    def command_given(self, t: float, torque: Array) -> None:
        """Nothing to do."""

    def interrupt(self, number: int, frame: FrameType | None) -> None:
        """End the run with the next tick."""
        self.is_interrupted = True


def live(request: LiveRequest, out: Path, tell: ProgressCallback, viewer: Viewer | None = None) -> dict[str, Any]:
    """Follow a source, record and report; the files appear in the folder `out` when all is done.

    Returns:
        The report.

    Raises:
        InputError: anything in the request that does not fit, or a stream that shows nobody; nothing is written then.
    """
    check_writable(out)
    make_solver(request.solver)
    if request.feet not in FEET_MODES:
        raise InputError(f"unknown feet '{request.feet}': choose one of {', '.join(FEET_MODES)}")
    robot = Robot.load(request.robot)
    source = open_source(request, robot)
    try:
        return follow(request, source, robot, out, tell, viewer)
    finally:
        source.close()


def open_source(request: LiveRequest, robot: Robot) -> Source:
    """The source that a request names.

    Raises:
        InputError: there is none, or nothing can listen there.
    """
    names = parse_key_points(request.points) if request.points else ()
    source: Source
    if StreamAddress.is_one(request.source):
        source = StreamAddress.parse(request.source).open(request.bind, request.token, robot.joints)
    elif request.bind is not None or request.token:
        raise InputError(f"{request.source} is a clip: --bind and --token are for streams")
    else:
        source = ClipSource(read(clips.find_clip(request.source)), CLIP_RATE)
    return KeyPointSource(source, names, request.mapping) if names else source


def follow(
    request: LiveRequest,
    source: Source,
    robot: Robot,
    out: Path,
    tell: ProgressCallback,
    viewer: Viewer | None = None,
) -> dict[str, Any]:
    """Follow an open source; see `live`."""
    _compile(robot, request.feet, tell)
    is_stream = StreamAddress.is_one(request.source)
    start = _first_frame_time(source, tell) if request.keeps_time and is_stream else 0.0
    follower = _follower(request.feet, source, robot, request.delay, start, request.mapping)
    end = np.inf if request.duration is None else request.duration
    companion = LiveCompanion(follower, end, request.keeps_time, viewer)
    controller = _controller(robot, follower, request.solver, 1.0 / request.rate)
    world = World(robot, 1.0 / request.rate, request.mismatch, request.pushes)
    before = signal.signal(signal.SIGINT, companion.interrupt)
    try:
        done = run(controller, world, follower.reference, lambda t: tell(f"following, {t:.0f} s", None), companion)
    finally:
        signal.signal(signal.SIGINT, before)
    motion = follower.reference.recorded(done.log.ticks / request.rate, request.rate)
    record = record_of(follower, motion)
    info = RunInfo(
        clip=request.source if is_stream else Path(request.source).stem,
        robot=robot.name,
        solver=request.solver,
        feet=request.feet,
        rate_hz=request.rate,
        fell_at_s=done.fell_at_s,
        reason=done.reason,
        mismatch=request.mismatch,
        pushes=request.pushes,
    )
    figures = live_figures(follower, done.log.trimmed(), record, companion.behind)
    return write_outputs(Dance(done, info, motion, record), out, tell, {"live": figures})


def _first_frame_time(source: Source, tell: ProgressCallback) -> float:
    """Wait for a stream's first frame; the time that the source's clock then shows [s].

    Raises:
        InputError: none comes.
    """
    tell(f"waiting for frames at {source.name}", None)
    began = perf_counter()
    while not source.poll(perf_counter() - began):
        sleep(POLL_PERIOD)
        if perf_counter() - began > WAIT_TIME:
            dropped = ", ".join(f"{count} dropped as '{reason}'" for reason, count in source.counts.items())
            raise InputError(f"{source.name}: no frame within {WAIT_TIME:.0f} s{': ' if dropped else ''}{dropped}")
    return perf_counter() - began


def _follower(
    feet: str,
    source: Source,
    robot: Robot,
    delay: float = 0.0,
    start: float = 0.0,
    mapping: JointAliases | None = None,
) -> Follower:
    return (SteppingFollower if feet == "steps" else Follower)(source, robot, delay, start, mapping)


def _controller(robot: Robot, follower: Follower, solver: str, period: float) -> Controller:
    """A controller that follows, its contacts led by the steps that are decided on if the feet step."""
    if not isinstance(follower, SteppingFollower):
        return Controller(robot, live_stack(robot, follower.reference), make_solver(solver), period)
    footing = follower.footing
    stack = live_stack(robot, follower.reference, {foot: footing.swing_path(foot) for foot in robot.feet})
    return Controller(
        robot, stack, make_solver(solver), period, LiveSteppingSchedule(robot, follower.reference, footing)
    )


def _compile(robot: Robot, feet: str, tell: ProgressCallback) -> None:
    """Compile what a tick and a frame need, in a run of their own: nobody waits for it then."""
    tell("starting (the first time on a machine this compiles, for half a minute)", None)
    clip = read(clips.find_clip(COMPILING_CLIPS[feet]))
    follower = _follower(feet, ClipSource(clip, CLIP_RATE), robot)
    controller = _controller(robot, follower, "cascade", COMPILING_STEP)
    for k in range(round(COMPILING_TIME[feet] / COMPILING_STEP)):
        t = k * COMPILING_STEP
        follower.update(t)
        state = follower.reference.sample(t)
        if feet == "steps":
            controller(t, state.q, state.v)
    compile_ticks(controller, t + COMPILING_STEP, state.q)
