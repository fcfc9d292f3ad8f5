"""The fit of a robot's body to a course of human and feet, slower where body or motors cannot follow."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.rounds import BalanceRounds
from sot.motion.balance.torques import overloaded_at_rest, overloaded_knots
from sot.motion.body.coordinates import to_pinocchio
from sot.motion.body.free_feet import DancersFeet
from sot.motion.body.limits import Limits
from sot.motion.body.spline import Spline
from sot.motion.body.targets import Targets, targets_of_human
from sot.motion.body.whole_body import retarget
from sot.motion.feet.climbing.terrain import Terrain
from sot.motion.feet.contacts import Phase, planted_phases
from sot.motion.feet.course import Course, stepping_course, with_clock, with_slides
from sot.motion.feet.footwork import Step
from sot.motion.feet.slides import SlideWay, find_slide
from sot.motion.feet.stance import Build, human_on_time_line
from sot.motion.feet.swing import feet_heading, feet_middle, standing_paths
from sot.motion.feet.tempo import TIME_GRID, clock_from_slowness, slowness_raised
from sot.motion.feet.travel import HIGH_LIFT_LEGS, KEPT_TIME_SHARE
from sot.motion.human.human import Human
from sot.robots.robot import Robot
from sot.smooth import low_passed, minimum_jerk

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

PLAN_RATE = 50.0  # knots per second
SLOWDOWN_FACTOR, MAX_SLOWNESS = 1.3, 3.0  # by which one slowdown slows, and times slower than the dancer in all
MAX_CALMINGS = 1  # times that swings get calmer, beside those that the dance is slowed down
STRAIN_MARGIN = 0.5  # s about a swing, in which what the body cannot follow is taken for its doing
CHANGE_MARGIN = 0.1  # s about a swing that changes, in which the body changes at once
SLOWED = 1.02  # times slower than the dancer: there a robot has no room for the dancer's swings
MIN_LIFT_SHARE = 0.5  # of a high lift that is kept: least share before the dance is slowed down
MIN_FOLLOWED_SWINGS = 0.25  # share of a dance's swings: fewer are not worth the time that planning takes
MAX_FOLLOWED_DELAY = 0.3  # s off the dancer's step: a swing farther off is a plain one
MAX_FOLLOWED_TURN = 1.0  # rad, of a foot: a swing that turns farther is a plain one
MIN_FOLLOWED_TIME_SHARE = 0.6  # of the dancer's time in the air: a shorter swing is a plain one
BOUNCE_FADE_TIME = 0.5  # s before a slide, in which the hips stop bouncing
BOUNCE_HZ = 0.5  # slower motion of the hips is no bounce


@dataclass(frozen=True)
class Fitter:
    """The fit of a robot's body to a course of human and feet; one that is as danced is nowhere slowed down.
    Feet that step do so on a terrain, the floor alone unless it is given."""

    robot: Robot
    build: Build
    limits: Limits
    hip_height_error: float | None
    as_danced: bool = False
    heels: bool = True
    terrain: Terrain | None = None

    def stepping_course(self, human: Human, contacts: Sequence[Step] | None, keep_lifts: bool) -> Course:
        """A course that steps.

        contacts: the steps to make, on the clip's time, instead of those found.
        keep_lifts: whether high lifts are the dancer's, and take as long.
        """
        on_time_line = human_on_time_line(human, PLAN_RATE)
        course = stepping_course(
            on_time_line, self.robot, self.build, contacts, keep_lifts, self.as_danced, self.heels, self.terrain
        )
        return self.with_dancers_swings(course, tuple(map(float, kept_lifts(course))))

    def with_dancers_swings(self, course: Course, shares: tuple[float, ...]) -> Course:
        """The course with feet that swing as the dancer's do; shares: for each step by how much, 0 to 1."""
        if not shares:
            return course
        paths = course.swing_paths
        if paths is None:
            paths = DancersFeet(self.robot, self.build, self.limits, course, self.targets(course)).paths
        return replace(course, feet=paths(shares), swing_shares=shares, swing_paths=paths)

    def targets(self, course: Course) -> Targets:
        moved = feet_middle(course.feet)[0] - feet_middle(standing_paths(planted_phases(self.robot, 1.0)[0], 1))[0]
        facing = feet_heading(course.feet)
        wanted = targets_of_human(course.human, self.robot, self.build, facing, (float(moved[0]), float(moved[1])))
        if course.travel is None:  # legs as straight as the dancer's leave the load on a foot that slides no room
            wanted = replace(wanted, extension={})
        if self.hip_height_error is None:
            return wanted
        return replace(
            wanted, hips=hips_without_bounce_in_slides(wanted.hips, course.phases), height=self.hip_height_error
        )

    def unbalanced_body(self, course: Course) -> tuple[Targets, Spline]:
        """The body's targets, and the motion of a body that meets them, not yet balanced."""
        wanted = self.targets(course)
        return wanted, retarget(self.robot, self.build, wanted, course.feet, self.limits, 1.0 / PLAN_RATE)

    def with_slide(self, course: Course, body_motion: Spline, way: SlideWay) -> Course:
        """The course with a slide where the ZMP of the body's motion allows it best."""
        zmp = Centroidal.along(self.robot, *to_pinocchio(*(body_motion(course.human.times, k) for k in range(3)))).zmp()
        return with_slides(course, self.robot, [find_slide(self.robot, course.phases, zmp, PLAN_RATE, way)])

    def balanced(
        self, course: Course, wanted: Targets, body_motion: Spline, slowdowns: int, fresh: bool, relieved: bool
    ) -> tuple[Course, Spline, bool]:
        """The course, slowed down where body or motors cannot follow, the balanced motion of the body, and whether its
        posture relieves the motors of legs that stand alone.

        slowdowns: times that it is slowed down, or its posture changed to relieve motors, at most.
        fresh: the body is that of `unbalanced_body`.
        relieved: its posture relieves motors already.
        """
        changed, period, moved = None, 1.0 / PLAN_RATE, False
        left = 0 if any(phase.sliding for phase in course.phases) else slowdowns
        calmings = MAX_CALMINGS
        while True:
            rounds = BalanceRounds(
                self.robot, self.build, wanted, course.feet, course.phases, self.limits, body_motion, relieved
            )
            strained_times = rounds.balance_all(fresh) if changed is None else rounds.balance_about(changed, moved)
            body_motion = rounds.body_motion
            if not left:
                break
            hasty, heavy = self.overloaded(course, body_motion)
            if heavy.any() and not relieved:
                changed, relieved, moved, left = heavy, True, False, left - 1
                continue
            slower = np.union1d(strained_times, period * np.flatnonzero(hasty))
            if not len(slower):
                break
            calmer, about = calmer_swings(course, slower)
            if calmings and about.any():
                calmings -= 1
                course, changed, moved = self.with_dancers_swings(course, calmer), about, True
                continue
            if self.as_danced:
                break
            clock = clock_from_slowness(slowness_about(course, slower), period)
            course = self.with_dancers_swings(with_clock(course, self.robot, clock), course.swing_shares)
            body_motion = body_at_clock(body_motion, clock)
            wanted, changed, moved, left = self.targets(course), slowed_knots(clock, period), False, left - 1
        return course, body_motion, relieved

    def with_swings_followed(
        self, course: Course, wanted: Targets, body_motion: Spline, relieved: bool
    ) -> tuple[Course, Spline]:
        """The course with swings that are the dancer's wherever the robot has time for them, and a motion of the body
        near them, not yet balanced. Both are as they were where too few swings can be the dancer's."""
        shares, already = followed_swings(course), course.swing_shares or itertools.repeat(0.0)
        changed = [k for k, (share, before) in enumerate(zip(shares, already, strict=False)) if share != before]
        if len(changed) < MIN_FOLLOWED_SWINGS * len(shares) or not changed:
            return course, body_motion
        course = self.with_dancers_swings(course, shares)
        rounds = BalanceRounds(
            self.robot, self.build, wanted, course.feet, course.phases, self.limits, body_motion, relieved
        )
        rounds.approach(swing_knots(course, changed))
        return course, rounds.body_motion

    def overloaded(self, course: Course, body_motion: Spline) -> tuple[Flags, Flags]:
        """Flags of the knots (T,) at which motors give more than they can, but would not if the body moved slower; and
        of those at which a leg's give more than they can."""
        over, _ = overloaded_knots(self.robot, course.phases, body_motion)
        knots = np.flatnonzero(over.any(axis=1))
        hasty: Flags = np.any(over, axis=1, keepdims=True)[:, 0]
        heavy: Flags = np.any(over[:, list(self.robot.groups["legs"])], axis=1, keepdims=True)[:, 0]
        still = over[knots] & overloaded_at_rest(self.robot, course.phases, body_motion, knots)
        hasty[knots] = np.any(over[knots] & ~still, axis=1)
        return hasty, heavy


def kept_lifts(course: Course) -> tuple[bool, ...]:
    """Which swings are high lifts that keep the dancer's time, where a course keeps them."""
    if course.travel is None or course.travel.climbs or not course.keeps_lifts:
        return ()
    high, travel = HIGH_LIFT_LEGS * course.human.leg, course.travel
    return tuple(
        lift > high and step.land - step.lift >= KEPT_TIME_SHARE * (move.land - move.lift) - TIME_GRID
        for step, move, lift in zip(travel.steps, travel.moves, travel.lifts, strict=True)
    )


def followed_swings(course: Course) -> tuple[float, ...]:
    """How much of each swing may be the dancer's at no price: all, but where the robot steps at another time or much
    faster, turns the foot far, or had to be slowed down; there as much as it is already."""
    if course.travel is None or course.travel.climbs:
        return ()
    stands, shares = {foot: list(own) for foot, own in course.travel.stands.items()}, []
    already = course.swing_shares or (0.0,) * len(course.travel.steps)
    slowed = course.clock[PLAN_RATE * np.gradient(course.clock) > SLOWED]
    for step, move, share in zip(course.travel.steps, course.travel.moves, already, strict=True):
        here, there = stands[step.foot].pop(0), stands[step.foot][0]
        follows = (
            max(abs(step.lift - move.lift), abs(step.land - move.land)) <= MAX_FOLLOWED_DELAY
            and abs(there.heading - here.heading) <= MAX_FOLLOWED_TURN
            and step.land - step.lift >= MIN_FOLLOWED_TIME_SHARE * (move.land - move.lift)
            and not np.any((slowed > step.lift - STRAIN_MARGIN) & (slowed < step.land + STRAIN_MARGIN))
        )
        shares.append(1.0 if follows else share)
    return tuple(shares)


def calmer_swings(course: Course, strained_times: Array) -> tuple[tuple[float, ...], Flags]:
    """How much of each swing of a course is to be the dancer's where the body cannot follow at some times [s], and the
    knots (T,) at which that changes something: amplitude is given up before time, of a high lift that is kept little.
    """
    shares, changed, kept = list(course.swing_shares), [], kept_lifts(course)
    if course.travel is not None and shares:
        for k, step in enumerate(course.travel.steps):
            least = MIN_LIFT_SHARE if kept and kept[k] else 0.0
            inside = (strained_times > step.lift - STRAIN_MARGIN) & (strained_times < step.land + STRAIN_MARGIN)
            if inside.any() and shares[k] > least:
                shares[k] = least
                changed.append(k)
    return tuple(shares), swing_knots(course, changed)


def swing_knots(course: Course, steps: Sequence[int]) -> Flags:
    """Flags of the knots (T,) about the swings of some steps, given by number."""
    times, about = course.human.times, np.zeros(course.human.count, bool)
    if course.travel is not None:
        for step in (course.travel.steps[k] for k in steps):
            about |= (times > step.lift - CHANGE_MARGIN) & (times < step.land + CHANGE_MARGIN)
    return about


def slowness_about(course: Course, strained_times: Array) -> Array:
    """The slowness (T,) of a course's frames with more time near the times `strained_times` (m,) [s]."""
    times = course.human.times
    already = np.interp(times, course.clock, PLAN_RATE * np.gradient(course.clock))
    most = np.maximum(1.0, MAX_SLOWNESS / np.maximum(already, 1.0))
    return slowness_raised(np.ones(len(times)), times, strained_times.tolist(), SLOWDOWN_FACTOR, most)


def slowed_knots(clock: Array, period: float) -> Flags:
    """Flags of the knots, of a motion played at the times (T,) of a clock, at which it is played slower."""
    times = np.arange(round(clock[-1] / period) + 1) * period
    late = np.interp(times, clock, clock - period * np.arange(len(clock)))
    flags: Flags = np.gradient(late) > 1e-9
    return flags


def body_at_clock(body_motion: Spline, clock: Array) -> Spline:
    """The motion of a body that does at the times (T,) of a clock what it did at its knots."""
    times = np.arange(round(clock[-1] / body_motion.period) + 1) * body_motion.period
    y = body_motion(np.interp(times, clock, body_motion.period * np.arange(len(clock))))
    slow = Spline.through(y, body_motion.period)
    slow.control[:3], slow.control[-3:] = y[0], y[-1]  # at rest
    return slow


def hips_without_bounce_in_slides(hips: Array, phases: Sequence[Phase]) -> Array:
    """The hips (T, 3) without their bounce where a foot slides, whose load has to be light and steady [m]."""
    times = np.arange(len(hips)) / PLAN_RATE
    share = np.zeros(len(hips))
    for phase in phases:
        if phase.sliding:
            inside = np.minimum(times - phase.start, phase.end - times)
            share = np.maximum(share, minimum_jerk(1.0 + inside / BOUNCE_FADE_TIME))
    calm = hips.copy()
    calm[:, 2] += share * (low_passed(hips[:, 2], PLAN_RATE, BOUNCE_HZ) - hips[:, 2])
    return calm
