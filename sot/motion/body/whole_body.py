"""The whole body retargeted: its parts are fitted so that the robot looks like the human."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.body.branches import choose_arm_path
from sot.motion.body.clearance import ClearArm
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.height import reachable_hip_height, smooth_height_below
from sot.motion.body.limits import Limits
from sot.motion.body.parts import Arm, Body, Head, Part
from sot.motion.body.retarget import PartFit, solve_knots
from sot.motion.body.spline import Spline
from sot.motion.body.targets import Targets
from sot.motion.feet.stance import Build
from sot.motion.feet.swing import FootPath, any_foot_moves, feet_heading, feet_middle
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot

Array = NDArray[np.float64]
AnyPart = TypeVar("AnyPart", bound=Part)

LIMB_GAUSS_NEWTON_STEPS = 2  # Gauss-Newton steps of head and arms over the whole clip


def retarget(
    robot: Robot, build: Build, wanted: Targets, feet: Mapping[str, FootPath], limits: Limits, period: float
) -> Spline:
    """Spline of all nv coordinates that looks like the human, with limits above the waist and feet on their paths.

    The legs follow without regard to their speed, and nothing balances the robot yet: the balance room does both.
    """
    y, knots = _rest_posture_over(feet, robot, wanted.length), np.arange(wanted.length)
    if any_foot_moves(feet) and wanted.height is None:
        y[:, :2] = wanted.hips[:, :2]
        wanted = _with_reachable_hips(robot, wanted, feet, y, period)
    parts: list[Part] = [Body(robot, build, wanted, feet), Head(robot, wanted)]
    for part in _with_joints(parts):
        y[:, part.columns], _ = solve_knots(part, knots, y, limits)
    for arm in _with_joints([Arm(robot, side, wanted) for side in SIDES]):
        y = choose_arm_path(arm, y, limits, period)
    body_motion = Spline.through(y, period)
    body_motion.control[:3] = y[0]
    return fit_limbs(robot, wanted, limits, body_motion, LIMB_GAUSS_NEWTON_STEPS)


def fit_limbs(robot: Robot, wanted: Targets, limits: Limits, body_motion: Spline, steps: int) -> Spline:
    """Body motion with head and arms fitted anew, under their limits, to the chest as it moves."""
    y, control = body_motion.knots, body_motion.control.copy()
    limbs: list[Part] = [Head(robot, wanted), *(ClearArm(robot, side, wanted) for side in SIDES)]
    for limb in _with_joints(limbs):
        fit = PartFit(limb.columns, wanted.length, body_motion.period, limits)
        spline = Spline(control[:, limb.columns], body_motion.period)
        control[:, limb.columns] = fit.refine(limb, spline, y, steps).control
    return Spline(control, body_motion.period)


def _with_joints(parts: Sequence[AnyPart]) -> list[AnyPart]:
    """Those of the parts that have joints: a robot may have no head or arms."""
    return [part for part in parts if len(part.columns)]


def _with_reachable_hips(
    robot: Robot, wanted: Targets, feet: Mapping[str, FootPath], y: Array, period: float
) -> Targets:
    """The targets with hips low enough for both legs to reach their feet, at coordinates (T, nv) of the body."""
    height = smooth_height_below(
        wanted.hips[:, 2], reachable_hip_height(robot, y, feet, wanted.extension), period
    ).knots
    return replace(wanted, hips=np.column_stack([wanted.hips[:, :2], height]))


def _rest_posture_over(feet: Mapping[str, FootPath], robot: Robot, length: int) -> Array:
    """The rest posture (length, nv), moved and turned with the middle of the feet: a start for the fit."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    y = np.tile(from_configuration(robot.rest[None]), (length, 1))
    moved, turned = feet_middle(feet), feet_heading(feet)
    centre = np.mean([data.oMf[robot.point(foot)].translation[:2] for foot in feet], axis=0)
    cosine, sine = np.cos(turned), np.sin(turned)
    base = y[0, :2] - centre
    y[:, 0] = moved[:, 0] + cosine * base[0] - sine * base[1]
    y[:, 1] = moved[:, 1] + sine * base[0] + cosine * base[1]
    y[:, 5] += turned
    return y
