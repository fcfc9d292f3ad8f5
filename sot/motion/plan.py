"""From a human's motion to a robot's that it can do: retarget, balance, sample."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.balance import Centroidal, plan_balance
from sot.motion.branches import choose
from sot.motion.contacts import Phase, planted, support
from sot.motion.coordinates import from_configuration, to_acceleration, to_configuration, to_velocity
from sot.motion.human import SIDES, Human
from sot.motion.limits import Limits
from sot.motion.parts import Arm, Body, Head, Part
from sot.motion.retarget import PartFit, follow
from sot.motion.spline import Spline
from sot.motion.stance import LEAD, TAIL, Build, on_time_line, over_feet
from sot.motion.targets import Targets, targets
from sot.motion.trajectory import Motion
from sot.robot import Robot

Array = NDArray[np.float64]

PLAN_RATE = 50.0  # knots per second
NOISE_HZ = 6.0  # faster than this, a capture is noise
HEAD_STEPS, ARM_STEPS = 2, 3  # Gauss-Newton steps over the whole clip
ROUNDS = 5  # of balance and body, each taking the other's result


@dataclass(frozen=True)
class Plan:
    """A robot motion and the human it follows.

    Attributes:
        motion: what the robot shall do.
        human: the human in the robot's size and place, on the motion's time line, at PLAN_RATE.
        start, end: the part of the motion that shows the clip [s]; before, the lead-in from rest; after, rest.
        retarget: figures of the report: "key_point_rms_m" and "frames_per_s".
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
        feet: "planted", both soles where the rest posture puts them.
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: another kind of `feet`.
    """
    if feet != "planted":
        raise InputError(f"feet '{feet}' are not known: choose planted")
    begun = time.perf_counter()
    build, limits, period = Build.of(robot), Limits.of(robot), 1.0 / PLAN_RATE
    person = on_time_line(over_feet(human.low_passed(NOISE_HZ), build), PLAN_RATE)
    wanted = targets(person, robot, build)
    phases = planted(robot, (wanted.length - 1) * period)
    whole = retarget(robot, build, wanted, phases[0], limits, period)
    retargeted = time.perf_counter()
    figures = {
        "key_point_rms_m": _key_point_rms(robot, build, person, whole),
        "frames_per_s": human.count / (retargeted - begun),
    }
    whole = balanced(robot, build, wanted, phases, limits, whole)
    motion = sample(robot, whole, phases, rate)
    ended = time.perf_counter()
    return Plan(
        motion=motion,
        human=person,
        start=LEAD,
        end=motion.duration - TAIL,
        retarget=figures,
        seconds={"retarget": retargeted - begun, "balance": ended - retargeted, "total": ended - begun},
    )


def retarget(robot: Robot, build: Build, wanted: Targets, phase: Phase, limits: Limits, period: float) -> Spline:
    """All nv coordinates as a spline that looks like the human: joint limits hold above the waist, feet stand.

    The legs follow without regard to their speed, and nothing yet to balance: `balanced` sees to both.
    """
    y = np.tile(from_configuration(robot.rest[None]), (wanted.length, 1))
    body = Body(robot, build, wanted, phase)
    y = follow(body, y, limits)
    chest = _orientations(robot, "chest", y)
    control = Spline.through(y, period).control
    head = Head(robot, wanted, chest)
    parts: list[tuple[Part, int]] = [(head, HEAD_STEPS)]
    for side in SIDES:
        arm = Arm(robot, side, wanted, chest)
        y = choose(arm, y, limits, period)
        parts.append((arm, ARM_STEPS))
    for part, steps in parts:
        fit = PartFit(part.columns, wanted.length, period, limits)
        spline = fit.improve(part, Spline.through(y[:, part.columns], period), y, steps)
        control[:, part.columns] = spline.control
    return Spline(control, period)


def _orientations(robot: Robot, point: str, y: Array) -> Array:
    """Orientation (T, 3, 3) of a point along coordinates (T, nv)."""
    data, frame = robot.model.createData(), robot.point(point)
    rotations = np.empty((len(y), 3, 3))
    for k, q in enumerate(to_configuration(y)):
        pin.forwardKinematics(robot.model, data, q)
        rotations[k] = pin.updateFramePlacement(robot.model, data, frame).rotation
    return rotations


def balanced(
    robot: Robot, build: Build, wanted: Targets, phases: Sequence[Phase], limits: Limits, whole: Spline
) -> Spline:
    """The same motion with its base, legs and chest fitted to a CoM that keeps the ZMP in the soles.

    What the ZMP depends on, the height of the CoM and the angular momentum, changes with the body: hence ROUNDS.
    """
    polygons = [support(robot, phase) for phase in phases]
    body = Body(robot, build, wanted, phases[0])
    fit = PartFit(body.columns, wanted.length, whole.period, limits)
    control = whole.control.copy()
    com = centroidal(whole, robot).com[:, :2]
    for _ in range(ROUNDS):
        state = centroidal(Spline(control, whole.period), robot)
        state.com[:, :2] = com
        plan = plan_balance(state, phases, polygons, whole.period)
        part = Body(robot, build, wanted, phases[0], plan.com.knots)
        spline = Spline(control[:, body.columns], whole.period)
        control[:, body.columns] = fit.improve(part, spline, Spline(control, whole.period).knots, 1).control
    return Spline(control, whole.period)


def centroidal(spline: Spline, robot: Robot) -> Centroidal:
    """Centroidal quantities of a whole-body spline at its knots."""
    y, dy, ddy = spline.knots, spline.velocities, spline.accelerations
    q, v, a = to_configuration(y), to_velocity(y, dy), to_acceleration(y, dy, ddy)
    data = robot.model.createData()
    com, rate = np.empty((len(q), 3)), np.empty((len(q), 6))
    for k in range(len(q)):
        rate[k] = pin.computeCentroidalMomentumTimeVariation(robot.model, data, q[k], v[k], a[k]).vector
        com[k] = data.com[0]
    return Centroidal(com, rate[:, 2] / robot.mass, rate[:, 3:], robot.mass)


def sample(robot: Robot, spline: Spline, phases: tuple[Phase, ...], rate: float) -> Motion:
    """The motion at a rate [Hz], with the ZMP that its whole-body dynamics needs."""
    times = np.arange(round(spline.duration * rate) + 1) / rate
    y, dy, ddy = (spline(times, derivative) for derivative in range(3))
    q, v, a = to_configuration(y), to_velocity(y, dy), to_acceleration(y, dy, ddy)
    data = robot.model.createData()
    com, momentum, change = np.empty((len(q), 3)), np.empty((len(q), 6)), np.empty((len(q), 6))
    for k in range(len(q)):
        change[k] = pin.computeCentroidalMomentumTimeVariation(robot.model, data, q[k], v[k], a[k]).vector
        momentum[k] = data.hg.vector
        com[k] = data.com[0]
    state = Centroidal(com, change[:, 2] / robot.mass, change[:, 3:], robot.mass)
    return Motion(
        robot=robot,
        rate=rate,
        q=q,
        v=v,
        a=a,
        com=com,
        com_velocity=momentum[:, :3] / robot.mass,
        com_acceleration=change[:, :3] / robot.mass,
        zmp=state.zmp(com[:, :2], change[:, :2] / robot.mass),
        momentum=momentum[:, 3:],
        phases=phases,
    )


def _key_point_rms(robot: Robot, build: Build, human: Human, spline: Spline) -> float:
    """Distance between the robot's and the scaled human's wrists, elbows and head, relative to the hips [m]."""
    names = ("neck", *(f"{side}_{point}" for side in SIDES for point in ("elbow", "wrist")))
    data, q = robot.model.createData(), to_configuration(spline.knots)
    errors = np.empty((len(q), len(names)))
    for k in range(len(q)):
        pin.framesForwardKinematics(robot.model, data, q[k])
        hips = data.oMf[robot.point("waist")].act(build.hips)
        for i, name in enumerate(names):
            place = data.oMf[robot.point(name)].translation - hips
            errors[k, i] = np.linalg.norm(place - (human.points[name][k] - human.points["waist"][k]))
    return float(np.sqrt(np.mean(errors**2)))
