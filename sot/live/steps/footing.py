"""Feet that step as a person does who steps now: which step is made when and where, and the swing to it."""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.behaviours.stride import Stride
from sot.control.pose import Pose
from sot.gravity import GRAVITY
from sot.live.steps.foot_sense import wrapped
from sot.live.steps.leg_momentum import zmp_shift_of_swing
from sot.live.steps.person_steps import AskedStep
from sot.live.steps.preview import KNOT_PERIOD, StepPreview, first_knot_from
from sot.live.steps.reachable import MAX_SWING_ACCELERATION_G, foothold_between, live_reach
from sot.live.steps.step_place import StepPlace
from sot.live.steps.step_plan import (
    DecidedStep,
    Rooms,
    StandingPoses,
    foothold_of,
    rooms_at,
    swing_shift,
    zmp_wishes,
)
from sot.motion.feet.contacts import Phase, planted_phases
from sot.motion.feet.footwork import MIN_STEP_LENGTH, MIN_STEP_TURN, Foothold
from sot.motion.feet.swing import feet_at_rest, foot_pose
from sot.motion.feet.tempo import MAX_STEP_DELAY
from sot.motion.feet.travel import OMISSIBLE_LENGTH_LEGS
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot
from sot.smooth import MINIMUM_JERK_PEAK_SPEED, minimum_jerk

Array = NDArray[np.float64]

MIN_SWING_TIME, MAX_SWING_TIME, MIN_DOUBLE_SUPPORT_TIME = 1.39, 2.5, 0.55
"""Least and greatest time of a step, and least time between two, in √(height of the centre of mass / g)."""
MIN_TIME_BEFORE_SAME_FOOT = 1.1
"""The same before the foot that has landed steps again: the body, on its way to it, has to turn back."""
COMMITMENT_TIME = 0.08
"""Time before its lift from which on a step is made whatever comes [s]: its load is given away meanwhile."""
FREEZE_TIME = 0.1
"""Time before its landing from which on a foot goes where it goes [s]."""
ACCEPTED_PLAN_EXCESS = 0.001
"""Distance of the zero-moment point beyond its room with which a step may be decided [m]."""
MAX_PLAN_EXCESS = 0.02
"""The same with which a decided step, not yet begun, is put off [m]."""
MAX_BACKLOG_TIME = 2.1
"""Time by which the robot is late at most before it leaves out steps that later ones have made needless, in √(height of
the centre of mass / g)."""
MAX_TRIALS = 8
"""Times of a lift that are tried, KNOT_PERIOD apart, before the step waits for the next plan."""
REDIRECTED_PARTS = (1.0, 0.5, 0.25)
"""Parts of a change of a foothold that are tried, before the foot goes on to where it was led."""
MIN_REDIRECTION = 0.002
"""Change of a foothold that a swing is led elsewhere for [m, rad]."""


class SteppingFooting:
    """A `sot.live.footing.Footing` whose feet step.

    Args:
        robot: who steps.

    Attributes:
        asked: the person's steps that the robot has not decided on yet.
        planned_at: when the centre of mass was planned last [s].
        made: the steps that are over.
        begun: called with foot, lift and landing time [s] of each step that is going to be made.
        aloft: the feet that do not stand, as far as that is measured.
        is_disturbed: whether the robot is off its plan by more than a step should begin with.
    """

    def __init__(self, robot: Robot) -> None:
        (self.start,) = planted_phases(robot, np.inf)
        self._robot, self._rest, self.reach = robot, feet_at_rest(robot), live_reach(robot)
        data = robot.model.createData()
        com = pin.centerOfMass(robot.model, data, robot.rest).copy()
        pin.framesForwardKinematics(robot.model, data, robot.rest)
        hips = np.mean([data.oMf[robot.point(f"{side}_hip")].translation for side in SIDES], axis=0)
        self._zmp_shift, self._places = zmp_shift_of_swing(robot), StepPlace(robot, self.reach)
        self._preview = StepPreview(com[:2], float(com[2]), self._zmp_shift.along)
        self._rooms = Rooms(robot, self.reach, (hips - com)[:2])
        self._standing, self._landed = StandingPoses(robot), StandingPoses(robot)
        self._time, self._height = float(np.sqrt(com[2] / GRAVITY)), float(com[2])
        self.stands = {foot: foothold_of(self.start.feet[foot], self._rest[foot]) for foot in robot.feet}
        self.asked: deque[AskedStep] = deque()
        self.made: list[DecidedStep] = []
        self.begun: list[Callable[[str, float, float], object]] = []
        self.aloft, self.is_disturbed = set[str](), False
        self._steps: list[DecidedStep] = []
        self._stride: Stride | None = None
        self._strides: dict[str, Stride] = {}
        self._last: DecidedStep | None = None
        self._landed_at = dict.fromkeys(robot.feet, -np.inf)
        self._phases = [self.start]
        self.planned_at, self.excess = -np.inf, 0.0
        self.room = self._rooms(self.stands).inside

    @property
    def scale(self) -> float:
        """Lengths of the robot over the person's."""
        return self._places.scale

    def meet(self, scale: float) -> None:
        """Get ready for a new person, of whose lengths the robot's are a share."""
        self._places.scale = scale
        self.asked.clear()

    def face(self, stands: Mapping[str, Foothold]) -> float:
        """Let the person face as the robot does now; the turn from the one to the other [rad]."""
        headings = [np.mean([np.exp(1j * at.heading) for at in feet.values()]) for feet in (self.stands, stands)]
        self._places.turn = float(np.angle(headings[0] / headings[1]))
        return self._places.turn

    def mean_heading(self, near: float) -> float:
        """The mean heading of the feet, unwrapped to be near an angle [rad]."""
        return near + wrapped(float(np.angle(np.sum([np.exp(1j * at.heading) for at in self.stands.values()]))) - near)

    @property
    def com(self) -> Array:
        """See `Footing`."""
        return np.stack([self._preview.c, self._preview.dc, self._preview.ddc])

    @property
    def com_ahead(self) -> tuple[Array, Array]:
        """Times from the last plan on (n,) [s], and where the centre of mass will be then (n, 2) [m]."""
        return self._preview.times, self._preview.places

    def places_ahead(self, foot: str) -> Array:
        """Where a foot is over the floor at the times of `com_ahead` (n, 2) [m]."""
        times = self.planned_at + self._preview.times
        at = np.tile((self.stands[foot].x, self.stands[foot].y), (len(times), 1))
        for step in self._steps:
            if step.foot == foot:
                way = np.array([step.place.x - step.start.x, step.place.y - step.start.y])
                at += minimum_jerk((times - step.lift) / (step.land - step.lift))[:, None] * way
        return at

    def foothold(self, foot: str, t: float) -> Array:
        """See `Footing`; during a swing, the nearest in time."""
        step = self._steps[0] if self._stride is not None else None
        lands = step is not None and step.foot == foot and 2.0 * t > step.lift + step.land
        standing = self._landed if step and lands else self._standing
        return standing(foot, step.place if step and lands else self.stands[foot]).position

    def phases(self, end: float) -> tuple[Phase, ...]:
        """See `Footing`."""
        starts = [phase.start for phase in self._phases]
        return tuple(
            Phase(phase.start, min(until, end), phase.feet)
            for phase, until in zip(self._phases, [*starts[1:], end], strict=True)
            if phase.start < end
        )

    def poses(self, t: float) -> Mapping[str, Pose]:
        """See `Footing`."""
        return {foot: self.path(foot)(t) for foot in self._robot.feet}

    def path(self, foot: str) -> Callable[[float], Pose]:
        """Where a foot is to be at a time [s]."""
        return lambda t: self._pose(foot, t)

    def _pose(self, foot: str, t: float) -> Pose:
        still = self._standing(foot, self.stands[foot])
        step = self._steps[0] if self._steps else None
        if self._stride is not None and step is not None and step.foot == foot and t > step.lift:
            pose = self._stride(t)
            low = still.position[2]
            if pose.position[2] >= low:
                return pose
            up = np.array([1.0, 1.0, 0.0, 1.0, 1.0, 1.0])
            return Pose(np.append(pose.position[:2], low), pose.rotation, up * pose.velocity, up * pose.acceleration)
        return still

    def swing_path(self, foot: str) -> Callable[[float], Pose]:
        """Where a foot is to be at a time [s] while its contact is off: it looks for the floor where that is late."""

        def at(t: float) -> Pose:
            stride = self._strides.get(foot)
            return stride(t) if stride is not None else self._pose(foot, t)

        return at

    def advance(
        self, t: float, period: float, wanted: Array, future: Sequence[tuple[float, Array]], height: float
    ) -> Array:
        """See `Footing`."""
        if t > self.planned_at + KNOT_PERIOD - 1e-6:
            self.planned_at, self._height = t, height
            self._plan(t, wanted, future)
        (room,), _ = rooms_at(np.array([t + period]), self.stands, self._steps, self._rooms)
        self.room = room.inside
        preview = self._preview
        place, rate = preview.c, preview.dc
        preview.advance(period, t - self.planned_at)
        return np.stack([place, rate, preview.ddc])

    def _plan(self, t: float, wanted: Array, future: Sequence[tuple[float, Array]]) -> None:
        self._land(t)
        if self._steps and self._stride is not None:
            self._redirect(t, wanted, future)
        self._catch_up(t)
        if self.is_disturbed or (self.aloft and self._stride is None):
            self._undecide()
        else:
            self._decide(t, wanted, future)
        if self._has_decided:
            self._put_off_or_begin(t, wanted, future)
        jerk, self.excess = self._solved(t, self._steps, wanted, future)
        self._preview.follow(jerk)

    def _solved(
        self, t: float, steps: Sequence[DecidedStep], wanted: Array, future: Sequence[tuple[float, Array]]
    ) -> tuple[Array, float]:
        """The plan of the centre of mass with some steps."""
        times = t + self._preview.times
        rooms, last = rooms_at(times, self.stands, steps, self._rooms)
        end = self._rooms(last)
        wish = zmp_wishes(rooms, wanted - self._rooms(self.stands).centre, self._preview.times, future)
        shifts = [swing_shift(step, self._places.rise(step), times, self._zmp_shift) for step in steps]
        swings = np.sum(shifts, axis=0) if shifts else np.zeros((len(times), 2))
        return self._preview.solve(rooms, wish, end, swings)

    def _land(self, t: float) -> None:
        """Let a swing that is over be over, once its foot stands: what follows waits for that."""
        if self._stride is None or t < self._steps[0].land - 1e-6:
            return
        step = self._steps[0]
        if step.foot in self.aloft:
            more = t + KNOT_PERIOD - step.stands
            step.late += more
            for later in self._steps[1:]:
                later.put_off(more)
            return
        self._steps.pop(0)
        self.stands[step.foot] = step.place
        self._last = step
        self.made.append(step)
        self._landed_at[step.foot] = step.stands
        self._stride = None
        self._phases.append(self._phase(step.stands, dict(self.stands)))

    def _phase(self, start: float, stands: Mapping[str, Foothold]) -> Phase:
        return Phase(start, np.inf, {foot: foot_pose(at, self._rest[foot]) for foot, at in stands.items()})

    def _catch_up(self, t: float) -> None:
        """Ask for another step where a person's foot has landed elsewhere than was expected when the robot's did."""
        last = self._last
        if last is None or not last.asked.has_landed or self._steps or self.asked:
            return
        asked, aimed = last.asked, last.aimed
        moved = float(np.hypot(asked.place.x - aimed.x, asked.place.y - aimed.y)) * self.scale
        turned = abs(wrapped(asked.place.heading - aimed.heading))
        if moved > MIN_STEP_LENGTH[1] * self.reach.leg_length or turned > MIN_STEP_TURN:
            self.asked.append(replace(asked, lift=t, land=t, start=aimed, height=0.0))
            self._last = None

    def _redirect(self, t: float, wanted: Array, future: Sequence[tuple[float, Array]]) -> None:
        """Lead the foot in the air to where its step is expected to end by now, as far as it and the balance can."""
        step = self._steps[0]
        if t > step.land - FREEZE_TIME:
            return
        before, aimed, accepted = step.place, step.aimed, max(ACCEPTED_PLAN_EXCESS, self.excess)
        place = self._places(step, self._beside(step))
        for part in REDIRECTED_PARTS:
            step.place, step.aimed = (
                foothold_between(before, place, part),
                foothold_between(aimed, step.asked.place, part),
            )
            moved = max(abs(step.place.x - before.x), abs(step.place.y - before.y))
            if max(moved, abs(step.place.heading - before.heading)) < MIN_REDIRECTION:
                step.place = before
                return
            if self._can_be_led(step, t) and self._solved(t, self._steps, wanted, future)[1] < accepted:
                self._lead(step, t)
                return
        step.place, step.aimed = before, aimed

    def _can_be_led(self, step: DecidedStep, t: float) -> bool:
        """Whether the foot in the air gets to where its step is to end as fast as feet may go."""
        assert self._stride is not None
        pose = foot_pose(step.place, self._rest[step.foot])
        speed, acceleration = self._stride.peak_rates(t, pose.translation[:2], step.place.heading - step.start.heading)
        most = MINIMUM_JERK_PEAK_SPEED * self.reach.turn_speed
        return acceleration < MAX_SWING_ACCELERATION_G * GRAVITY and speed < most

    def _lead(self, step: DecidedStep, t: float) -> None:
        assert self._stride is not None
        pose = foot_pose(step.place, self._rest[step.foot])
        self._stride.redirect(t, pose.translation[:2], step.place.heading - step.start.heading)

    def _beside(self, step: DecidedStep) -> Foothold:
        """Where the other foot stands during a step."""
        other = next(foot for foot in self.stands if foot != step.foot)
        before = [one for one in self._steps if one.foot == other and one.lift < step.lift]
        return before[-1].place if before else self.stands[other]

    def _com_at(self, times: Array) -> Array:
        """Where the last plan has the centre of mass at times (n,) [s], as high as it is now (n, 3) [m]."""
        later, places = times - (self.planned_at - KNOT_PERIOD), self._preview.places
        x, y = (np.interp(later, self._preview.times, column) for column in places.T)
        return np.column_stack([x, y, np.full(len(times), self._height)])

    def _decide(self, t: float, wanted: Array, future: Sequence[tuple[float, Array]]) -> None:
        """Decide on the next step of the person, if there is time for it."""
        if not self.asked or len(self._steps) > 1 or (self._steps and self._stride is None):
            return
        while self.asked and self._is_omissible(self.asked[0], t):
            self.asked.popleft()
        if not self.asked:
            return
        if t > self.asked[0].lift + MAX_BACKLOG_TIME * self._time:
            self._leave_out_superseded()
        asked = self.asked[0]
        if self._steps and self._steps[0].foot == asked.foot:
            return
        before = self._steps[0].stands if self._steps else max(self._landed_at.values())
        again = not self._steps and self._landed_at[asked.foot] == before
        pause = (MIN_TIME_BEFORE_SAME_FOOT if again else MIN_DOUBLE_SUPPORT_TIME) * self._time
        first = first_knot_from(max(asked.lift, t + COMMITMENT_TIME + KNOT_PERIOD, before + pause))
        for trial in range(MAX_TRIALS):
            step = self._step(asked, first + trial * KNOT_PERIOD)
            _, excess = self._solved(t, [*self._steps, step], wanted, future)
            if excess < ACCEPTED_PLAN_EXCESS:
                self.asked.popleft()
                self._steps.append(step)
                return

    def _is_omissible(self, asked: AskedStep, t: float) -> bool:
        """Whether a step that is late is small enough to be left out."""
        way = self.scale * float(np.hypot(asked.place.x - asked.start.x, asked.place.y - asked.start.y))
        small = way < OMISSIBLE_LENGTH_LEGS * self.reach.leg_length
        turned = abs(wrapped(asked.place.heading - asked.start.heading))
        return asked.has_landed and t > asked.lift + MAX_STEP_DELAY and small and turned < MIN_STEP_TURN

    def _leave_out_superseded(self) -> None:
        """Leave out each foot's first steps where both feet have landed elsewhere since: the robot is far behind."""
        feet = [asked.foot for asked in self.asked]
        while len(set(feet)) > 1 and min(feet.count(foot) for foot in set(feet)) > 1:
            feet.remove(self.asked.popleft().foot)

    def _step(self, asked: AskedStep, lift: float) -> DecidedStep:
        least, most = MIN_SWING_TIME * self._time, MAX_SWING_TIME * self._time
        start = self.stands[asked.foot]
        step = DecidedStep(asked.foot, lift, lift, start, start, asked, asked.place)
        span = float(np.clip(asked.land - lift, least, most))
        step.land = first_knot_from(lift + span)
        step.place = self._places(step, self._beside(step))
        return step

    def _put_off_or_begin(self, t: float, wanted: Array, future: Sequence[tuple[float, Array]]) -> None:
        """Begin the step that comes next once it is time, or think it over if no balance leads through it any more."""
        step = self._steps[-1]
        if t > step.lift - COMMITMENT_TIME + 1e-6 and self._stride is None:
            self._shorten(step, t, wanted, future)
            self._begin(step)
            return
        before, place = step.place, self._places(step, self._beside(step))
        accepted = max(ACCEPTED_PLAN_EXCESS, self.excess)
        for part in (*REDIRECTED_PARTS, 0.0):
            step.place = self._places.reachable(step, self._beside(step), foothold_between(before, place, part))
            excess = self._solved(t, self._steps, wanted, future)[1]
            if excess < accepted:
                return
        if excess > MAX_PLAN_EXCESS:
            self._undecide()

    @property
    def _has_decided(self) -> bool:
        """Whether a step is decided that has not begun."""
        return len(self._steps) > (0 if self._stride is None else 1)

    def _undecide(self) -> None:
        """Let a step that is decided and has not begun be one of those to be thought about, if there is one."""
        if self._has_decided:
            self.asked.appendleft(self._steps.pop().asked)

    def _shorten(self, step: DecidedStep, t: float, wanted: Array, future: Sequence[tuple[float, Array]]) -> None:
        """Let a step be as long as its knee is fast, if balance leads through it then, too."""
        long = step.part, step.place
        self._places.shorten(step, self._beside(step), self._com_at)
        if self._solved(t, self._steps, wanted, future)[1] > max(ACCEPTED_PLAN_EXCESS, self.excess):
            step.part, step.place = long

    def _begin(self, step: DecidedStep) -> None:
        pose = foot_pose(step.start, self._rest[step.foot])
        self._stride = Stride(pose.translation, pose.rotation, step.lift, step.land, self._places.rise(step))
        self._strides[step.foot] = self._stride
        self._lead(step, step.lift)
        self._phases.append(self._phase(step.lift, {foot: at for foot, at in self.stands.items() if foot != step.foot}))
        for tell in self.begun:
            tell(step.foot, step.lift, step.land)
