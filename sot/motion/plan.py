"""The plan of a dance, from a human's motion to one that the robot can do: retarget, balance, sample."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.strain import Shortfall, shortfall_remark, shortfalls
from sot.motion.balance.torques import (
    Overload,
    overload_remark,
    overloads,
)
from sot.motion.body.coordinates import to_pinocchio
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.lean import LeanCut, lean_cut, lean_remark
from sot.motion.body.limits import MAX_LEG_EXTENSION_STEPPING, Limits
from sot.motion.body.spline import Spline
from sot.motion.body.targets import Targets, key_points
from sot.motion.body.whole_body import fit_limbs
from sot.motion.feet.climbing.terrain import Terrain
from sot.motion.feet.contacts import Phase, planted_phases
from sot.motion.feet.course import Course, standing_course
from sot.motion.feet.flight import Flight, find_flights, flight_remark
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import Step
from sot.motion.feet.slides import SlideWay
from sot.motion.feet.stance import LEAD_IN_TIME, TAIL_TIME, Build, human_on_time_line, human_over_feet
from sot.motion.feet.support import supports
from sot.motion.feet.swing import mean_ground
from sot.motion.feet.travel import Travel, climb_remarks
from sot.motion.fitter import PLAN_RATE as PLAN_RATE
from sot.motion.fitter import Fitter
from sot.motion.human.human import Human
from sot.motion.likeness import hip_heading
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.surface import Surface

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

FEET_MODES = ("auto", "dancer", "steps", "planted")
MAX_SLOWDOWNS, MAX_FINAL_SLOWDOWNS = 4, 2  # times that a body gets more time, before and after its arms are fitted
MAX_FOOT_ERROR_LEGS = 0.1  # leg lengths: a foot that is planned so far off its place makes the robot fall
LIMB_REFIT_STEPS = 4  # Gauss-Newton steps of head and arms once the body is balanced: fewer leave a hand in the head
CAPTURE_NOISE_HZ = 6.0  # faster motion of a capture is noise

LimbFit = Callable[[Array, Targets, Limits, Spline], Spline]
"""A body's motion whose limbs do something else than the human's, from the motion's time at the clip's frames (n,) at
PLAN_RATE [s], the body's targets, its limits, and its motion until then."""


class UnreachableFeetError(InputError):
    """No motion comes near what a clip asks of the feet."""


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
        heading: (n,) which way the dancer faces at those frames, in the clip [rad].
        travel: steps and footholds, of feet that may step.
        flights: of the dancer; the robot has a foot on the floor all the time.
        seconds: time that planning took, by step.
        shortfalls: where the motion's feet or balance are not as planned, in motion time.
        overloads: joints whose torque would be beyond their effort.
        lean_cut: how much less the trunk leans than the dancer's; None where it is next to nothing.
        imitation: the body that looks like the human, joint limits kept, before anything of it is balanced or slowed
            down; coordinates of `sot.motion.body.coordinates` at PLAN_RATE. `sampled_motion` makes one of it, which no
            robot can do.
    """

    motion: Motion
    human: Human
    start: float
    end: float
    clock: Array
    heading: Array
    travel: Travel | None
    flights: tuple[Flight, ...]
    retarget: dict[str, float]
    seconds: dict[str, float]
    imitation: Spline
    shortfalls: tuple[Shortfall, ...] = ()
    overloads: tuple[Overload, ...] = ()
    lean_cut: LeanCut | None = None

    @property
    def speed_min(self) -> float:
        """The slowest speed at which the clip is played, over the dancer's own."""
        return float(1.0 / max(1.0, PLAN_RATE * np.diff(self.clock).max()))

    @property
    def remarks(self) -> list[str]:
        """What the robot does otherwise than the dancer, a sentence each."""
        told = climb_remarks(self.human.remarks, self.travel)
        if self.flights:
            told.append(flight_remark(self.flights, self.travel is not None))
        if self.lean_cut:
            told.append(lean_remark(self.lean_cut, lambda t: _clip_time(self.clock, t)))
        if self.shortfalls:
            told.append(shortfall_remark(self.shortfalls, lambda t: _clip_time(self.clock, t)))
        if self.overloads:
            told.append(overload_remark(self.overloads))
        return told

    @property
    def added_time(self) -> float:
        """Time that slowing down adds [s]."""
        added = self.end - self.start - (len(self.clock) - 1) / PLAN_RATE
        return max(0.0, round(added, 9))  # sums of periods: nothing is not always nothing


def plan(
    human: Human,
    robot: Robot,
    feet: str = "planted",
    rate: float = 1000.0,
    contacts: Sequence[Step] | None = None,
    slide: SlideWay | None = None,
    height: float | None = None,
    limbs: LimbFit | None = None,
    as_danced: bool = False,
    heels: bool = True,
    treads: Sequence[Surface] = (),
) -> Plan:
    """The motion with which a robot dances like a human.

    Args:
        human: a clip, or the part of one to dance.
        robot: who dances.
        feet: "planted", both soles where the rest posture puts them; "steps", where and when the dancer steps;
            "auto" and "dancer", planted if the dancer's feet never really move, and in the air on the dancer's way
            where that takes no more time; high lifts keep the dancer's time by "dancer", which may slow others down.
        contacts: the steps to make, in the clip's time, instead of those found in it; none may be planted.
        rate: samples per second of the motion [Hz].
        slide: the way of a slide to put in where the dancer stands on one foot most, see `slides.find_slide`; feet
            have to be planted.
        height: error of the hips' height that is accepted for a smoother motion of a robot whose feet are planted [m]:
            the smaller, the more of what the dancer's knees swing is kept, but for while a foot slides.
        limbs: fits limbs that do something else than the human's, before the body is balanced with them and after.
        as_danced: whether the dancer's time and way are kept, with nothing slowed down or shortened; physics has to
            judge what becomes of it.
        heels: whether heels of feet that are left behind may rise before they leave the floor: who plays the motion
            has to know of `Phase.rising`.
        treads: surfaces of the world above the floor, level or sloping, on which feet that step may step, too.

    Raises:
        InputError: another kind of `feet`, contacts for planted ones, or a slide for others or in too short a clip; or
            no motion comes near what the clip asks of the feet.
    """
    try:
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            asked = rate, contacts, slide, height, limbs, as_danced, heels, treads
            once = partial(_plan, human, robot, feet, *asked)
            planned = _with_lifts_kept(once) if feet == "dancer" else once(keep_lifts=False)
        if np.isfinite(planned.motion.q).all() and np.isfinite(planned.motion.a).all():
            return planned
    except np.linalg.LinAlgError:
        pass
    raise InputError(
        f"{human.name}: no motion of {robot.label} was found for it, numbers grow beyond all bounds: choose another"
        " part with --start and --duration, or --feet planted"
    )


def imitation(human: Human, robot: Robot, rate: float = 1000.0) -> Motion:
    """The motion of a robot on planted feet that looks like a human, within the joints' limits; nothing balances it.

    It begins with the lead-in from rest, and is meant for a controller that leads the centre of mass by itself.

    Args:
        human: The clip.
        robot: Who imitates it.
        rate: Samples per second of the motion [Hz].
    """
    fit = Fitter(robot, Build.of(robot), Limits.of(robot), None)
    smooth = human.low_passed(CAPTURE_NOISE_HZ)
    course = standing_course(human_on_time_line(human_over_feet(smooth, fit.build), PLAN_RATE), robot)
    _, body_motion = fit.unbalanced_body(course)
    return sampled_motion(robot, body_motion, course.phases, rate)


def _with_lifts_kept(once: Callable[..., Plan]) -> Plan:
    """The plan in which high lifts keep the dancer's time; without, where that one falls short of anything."""
    kept = None
    try:
        kept = once(keep_lifts=True)
        if not kept.shortfalls:
            return kept
    except UnreachableFeetError:
        pass
    other = once(keep_lifts=False)
    return other if kept is None or len(other.shortfalls) < len(kept.shortfalls) else kept


def _plan(
    human: Human,
    robot: Robot,
    feet: str,
    rate: float,
    contacts: Sequence[Step] | None,
    slide: SlideWay | None,
    height: float | None,
    limbs: LimbFit | None,
    as_danced: bool,
    heels: bool,
    treads: Sequence[Surface],
    keep_lifts: bool,
) -> Plan:
    if feet not in FEET_MODES:
        raise InputError(f"feet '{feet}' are not known: choose one of {', '.join(FEET_MODES)}")
    if contacts is not None and feet == "planted":
        raise InputError("planted feet make no steps: leave the contacts out, or choose steps")
    if (slide is not None or height is not None) and feet != "planted":
        raise InputError("only planted feet slide, and let the hips bounce: choose them, or leave slide and height out")
    if treads and feet == "planted":
        raise InputError("planted feet step on no tread: choose steps, or leave the treads out")
    terrain = Terrain(treads, LegReach.of(robot)) if treads else None
    supports(robot, planted_phases(robot, 1.0))  # compiles what it needs, once an installation: that is no planning
    begun = time.perf_counter()
    limits = Limits.of(robot, MAX_LEG_EXTENSION_STEPPING)
    fit = Fitter(robot, Build.of(robot), limits, height, as_danced, heels, terrain)
    smooth = human.low_passed(CAPTURE_NOISE_HZ)
    course = None if feet == "planted" else fit.stepping_course(smooth, contacts, keep_lifts)
    if course is None or (feet in ("auto", "dancer") and contacts is None and len(course.phases) == 1):
        fit = replace(fit, limits=Limits.of(robot))
        course = standing_course(human_on_time_line(human_over_feet(smooth, fit.build), PLAN_RATE), robot)
    wanted, imitation = fit.unbalanced_body(course)
    if slide is not None:
        course = fit.with_slide(course, imitation, slide)
        wanted, imitation = fit.unbalanced_body(course)
    retargeted = time.perf_counter()
    course, body_motion, relieved = fit.balanced(course, wanted, imitation, MAX_SLOWDOWNS, fresh=True, relieved=False)
    plain, plain_motion = course, body_motion
    if feet in ("auto", "dancer"):
        course, body_motion = fit.with_swings_followed(course, fit.targets(course), body_motion, relieved)
    tries = course is not plain
    course, body_motion = _finished(fit, course, body_motion, relieved, limbs)
    if tries and course.clock[-1] > plain.clock[-1]:  # the dancer's swings are worth no time
        plain, plain_motion = _finished(fit, plain, plain_motion, relieved, limbs)
        if plain.clock[-1] < course.clock[-1]:
            course, body_motion = plain, plain_motion
    wanted = fit.targets(course)
    if limbs is not None:
        body_motion = limbs(_shown(course.clock), wanted, fit.limits, body_motion)
    short = shortfalls(robot, course.feet, supports(robot, course.phases), body_motion)
    start, end = round(LEAD_IN_TIME * PLAN_RATE), len(course.clock) - 1 - round(TAIL_TIME * PLAN_RATE)
    span = slice(round(course.clock[start] * PLAN_RATE), round(course.clock[end] * PLAN_RATE) + 1)
    for one in short:
        if not one.foot < MAX_FOOT_ERROR_LEGS * fit.build.leg:
            first, last = (_clip_time(_shown(course.clock), t) for t in (one.start, one.end))
            raise UnreachableFeetError(
                f"{robot.label} cannot dance this clip from {first:.1f} to {last:.1f} s: its feet would be "
                f"{one.foot:.2f} m off their places; choose another part"
                + ("" if feet == "planted" else ", or planted feet")
            )
    motion = sampled_motion(robot, body_motion, course.phases, rate, mean_ground(course.feet))
    figures = {
        "key_point_rms_m": _key_point_rms(robot, wanted, body_motion, span),
        "frames_per_s": human.count / (retargeted - begun),
    }
    dancer, ended = human_on_time_line(smooth, PLAN_RATE), time.perf_counter()
    return Plan(
        motion=motion,
        human=course.human,
        start=float(course.clock[start]),
        end=float(course.clock[end]),
        clock=_shown(course.clock),
        heading=hip_heading(dancer.points)[start : end + 1],
        travel=course.travel,
        flights=find_flights(dancer),
        retarget=figures,
        seconds={"retarget": retargeted - begun, "balance": ended - retargeted, "total": ended - begun},
        imitation=imitation,
        shortfalls=tuple(short),
        overloads=tuple(overloads(robot, course.phases, body_motion)),
        lean_cut=lean_cut(wanted.lean_cut, 1.0 / PLAN_RATE),
    )


def _shown(clock: Array) -> Array:
    """Of the motion's time at all frames (T,), the part at those of the clip, without lead-in and tail [s]."""
    return clock[round(LEAD_IN_TIME * PLAN_RATE) : len(clock) - round(TAIL_TIME * PLAN_RATE)]


def _finished(
    fit: Fitter, course: Course, body_motion: Spline, relieved: bool, limbs: LimbFit | None
) -> tuple[Course, Spline]:
    """The course and the motion of a body whose limbs are fitted to its chest as it has moved, balanced once more."""
    wanted = fit.targets(course)
    body_motion = fit_limbs(fit.robot, wanted, fit.limits, body_motion, LIMB_REFIT_STEPS)
    if limbs is not None:
        body_motion = limbs(_shown(course.clock), wanted, fit.limits, body_motion)
    course, body_motion, _ = fit.balanced(
        course, wanted, body_motion, MAX_FINAL_SLOWDOWNS, fresh=False, relieved=relieved
    )
    return course, body_motion


def _clip_time(clock: Array, t: float) -> float:
    """The clip's time when the motion's is t, from the motion's times at the clip's frames `clock` (n,) [s]."""
    return float(np.interp(t, clock, np.arange(len(clock)) / PLAN_RATE))


def sampled_motion(
    robot: Robot, spline: Spline, phases: tuple[Phase, ...], rate: float, ground: Array | None = None
) -> Motion:
    """A spline as a motion sampled at a rate [Hz], with the ZMP that its whole-body dynamics needs.

    ground: (T,) height of what the feet stand on, in the mean, at the spline's knots: that of the ZMP [m].
    """
    times = np.arange(round(spline.duration * rate) + 1) / rate
    q, v, a = to_pinocchio(*(spline(times, derivative) for derivative in range(3)))
    state = Centroidal.along(robot, q, v, a)
    over = state if ground is None else state.above(np.interp(times, spline.period * np.arange(len(ground)), ground))
    return Motion(
        robot=robot,
        rate=rate,
        q=q,
        v=v,
        a=a,
        com=state.com,
        com_velocity=state.velocity,
        com_acceleration=state.acceleration,
        zmp=over.zmp(),
        momentum=state.momentum[:, 3:],
        phases=phases,
    )


def _key_point_rms(robot: Robot, wanted: Targets, reference: Spline, clip: slice) -> float:
    """The root mean square distance from the reference's key points, over the clip, to those of the human in the
    robot's size (see `key_points`), both relative to the waist [m]."""
    kinematics = Kinematics(JointTree(robot), reference.knots[clip])
    _, waist = kinematics.frame_pose(robot.point("waist"))
    offsets = [
        kinematics.frame_pose(robot.point(name))[1] - waist - place[clip]
        for name, place in key_points(wanted, robot).items()
    ]
    return float(np.sqrt(np.mean(np.sum(np.square(offsets), axis=2))))
