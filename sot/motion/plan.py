"""From a human's motion to a robot's that it can do: retarget, balance, sample."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.rounds import Rounds
from sot.motion.body.coordinates import to_pinocchio
from sot.motion.body.kinematics import Chains, Kinematics
from sot.motion.body.limits import Limits
from sot.motion.body.spline import Spline
from sot.motion.body.targets import Targets, key_points, targets
from sot.motion.body.whole_body import limbs_fitted, retarget
from sot.motion.feet.contacts import Phase, planted
from sot.motion.feet.course import Course, go, slid, slowed_down, stay
from sot.motion.feet.flight import Flight, flights, remark
from sot.motion.feet.footwork import Step
from sot.motion.feet.slides import Way, find_slide
from sot.motion.feet.stance import LEAD, TAIL, Build, on_time_line, over_feet
from sot.motion.feet.support import supports
from sot.motion.feet.swing import facing, moving
from sot.motion.feet.tempo import clock_of, slowed
from sot.motion.feet.travel import Travel
from sot.motion.human.human import Human
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.smooth import low_passed, minimum_jerk

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

FEET = ("auto", "steps", "planted")
PLAN_RATE = 50.0  # knots per second
MENDS, LAST_MENDS = 4, 2  # most times that a body gets more time where it cannot follow, before and after its arms
MEND, SLOWEST = 1.3, 3.0  # how much more time, and how many times slower than the dancer at most
REFIT_STEPS = 4  # Gauss-Newton steps of head and arms once the body is balanced: fewer leave a hand in the head
CALMING, BOUNCE_HZ = 0.5, 0.5  # s before a slide, in which hips stop to bounce; slower than this is no bounce
NOISE_HZ = 6.0  # faster than this, a capture is noise


@dataclass(frozen=True)
class Plan:
    """A robot motion and the human it follows.

    Attributes:
        motion: what the robot shall do.
        human: the human in the robot's size and place, on the motion's time line, at PLAN_RATE.
        start, end: the part of the motion that shows the clip [s]; before, the lead-in from rest; after, rest.
        retarget: figures of the report: "key_point_rms_m", the reference's key points against those of the human in
            the robot's size, limb by limb, over the clip; "frames_per_s", clip frames retargeted per second.
        clock: (n,) the motion's time at the clip's frames at PLAN_RATE [s]: it runs slower than the dancer's where the
            robot needs more time.
        travel: steps and footholds, of feet that may step.
        flights: of the dancer; the robot has a foot on the floor all the time.
        seconds: time that planning took, by step.
        imitation: the body that looks like the human, joint limits kept, before anything of it is balanced or slowed
            down; coordinates of `sot.motion.body.coordinates` at PLAN_RATE. `sampled` makes a motion of it, which no
            robot can do.
    """

    motion: Motion
    human: Human
    start: float
    end: float
    clock: Array
    travel: Travel | None
    flights: tuple[Flight, ...]
    retarget: dict[str, float]
    seconds: dict[str, float]
    imitation: Spline

    @property
    def speed_min(self) -> float:
        """The slowest that the clip is played at, over the dancer's own speed."""
        return float(1.0 / max(1.0, PLAN_RATE * np.diff(self.clock).max()))

    @property
    def remarks(self) -> list[str]:
        """What the robot does otherwise than the dancer, a sentence each."""
        return [remark(self.flights, self.travel is not None)] if self.flights else []

    @property
    def stretched(self) -> float:
        """Time that slowing down adds [s]."""
        added = self.end - self.start - (len(self.clock) - 1) / PLAN_RATE
        return max(0.0, round(added, 9))  # sums of periods: nothing is not always nothing


def plan(
    human: Human,
    robot: Robot,
    feet: str = "planted",
    rate: float = 1000.0,
    contacts: Sequence[Step] | None = None,
    slide: Way | None = None,
    height: float | None = None,
) -> Plan:
    """The motion with which a robot dances like a human.

    Args:
        human: a clip, or the part of one to dance.
        robot: who dances.
        feet: "planted", both soles where the rest posture puts them; "steps", where and when the dancer steps;
            "auto", planted if the dancer's feet never really move.
        contacts: the steps to make, in the clip's time, instead of those found in it; none may be planted.
        rate: samples per second of the motion [Hz].
        slide: the way of a slide to put in where the dancer stands on one foot most, see `slides.find_slide`; feet
            have to be planted.
        height: error of the hips' height that is accepted for a smoother motion of a robot whose feet are planted [m]:
            the smaller, the more of what the dancer's knees swing is kept, but for while a foot slides.

    Raises:
        InputError: another kind of `feet`, contacts for planted ones, or a slide for others or in too short a clip.
    """
    if feet not in FEET:
        raise InputError(f"feet '{feet}' are not known: choose one of {', '.join(FEET)}")
    if contacts is not None and feet == "planted":
        raise InputError("planted feet make no steps: leave the contacts out, or choose steps")
    if (slide is not None or height is not None) and feet != "planted":
        raise InputError("only planted feet slide, and let the hips bounce: choose them, or leave slide and height out")
    supports(robot, planted(robot, 1.0))  # compiles what it needs, once an installation: that is no planning
    begun = time.perf_counter()
    fit = _Fit(robot, Build.of(robot), Limits.of(robot), height)
    smooth = human.low_passed(NOISE_HZ)
    course = None if feet == "planted" else fit.go(smooth, contacts)
    if course is None or (feet == "auto" and contacts is None and len(course.phases) == 1):
        course = stay(on_time_line(over_feet(smooth, fit.build), PLAN_RATE), robot)
    wanted, imitation = fit.looks(course)
    if slide is not None:
        course = fit.slid(course, imitation, slide)
        wanted, imitation = fit.looks(course)
    retargeted = time.perf_counter()
    course, whole = fit.feasible(course, wanted, imitation, MENDS, rough=True)
    whole = limbs_fitted(robot, fit.targets(course), fit.limits, whole, REFIT_STEPS)  # the chest has moved
    course, whole = fit.feasible(course, fit.targets(course), whole, LAST_MENDS)
    wanted = fit.targets(course)
    motion = sampled(robot, whole, course.phases, rate)
    start, end = round(LEAD * PLAN_RATE), len(course.clock) - 1 - round(TAIL * PLAN_RATE)
    span = slice(round(course.clock[start] * PLAN_RATE), round(course.clock[end] * PLAN_RATE) + 1)
    figures = {
        "key_point_rms_m": _key_point_rms(robot, wanted, whole, span),
        "frames_per_s": human.count / (retargeted - begun),
    }
    ended = time.perf_counter()
    return Plan(
        motion=motion,
        human=course.human,
        start=float(course.clock[start]),
        end=float(course.clock[end]),
        clock=course.clock[start : end + 1],
        travel=course.travel,
        flights=flights(on_time_line(smooth, PLAN_RATE)),
        retarget=figures,
        seconds={"retarget": retargeted - begun, "balance": ended - retargeted, "total": ended - begun},
        imitation=imitation,
    )


@dataclass(frozen=True)
class _Fit:
    """What a course of feet and human is fitted with."""

    robot: Robot
    build: Build
    limits: Limits
    height: float | None

    def go(self, human: Human, contacts: Sequence[Step] | None) -> Course:
        """A course that steps; contacts: the steps to make, on the clip's time, instead of those found."""
        return go(on_time_line(human, PLAN_RATE), self.robot, self.build, contacts)

    def targets(self, course: Course) -> Targets:
        wanted = targets(course.human, self.robot, self.build, facing(course.feet))
        if self.height is None:
            return wanted
        return replace(wanted, hips=calmed(wanted.hips, course.phases), height=self.height)

    def looks(self, course: Course) -> tuple[Targets, Spline]:
        """The body's targets, and a body that meets them, nothing of it balanced yet."""
        wanted = self.targets(course)
        return wanted, retarget(self.robot, self.build, wanted, course.feet, self.limits, 1.0 / PLAN_RATE)

    def slid(self, course: Course, whole: Spline, way: Way) -> Course:
        """The same course with a slide where the body, as it looks, has its ZMP."""
        zmp = Centroidal.along(self.robot, *to_pinocchio(*(whole(course.human.times, k) for k in range(3)))).zmp()
        return slid(course, self.robot, [find_slide(self.robot, course.phases, zmp, PLAN_RATE, way)])

    def feasible(
        self, course: Course, wanted: Targets, whole: Spline, mends: int, rough: bool = False
    ) -> tuple[Course, Spline]:
        """The body balanced, and the course slowed down, so many times at most, where it cannot follow its feet.

        rough: the body is fresh from `looks`.
        """
        changed = None
        for left in range(mends if course.travel and moving(course.feet) else 0, -1, -1):
            rounds = Rounds(self.robot, self.build, wanted, course.feet, course.phases, self.limits, whole)
            hasty = rounds.everywhere(rough) if changed is None else rounds.about(changed)
            whole = rounds.whole
            if not left or not len(hasty):
                break
            clock = clock_of(slower(course, hasty), 1.0 / PLAN_RATE)
            course, whole = slowed_down(course, self.robot, clock), played(whole, clock)
            wanted, changed = self.targets(course), stretched(clock, 1.0 / PLAN_RATE)
        return course, whole


def slower(course: Course, hasty: Array) -> Array:
    """How many times slower (T,) the frames of a course should be to have more time about some times (m,) [s]."""
    times = course.human.times
    already = np.interp(times, course.clock, PLAN_RATE * np.gradient(course.clock))
    most = np.maximum(1.0, SLOWEST / np.maximum(already, 1.0))
    return slowed(np.ones(len(times)), times, hasty.tolist(), MEND, most)


def stretched(clock: Array, period: float) -> Flags:
    """At which of the knots of what is played at the times (T,) of a clock it is played slower."""
    times = np.arange(round(clock[-1] / period) + 1) * period
    late = np.interp(times, clock, clock - period * np.arange(len(clock)))
    flags: Flags = np.gradient(late) > 1e-9
    return flags


def played(whole: Spline, clock: Array) -> Spline:
    """A body that does at the times (T,) of a clock what it did at its knots."""
    times = np.arange(round(clock[-1] / whole.period) + 1) * whole.period
    y = whole(np.interp(times, clock, whole.period * np.arange(len(clock))))
    slow = Spline.through(y, whole.period)
    slow.control[:3], slow.control[-3:] = y[0], y[-1]  # at rest
    return slow


def calmed(hips: Array, phases: Sequence[Phase]) -> Array:
    """The hips (T, 3) without their bounce where a foot slides: its load has to be light, and steady."""
    times = np.arange(len(hips)) / PLAN_RATE
    share = np.zeros(len(hips))
    for phase in phases:
        if phase.sliding:
            inside = np.minimum(times - phase.start, phase.end - times)
            share = np.maximum(share, minimum_jerk(1.0 + inside / CALMING))
    calm = hips.copy()
    calm[:, 2] += share * (low_passed(hips[:, 2], PLAN_RATE, BOUNCE_HZ) - hips[:, 2])
    return calm


def sampled(robot: Robot, spline: Spline, phases: tuple[Phase, ...], rate: float) -> Motion:
    """The motion at a rate [Hz], with the ZMP that its whole-body dynamics needs."""
    times = np.arange(round(spline.duration * rate) + 1) / rate
    q, v, a = to_pinocchio(*(spline(times, derivative) for derivative in range(3)))
    state = Centroidal.along(robot, q, v, a)
    return Motion(
        robot=robot,
        rate=rate,
        q=q,
        v=v,
        a=a,
        com=state.com,
        com_velocity=state.velocity,
        com_acceleration=state.acceleration,
        zmp=state.zmp(),
        momentum=state.momentum[:, 3:],
        phases=phases,
    )


def _key_point_rms(robot: Robot, wanted: Targets, reference: Spline, clip: slice) -> float:
    """Root mean square distance, over the clip, from the reference's key points to those of the human in the robot's
    size (see `key_points`), both relative to the waist [m]."""
    kinematics = Kinematics(Chains(robot), reference.knots[clip])
    _, waist = kinematics.frame(robot.point("waist"))
    offsets = [
        kinematics.frame(robot.point(name))[1] - waist - place[clip]
        for name, place in key_points(wanted, robot).items()
    ]
    return float(np.sqrt(np.mean(np.sum(np.square(offsets), axis=2))))
