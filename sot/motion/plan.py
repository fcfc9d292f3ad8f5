"""From a human's motion to a robot's that it can do: retarget, balance, sample."""

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.centroidal import Centroidal
from sot.motion.contacts import Phase, planted
from sot.motion.coordinates import to_pinocchio
from sot.motion.footholds import Reach
from sot.motion.human import Human
from sot.motion.kinematics import Chains, Kinematics
from sot.motion.limits import Limits
from sot.motion.spline import Spline
from sot.motion.stance import LEAD, TAIL, Build, on_time_line, over_feet
from sot.motion.swing import foot_paths, phases_of, standing
from sot.motion.targets import Targets, key_points, targets
from sot.motion.trajectory import Motion
from sot.motion.travel import travel
from sot.motion.whole_body import balanced, limbs_fitted, retarget
from sot.robot import Robot

Array = NDArray[np.float64]

FEET = ("planted", "steps")
PLAN_RATE = 50.0  # knots per second
REFIT_STEPS = 2  # Gauss-Newton steps of head and arms once the body is balanced
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
        seconds: time that planning took, by step.
    """

    motion: Motion
    human: Human
    start: float
    end: float
    retarget: dict[str, float]
    seconds: dict[str, float]


def plan(human: Human, robot: Robot, feet: str = "planted", rate: float = 1000.0) -> Plan:
    """The motion with which a robot dances like a human.

    Args:
        human: a clip, or the part of one to dance.
        robot: who dances.
        feet: "planted", both soles where the rest posture puts them; "steps", where and when the dancer steps.
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: another kind of `feet`.
    """
    if feet not in FEET:
        raise InputError(f"feet '{feet}' are not known: choose one of {', '.join(FEET)}")
    begun = time.perf_counter()
    build, limits, period = Build.of(robot), Limits.of(robot), 1.0 / PLAN_RATE
    smooth = human.low_passed(NOISE_HZ)
    if feet == "planted":
        person = on_time_line(over_feet(smooth, build), PLAN_RATE)
        phases = planted(robot, person.duration)
        paths = standing(phases[0], person.count)
    else:
        reach = Reach.of(robot)
        going = travel(on_time_line(smooth, PLAN_RATE), build, reach)
        person = going.human
        phases = phases_of(robot, going.stands, going.steps, person.duration)
        paths = foot_paths(robot, going.stands, going.steps, going.lifts, reach, person.times)
    wanted = targets(person, robot, build)
    whole = retarget(robot, build, wanted, paths, limits, period)
    retargeted = time.perf_counter()
    whole = balanced(robot, build, wanted, paths, phases, limits, whole)
    whole = limbs_fitted(robot, wanted, limits, whole, REFIT_STEPS)  # the chest has moved
    whole = balanced(robot, build, wanted, paths, phases, limits, whole)
    motion = sampled(robot, whole, phases, rate)
    figures = {
        "key_point_rms_m": _key_point_rms(robot, wanted, whole),
        "frames_per_s": human.count / (retargeted - begun),
    }
    ended = time.perf_counter()
    return Plan(
        motion=motion,
        human=person,
        start=LEAD,
        end=motion.duration - TAIL,
        retarget=figures,
        seconds={"retarget": retargeted - begun, "balance": ended - retargeted, "total": ended - begun},
    )


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


def _key_point_rms(robot: Robot, wanted: Targets, reference: Spline) -> float:
    """Root mean square distance, over the clip, from the reference's key points to those of the human in the robot's
    size (see `key_points`), both relative to the waist [m]."""
    clip = slice(round(LEAD * PLAN_RATE), wanted.length - round(TAIL * PLAN_RATE))
    kinematics = Kinematics(Chains(robot), reference.knots[clip])
    _, waist = kinematics.frame(robot.point("waist"))
    offsets = [
        kinematics.frame(robot.point(name))[1] - waist - place[clip]
        for name, place in key_points(wanted, robot).items()
    ]
    return float(np.sqrt(np.mean(np.sum(np.square(offsets), axis=2))))
