"""From frames that arrive to a reference that the robot can follow: one step of the pipeline a tick."""

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.live.arm_solver import ArmSolver
from sot.live.body_solver import BodySolver
from sot.live.filters import MomentFilter
from sot.live.frame import Frame, Source
from sot.live.gate import Gate
from sot.live.person import Acquaintance, Moment, Person
from sot.live.placement import MomentTargets, Placement
from sot.live.reference import PERIOD, LiveReference
from sot.live.time_line import TimeLine
from sot.motion.body.limits import Limits
from sot.motion.feet.stance import Build
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

STALE_TIME = 0.2
"""Time without a frame after which the robot eases into its safe posture [s]."""
EASE_OUT_TIME, EASE_IN_TIME = 1.5, 1.0
"""Times in which it goes to the safe posture, and from there to the person [s]."""
MAX_EXTRAPOLATION = 0.0
"""Time for which targets go on as they did beyond the last frame [s]."""
VELOCITY_TIME = 0.02
"""Time constant of the targets' velocity [s]."""


class Follower:
    """A live reference that follows the person whom a source shows.

    Args:
        source: of frames.
        robot: who follows.
        delay: by which everything is played later [s].
    """

    def __init__(self, source: Source, robot: Robot, delay: float = 0.0) -> None:
        self.source, self.robot = source, robot
        self._build, limits = Build.of(robot), Limits.of(robot)
        self.reference = LiveReference(robot, limits)
        self.time_line = TimeLine(delay)
        self.counts: Counter[str] = Counter()
        self._body = BodySolver(robot, self._build, limits)
        arms = [ArmSolver(robot, side, limits) for side in SIDES]
        self._arms = [arm for arm in arms if len(arm.columns)]
        self._acquaintance = Acquaintance(source.name)
        self._person: Person | None = None
        self._placement: Placement
        self._gate: Gate
        self._filter = MomentFilter()
        self._solution = self.reference.rest.copy()
        self._velocity = np.zeros(robot.nv)
        self._last: float | None = None  # due time of the last frame that was used
        self._share = 0.0  # of the way from the safe posture to the person
        self.shown: list[tuple[float, MomentTargets]] = []

    def update(self, now: float) -> None:
        """Take in what has arrived by a time [s], and make the reference up to a period beyond it."""
        for frame in self.source.poll(now):
            self.time_line.add(frame)
        for frame in self.time_line.due(now):
            self._take_in(frame)
        while self.reference.horizon < now + PERIOD - 1e-9:
            self._make_knot(self.reference.horizon)

    def _take_in(self, frame: Frame) -> None:
        self.counts["frames"] += 1
        if not frame.is_finite:
            self.counts["not finite"] += 1
        elif self._person is None or self._person.skeleton != frame.skeleton:
            self._get_to_know(frame)
        else:
            moment, due = self._person.moment(frame), self.time_line.due_time(frame)
            if self._gate.passes(moment, due):
                if self._gate.jumped:
                    self._placement.start_anew()
                    self._filter.start_anew()
                self._follow(self._filter(moment, due), due)
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
            self._acquaintance = Acquaintance(self.source.name)
            self._placement = Placement(self._build, self._person)
            self._gate = Gate(self._person, self.counts)
            self._filter.start_anew()

    def _follow(self, moment: Moment, due: float) -> None:
        targets = self._placement(moment, due)
        self.shown.append((due - self.time_line.delay, targets))
        elapsed = due - self._last if self._last is not None else PERIOD
        y = self._body.solve(targets, self._solution)
        data = self._body.place(y)
        for arm in self._arms:
            y[arm.columns] = arm.solve(data, targets.directions, elapsed, self.reference.now[arm.columns])
        if self._last is None or elapsed > STALE_TIME:
            self._velocity = np.zeros_like(y)
        else:
            share = 1.0 - np.exp(-elapsed / VELOCITY_TIME)
            self._velocity += share * ((y - self._solution) / elapsed - self._velocity)
        self._solution, self._last = y, due

    def _make_knot(self, t: float) -> None:
        """Make the knot after a time [s]."""
        ago = np.inf if self._last is None else t - self._last
        fresh = ago < STALE_TIME
        step = PERIOD / EASE_IN_TIME if fresh else -PERIOD / EASE_OUT_TIME
        self._share = min(max(self._share + step, 0.0), 1.0)
        share = float(minimum_jerk(np.array(self._share)))
        velocity = self._velocity if fresh else np.zeros_like(self._velocity)
        ahead = self._solution + min(max(ago, 0.0), MAX_EXTRAPOLATION) * velocity
        rest = self.reference.rest
        self.reference.advance(rest + share * (ahead - rest), share * velocity)
