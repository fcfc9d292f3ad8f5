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
from sot.motion.height import lowered, reachable
from sot.motion.human import SIDES
from sot.motion.limits import Limits
from sot.motion.parts import Arm, Body, Head, Part
from sot.motion.retarget import PartFit, solve
from sot.motion.spline import Spline
from sot.motion.stance import Build
from sot.motion.support import supports
from sot.motion.swing import FootPath
from sot.motion.targets import Targets
from sot.robot import Robot

Array = NDArray[np.float64]

LIMB_STEPS = 2  # Gauss-Newton steps of head and arms over the whole clip
ROUNDS = 6  # most rounds of balance and body, each taking the other's result
SETTLED = 0.005  # m, a change of the whole body's ZMP from one round to the next that ends them


def retarget(
    robot: Robot, build: Build, wanted: Targets, feet: Mapping[str, FootPath], limits: Limits, period: float
) -> Spline:
    """All nv coordinates as a spline that looks like the human: joint limits hold above the waist, feet go their way.

    The legs follow without regard to their speed, and nothing yet to balance: `balanced` sees to both.
    """
    y, knots = _at_rest_over(feet, robot, wanted.length), np.arange(wanted.length)
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
) -> Spline:
    """The same motion with its base, legs and chest fitted to a CoM that keeps the ZMP in the soles.

    What the ZMP depends on, the height of the CoM and the angular momentum, changes with the body: hence ROUNDS.
    """
    where, human = supports(robot, phases), wanted
    columns = Body(robot, build, wanted, feet).columns
    fit = PartFit(columns, wanted.length, whole.period, limits)
    state = _centroidal(whole, robot)
    wanted_com = state.com[:, :2]
    for _ in range(ROUNDS):
        if len(phases) > 1:
            wanted = _in_reach(robot, human, feet, whole)
        plan = plan_balance(state, wanted_com, where, whole.period)
        body = Body(robot, build, wanted, feet, plan.com.knots)
        control = whole.control.copy()
        spline = Spline(control[:, columns], whole.period)
        control[:, columns] = fit.improve(body, spline, whole.knots, 1).control
        whole = Spline(control, whole.period)
        before, state = state, _centroidal(whole, robot)
        if np.abs(state.zmp() - before.zmp()).max() < SETTLED:
            break
    return whole


def _in_reach(robot: Robot, wanted: Targets, feet: Mapping[str, FootPath], whole: Spline) -> Targets:
    """The targets with hips from which the legs reach their feet, where the body now is."""
    height = lowered(wanted.hips[:, 2], reachable(robot, whole.knots, feet), whole.period)
    return replace(wanted, hips=np.column_stack([wanted.hips[:, :2], height]))


def _at_rest_over(feet: Mapping[str, FootPath], robot: Robot, length: int) -> Array:
    """The rest posture (length, nv), moved and turned with the middle of the feet: where a fit may start from."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    moved, turned = np.zeros((length, 2)), np.zeros(length)
    y = np.tile(from_configuration(robot.rest[None]), (length, 1))
    for foot, path in feet.items():
        pose = data.oMf[robot.point(foot)]
        turn = path.rotation @ pose.rotation.T
        yaw = np.unwrap(np.arctan2(turn[:, 1, 0], turn[:, 0, 0]))
        turned += yaw / len(feet)
        moved += path.position[:, :2] / len(feet)
    middle = np.mean([data.oMf[robot.point(foot)].translation[:2] for foot in feet], axis=0)
    cosine, sine = np.cos(turned), np.sin(turned)
    base = y[0, :2] - middle
    y[:, 0] = moved[:, 0] + cosine * base[0] - sine * base[1]
    y[:, 1] = moved[:, 1] + sine * base[0] + cosine * base[1]
    y[:, 5] += turned
    return y


def _centroidal(whole: Spline, robot: Robot) -> Centroidal:
    """At the knots of all nv coordinates."""
    return Centroidal.along(robot, *to_pinocchio(whole.knots, whole.velocities, whole.accelerations))
