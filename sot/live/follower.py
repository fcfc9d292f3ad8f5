"""From frames that arrive to a reference that the robot can follow: one step of the pipeline a tick."""

from collections import Counter, deque
from dataclasses import dataclass
from math import nan
from time import perf_counter

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.errors import InputError
from sot.live.arm_solver import ArmSolver
from sot.live.body_solver import BodySolver
from sot.live.frame import Frame, Source
from sot.live.person import Acquaintance, Moment, Person
from sot.live.placement import MomentTargets, Placement
from sot.live.reference import PERIOD, FutureTarget, LiveReference
from sot.live.sensing.gate import Gate
from sot.live.sensing.one_euro import MomentFilter
from sot.live.sensing.time_line import TimeLine
from sot.live.state import pinocchio_state
from sot.motion.body.limits import Limits
from sot.motion.feet.stance import Build
from sot.motion.human.human import SIDES
from sot.motion.human.skeleton import JointAliases
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

STALE_TIME = 0.2
"""Time without a frame after which the robot eases into its safe posture [s]."""
EASE_OUT_TIME, EASE_IN_TIME = 1.5, 1.0
"""Times in which it goes to the safe posture, and from there to the person [s]."""
REPLY_PERIOD = 0.01
"""Time between joint targets for those who have asked for them [s]."""
VELOCITY_TIME = 0.02
"""Time constant of the targets' velocity [s]."""
REORDERING_TIME = 0.1
"""Part of a delay in which reordered frames find their place [s]; the rest of it is future that is known."""


@dataclass(frozen=True)
class Target:
    """What a frame asks for when it is due [s]: coordinates y and velocity (nv,), with the CoM at a place (2,)."""

    due: float
    y: Array
    velocity: Array
    com: Array


@dataclass
class FrameTimes:
    """When a frame passed the stages of its way.

    Attributes:
        t: of the run when it was taken in [s].
        age: since the person was there, when it arrived [s].
        taken, filtered, solved: of the wall clock [s].
    """

    t: float
    age: float
    taken: float
    filtered: float = nan
    solved: float = nan


class Follower:
    """A live reference that follows the person whom a source shows.

    Args:
        source: of frames.
        robot: who follows.
        delay: by which everything is played later [s]; the motion is planned with the future that this buys.
        start: what the source's clock shows when the run begins [s].
        mapping: names of the joints of an unknown skeleton, as of `sot.motion.human.skeleton.named_joints`.

    Attributes:
        reference: what the robot shall do.
        time_line: of the frames.
        counts: what befell the frames.
        shown: when the person is played, in the time of the run [s], and as what in the robot's size.
        frame_times: of each frame that was followed.
        held_s: time without a frame to follow, once there had been one [s].
    """

    def __init__(
        self,
        source: Source,
        robot: Robot,
        delay: float = 0.0,
        start: float = 0.0,
        mapping: JointAliases | None = None,
    ) -> None:
        self.source, self.robot, self._start, self._mapping = source, robot, start, mapping
        self._build, limits = Build.of(robot), Limits.of(robot)
        self._foresight = max(delay - REORDERING_TIME, 0.0)
        self.reference = self._new_reference(robot, limits)
        self.time_line = TimeLine(delay)
        self.counts: Counter[str] = Counter()
        self._body = BodySolver(robot, self._build, self._target_limits(limits))
        arms = [ArmSolver(robot, side, limits) for side in SIDES]
        self._arms = [arm for arm in arms if len(arm.columns)]
        self._acquaintance = Acquaintance(source.name, mapping)
        self._person: Person | None = None
        self._placement: Placement
        self._gate: Gate
        self._filter = MomentFilter()
        self._solution = self.reference.rest.copy()
        self._velocity = np.zeros(robot.nv)
        self._last: float | None = None  # due time of the last frame that was solved
        self._target: Target | None = None
        self._future: deque[Target] = deque()
        self._share = 0.0  # of the way from the safe posture to the person
        self.shown: list[tuple[float, MomentTargets]] = []
        self.frame_times: list[FrameTimes] = []
        self.held_s = 0.0
        self._next_reply = 0.0

    def update(self, t: float) -> None:
        """Take in what has arrived by a time [s] of the run, and make the reference up to it."""
        now = t + self._start
        for frame in self.source.poll(now):
            self.time_line.add(frame)
        due = self.time_line.due(now + self._foresight)
        self.counts["skipped"] += max(0, len(due) - 1)  # many at once: the last is where the person is now
        for frame in due[-1:]:
            self._take_in(frame, t)
        self._take_due(t)
        while self.reference.horizon < t - 1e-9:
            self._make_knot(self.reference.horizon)
        if t >= self._next_reply:
            self.source.reply(now, self.reference.joints(t)[0])
            self._next_reply = t + REPLY_PERIOD

    def _new_reference(self, robot: Robot, limits: Limits) -> LiveReference:
        """The reference that is fed."""
        return LiveReference(robot, limits, self._foresight)

    def _target_limits(self, limits: Limits) -> Limits:
        """Limits of the coordinates of targets."""
        return limits

    def _tilted_less(self, y: Array) -> Array:
        """Coordinates (nv,) with as much of the pelvis' tilt as the robot is to make."""
        return y

    def _take_due(self, t: float) -> None:
        """Go over to the targets that are due by a time [s]."""
        while self._future and self._future[0].due <= t + 1e-9:
            self._target = self._future.popleft()

    def _take_in(self, frame: Frame, t: float) -> None:
        self.counts["frames"] += 1
        self._stages = FrameTimes(t, self.time_line.age(frame, frame.received), perf_counter())
        if not frame.is_finite:
            self.counts["not finite"] += 1
        elif self._person is None or self._person.skeleton != frame.skeleton:
            self._get_to_know(frame)
        else:
            moment, due = self._person.moment(frame), self.time_line.due_time(frame) - self._start
            if self._gate.passes(moment, due):
                if self._gate.jumped:
                    self._start_anew()
                    self._filter.start_anew()
                moment = self._filter(moment, due)
                self._stages.filtered = perf_counter()
                self._follow(moment, due)
                self._stages.solved = perf_counter()
                self.frame_times.append(self._stages)
            elif self._gate.is_stranger:
                self._person = None

    def _get_to_know(self, frame: Frame) -> None:
        """Calibrate a new person; only the first one may be refused with an error."""
        try:
            self._person = self._acquaintance.add(frame)
        except InputError:
            if not self.counts["persons"]:
                raise
            self.counts["unknown skeleton"] += 1
            return
        if self._person is not None:
            self.counts["persons"] += 1
            self._acquaintance = Acquaintance(self.source.name, self._mapping)
            self._meet(self._person)
            self._gate = Gate(self._person, self.counts)
            self._filter.start_anew()

    def _meet(self, person: Person) -> None:
        """Get ready for a new person."""
        self._placement = Placement(self._build, person)

    def _start_anew(self) -> None:
        """Forget where the person was: it is somewhere else now."""
        self._placement.start_anew()

    def _follow(self, moment: Moment, due: float) -> None:
        """Follow a person at a time that may be yet to come [s]."""
        self._future.append(self._solved(self._placement(moment, due), due))

    def _solved(self, targets: MomentTargets, due: float) -> Target:
        """What the robot shall do for targets at a time [s], not before those of earlier calls."""
        self.shown.append((due, targets))
        elapsed = due - self._last if self._last is not None else PERIOD
        y = self._body.solve(targets, self._solution)
        # What the trunk will be late when the frame is due is head's and arms' to make up; with a future it is not.
        asked = self._tilted_less(y)
        start = asked if self.reference.foresight else self.reference.expected(asked, due)
        head = self._body.head_columns
        y[head] = self._body.solve_head(targets, start)[head]
        data = self._body.place(start)
        for arm in self._arms:
            y[arm.columns] = arm.solve(data, targets.directions, elapsed, start[arm.columns])
        if self._last is None or elapsed > STALE_TIME:
            self._velocity = np.zeros_like(y)
        else:
            share = 1.0 - np.exp(-elapsed / VELOCITY_TIME)
            self._velocity += share * ((y - self._solution) / elapsed - self._velocity)
        self._solution, self._last = y, due
        com = pin.centerOfMass(self.robot.model, self._body.data, pinocchio_state(y, y, y)[0])[:2].copy()
        return Target(due, self._tilted_less(y), self._velocity.copy(), com)

    @property
    def _rest(self) -> Array:
        """Coordinates (nv,) of the safe posture."""
        return self.reference.rest

    def _make_knot(self, t: float) -> None:
        """Make the knot after a time [s]."""
        target = self._target
        fresh = target is not None and t - target.due < STALE_TIME
        if target is not None and not fresh:
            self.held_s += PERIOD
        step = PERIOD / EASE_IN_TIME if fresh else -PERIOD / EASE_OUT_TIME
        self._share = min(max(self._share + step, 0.0), 1.0)
        if target is not None and self._share == 1.0:  # the safe posture has no part in it
            future = [FutureTarget(one.due - t, one.y, one.com - target.com) for one in self._future]
            self.reference.advance(target.y, target.velocity, future)
            return
        share, rest = float(minimum_jerk(np.array(self._share))), self._rest
        if target is None:
            self.reference.advance(rest, np.zeros_like(rest))
            return
        velocity = share * target.velocity if fresh else np.zeros_like(rest)
        future = [
            FutureTarget(later.due - t, rest + share * (later.y - rest), share * (later.com - target.com))
            for later in self._future
        ]
        self.reference.advance(rest + share * (target.y - rest), velocity, future)
