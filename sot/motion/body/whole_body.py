"""The parts of a body put together: retargeted to look like the human, then balanced."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.body.branches import choose
from sot.motion.body.clearance import ClearArm
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.height import lowered, reachable
from sot.motion.body.limits import Limits
from sot.motion.body.parts import Arm, Body, Head, Part
from sot.motion.body.retarget import PartFit, solve
from sot.motion.body.spline import Spline
from sot.motion.body.targets import Targets
from sot.motion.feet.stance import Build
from sot.motion.feet.swing import FootPath, facing, middle, moving
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot

Array = NDArray[np.float64]
AnyPart = TypeVar("AnyPart", bound=Part)

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
    for part in _with_joints(parts):
        y[:, part.columns], _ = solve(part, knots, y, limits)
    for arm in _with_joints([Arm(robot, side, wanted) for side in SIDES]):
        y = choose(arm, y, limits, period)
    whole = Spline.through(y, period)
    whole.control[:3] = y[0]
    return limbs_fitted(robot, wanted, limits, whole, LIMB_STEPS)


def limbs_fitted(robot: Robot, wanted: Targets, limits: Limits, whole: Spline, steps: int) -> Spline:
    """The same motion with head and arms fitted, under their limits, to the chest as it moves."""
    y, control = whole.knots, whole.control.copy()
    limbs: list[Part] = [Head(robot, wanted), *(ClearArm(robot, side, wanted) for side in SIDES)]
    for limb in _with_joints(limbs):
        fit = PartFit(limb.columns, wanted.length, whole.period, limits)
        spline = Spline(control[:, limb.columns], whole.period)
        control[:, limb.columns] = fit.improve(limb, spline, y, steps).control
    return Spline(control, whole.period)


def _with_joints(parts: Sequence[AnyPart]) -> list[AnyPart]:
    """Those of the parts that the robot can move: a robot may have no head or arms."""
    return [part for part in parts if len(part.columns)]


def _in_reach(robot: Robot, wanted: Targets, feet: Mapping[str, FootPath], y: Array, period: float) -> Targets:
    """The targets with hips from which the legs reach their feet, at coordinates (T, nv) of the body."""
    height = lowered(wanted.hips[:, 2], reachable(robot, y, feet), period).knots
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
