"""The parts of a body put together: retargeted to look like the human, then balanced."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sot.motion.balance import SHARE, plan_balance
from sot.motion.branches import choose
from sot.motion.centroidal import Centroidal
from sot.motion.contacts import Phase, loaded_support
from sot.motion.coordinates import from_configuration, to_pinocchio
from sot.motion.human import SIDES
from sot.motion.limits import Limits
from sot.motion.parts import Arm, Body, Head, Part
from sot.motion.retarget import PartFit, solve
from sot.motion.spline import Spline
from sot.motion.stance import Build
from sot.motion.targets import Targets
from sot.robot import Robot

Array = NDArray[np.float64]

LIMB_STEPS = 2  # Gauss-Newton steps of head and arms over the whole clip
ROUNDS = 6  # most rounds of balance and body, each taking the other's result
SETTLED = 0.005  # m, a change of the whole body's ZMP from one round to the next that ends them


def retarget(robot: Robot, build: Build, wanted: Targets, phase: Phase, limits: Limits, period: float) -> Spline:
    """All nv coordinates as a spline that looks like the human: joint limits hold above the waist, feet stand.

    The legs follow without regard to their speed, and nothing yet to balance: `balanced` sees to both.
    """
    y, knots = np.tile(from_configuration(robot.rest[None]), (wanted.length, 1)), np.arange(wanted.length)
    parts: list[Part] = [Body(robot, build, wanted, phase), Head(robot, wanted)]
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
    limbs: list[Part] = [Head(robot, wanted), *(Arm(robot, side, wanted) for side in SIDES)]
    for limb in limbs:
        fit = PartFit(limb.columns, wanted.length, whole.period, limits)
        spline = Spline(control[:, limb.columns], whole.period)
        control[:, limb.columns] = fit.improve(limb, spline, y, steps).control
    return Spline(control, whole.period)


def balanced(
    robot: Robot, build: Build, wanted: Targets, phases: Sequence[Phase], limits: Limits, whole: Spline
) -> Spline:
    """The same motion with its base, legs and chest fitted to a CoM that keeps the ZMP in the soles.

    What the ZMP depends on, the height of the CoM and the angular momentum, changes with the body: hence ROUNDS.
    """
    polygons = [loaded_support(robot, phase, SHARE) for phase in phases]
    columns = Body(robot, build, wanted, phases[0]).columns
    fit = PartFit(columns, wanted.length, whole.period, limits)
    state = _centroidal(whole, robot)
    wanted_com = state.com[:, :2]
    for _ in range(ROUNDS):
        plan = plan_balance(state, wanted_com, phases, polygons, whole.period)
        body = Body(robot, build, wanted, phases[0], plan.com.knots)
        control = whole.control.copy()
        spline = Spline(control[:, columns], whole.period)
        control[:, columns] = fit.improve(body, spline, whole.knots, 1).control
        whole = Spline(control, whole.period)
        before, state = state, _centroidal(whole, robot)
        if np.abs(state.zmp() - before.zmp()).max() < SETTLED:
            break
    return whole


def _centroidal(whole: Spline, robot: Robot) -> Centroidal:
    """At the knots of all nv coordinates."""
    return Centroidal.along(robot, *to_pinocchio(whole.knots, whole.velocities, whole.accelerations))
