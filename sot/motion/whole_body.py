"""The parts of a body put together: retargeted to look like the human, then balanced."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.balance import plan_balance
from sot.motion.branches import choose
from sot.motion.centroidal import Centroidal
from sot.motion.clearance import ClearArm
from sot.motion.contacts import Phase
from sot.motion.coordinates import from_configuration, to_pinocchio
from sot.motion.grip import Grip
from sot.motion.height import lowered, reachable
from sot.motion.human import SIDES
from sot.motion.kinematics import Chains, Kinematics
from sot.motion.limits import Limits
from sot.motion.parts import Arm, Body, Head, Part
from sot.motion.retarget import PartFit, solve
from sot.motion.spline import Spline
from sot.motion.stance import Build
from sot.motion.support import Support, supports
from sot.motion.swing import FootPath, facing, middle, moving
from sot.motion.targets import Targets
from sot.robot import Robot

Array = NDArray[np.float64]

LIMB_STEPS = 2  # Gauss-Newton steps of head and arms over the whole clip
ROUNDS = 6  # most rounds of balance and body, each taking the other's result
MARGIN = 0.01  # m, least of the ZMP to the edge of what carries
OFF = 0.002  # m, greatest of a foot off its way
RELAXED = 0.75  # of the way from what a round was planned on to what came of it: all of it swings back and forth
SETTLED = 0.005  # m, of the ZMP off its plan, ends the rounds
HELPED = 0.5  # of what was strained: if two rounds leave more, more of them are no help
NEARLY = 0.04  # m, the same where feet step and nothing is strained


def retarget(
    robot: Robot, build: Build, wanted: Targets, feet: Mapping[str, FootPath], limits: Limits, period: float
) -> Spline:
    """All nv coordinates as a spline that looks like the human: joint limits hold above the waist, feet go their way.

    The legs follow without regard to their speed, and nothing yet to balance: `balanced` sees to both.
    """
    y, knots = _at_rest_over(feet, robot, wanted.length), np.arange(wanted.length)
    if moving(feet) and wanted.height is None:
        y[:, :2] = wanted.hips[:, :2]
        wanted = _in_reach(robot, wanted, feet, y, period)
    parts: list[Part] = [Body(robot, build, wanted, feet), Head(robot, wanted)]
    for part in parts:
        y[:, part.columns], _ = solve(part, knots, y, limits)
    for side in SIDES:
        y = choose(Arm(robot, side, wanted), y, limits, period)
    whole = Spline.through(y, period)
    whole.control[:3] = y[0]
    return limbs_fitted(robot, wanted, limits, whole, LIMB_STEPS)


def limbs_fitted(robot: Robot, wanted: Targets, limits: Limits, whole: Spline, steps: int) -> Spline:
    """The same motion with head and arms fitted, under their limits, to the chest as it moves."""
    y, control = whole.knots, whole.control.copy()
    limbs: list[Part] = [Head(robot, wanted), *(ClearArm(robot, side, wanted) for side in SIDES)]
    for limb in limbs:
        fit = PartFit(limb.columns, wanted.length, whole.period, limits)
        spline = Spline(control[:, limb.columns], whole.period)
        control[:, limb.columns] = fit.improve(limb, spline, y, steps).control
    return Spline(control, whole.period)


def balanced(
    robot: Robot,
    build: Build,
    wanted: Targets,
    feet: Mapping[str, FootPath],
    phases: Sequence[Phase],
    limits: Limits,
    whole: Spline,
    rough: bool = False,
) -> tuple[Spline, Array]:
    """The same motion with its base, legs and chest fitted to a CoM that keeps the ZMP in the soles.

    What the ZMP depends on, the height of the CoM and the angular momentum, changes with the body: hence rounds, until
    the ZMP is where it was planned, or on feet that step until nothing is strained.

    Args:
        robot: whose motion it is.
        build: of the robot.
        wanted: the body's targets.
        feet: where they are to be.
        phases: which stand where, when.
        limits: of the joints.
        whole: motion to start from.
        rough: it is fresh from `retarget`: its accelerations mean nothing yet.

    Returns:
        The motion, and the times (n,) at which feet that step still ask too much of it (see `strained`).
    """
    where, human, steps = supports(robot, phases), wanted, moving(feet)
    columns = Body(robot, build, wanted, feet).columns
    fit = PartFit(columns, wanted.length, whole.period, limits)
    state = _centroidal(whole, robot)
    wanted_com = state.com[:, :2]
    times: Array = whole.period * np.arange(wanted.length, dtype=float)
    grip = Grip(robot, phases, times) if steps else None
    if rough:
        state = replace(state, rate=np.zeros_like(state.rate))
    asked = state
    hasty: Array = np.empty(0)
    left: list[int] = []  # of hasty times, after each round
    for _ in range(ROUNDS):
        if steps and human.height is None:
            wanted = _in_reach(robot, human, feet, whole.knots, whole.period)
        plan = plan_balance(asked, wanted_com, where, whole.period)
        body = Body(robot, build, wanted, feet, plan.com.knots)
        if rough:  # knot by knot first: what the accelerations of a fit are from there on means something
            y = whole.knots
            y[:, columns], _ = solve(body, np.arange(wanted.length), y, limits)
            whole, rough = Spline.through(y, whole.period), False
            continue
        control = whole.control.copy()
        spline = Spline(control[:, columns], whole.period)
        bends = grip.excess(whole.knots, state) if grip else None
        control[:, columns] = fit.improve(body, spline, whole.knots, 1, bends).control
        whole = Spline(control, whole.period)
        state = _centroidal(whole, robot)
        hasty = strained(robot, feet, where, whole, state) if steps else hasty
        left.append(len(hasty))
        off = np.abs(state.zmp() - plan.zmp).max()
        if off < SETTLED or (steps and off < NEARLY and not len(hasty)):
            break
        if len(left) > 2 and left[-1] > HELPED * left[-3] > 0.0:
            break
        asked = asked.toward(state, RELAXED)
    return whole, hasty


def strained(
    robot: Robot, feet: Mapping[str, FootPath], where: Sequence[Support], whole: Spline, state: Centroidal
) -> Array:
    """Times (n,), at the knots or half way between two, at which a body cannot do what its feet are to do [s].

    Its ZMP leaves where the feet carry, or, at a knot, a foot is off its way. state: its own at the knots.
    """
    times: Array = 0.5 * whole.period * np.arange(2 * len(state.com) - 1, dtype=float)
    zmp, bad = np.empty((len(times), 2)), np.zeros(len(times), bool)
    zmp[::2], zmp[1::2] = state.zmp(), _centroidal(whole, robot, times[1::2]).zmp()
    for support, stop in zip(where, [*(support.start for support in where[1:]), np.inf], strict=True):
        rows = (times >= support.start) & (times < stop)
        bad[rows] |= support.polygon.margin(zmp[rows]) < MARGIN
    kinematics = Kinematics(Chains(robot), whole.knots)
    for foot, path in feet.items():
        bad[::2] |= np.linalg.norm(kinematics.frame(robot.point(foot))[1] - path.position, axis=1) > OFF
    return times[bad]


def _in_reach(robot: Robot, wanted: Targets, feet: Mapping[str, FootPath], y: Array, period: float) -> Targets:
    """The targets with hips from which the legs reach their feet, at coordinates (T, nv) of the body."""
    height = lowered(wanted.hips[:, 2], reachable(robot, y, feet), period)
    return replace(wanted, hips=np.column_stack([wanted.hips[:, :2], height]))


def _at_rest_over(feet: Mapping[str, FootPath], robot: Robot, length: int) -> Array:
    """The rest posture (length, nv), moved and turned with the middle of the feet: where a fit may start from."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    y = np.tile(from_configuration(robot.rest[None]), (length, 1))
    moved, turned = middle(feet), facing(feet)
    centre = np.mean([data.oMf[robot.point(foot)].translation[:2] for foot in feet], axis=0)
    cosine, sine = np.cos(turned), np.sin(turned)
    base = y[0, :2] - centre
    y[:, 0] = moved[:, 0] + cosine * base[0] - sine * base[1]
    y[:, 1] = moved[:, 1] + sine * base[0] + cosine * base[1]
    y[:, 5] += turned
    return y


def _centroidal(whole: Spline, robot: Robot, times: Array | None = None) -> Centroidal:
    """Of all nv coordinates at times (n,) [s], at the knots unless given."""
    if times is None:
        return Centroidal.along(robot, *to_pinocchio(whole.knots, whole.velocities, whole.accelerations))
    return Centroidal.along(robot, *to_pinocchio(*(whole(times, derivative) for derivative in range(3))))
