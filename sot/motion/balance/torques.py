"""The torques that a planned motion needs: inverse dynamics, the floor's forces shared by the feet that stand."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.ndimage import binary_opening

from sot.motion.body.coordinates import to_pinocchio
from sot.motion.body.spline import Spline
from sot.motion.feet.contacts import Phase, phase_indices
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Indices = NDArray[np.int_]
Flags = NDArray[np.bool_]

MAX_NAMED_JOINTS = 6  # joints in a sentence
MOMENT_ARM_M = 0.05  # m: a moment on a foot costs as much as a force at that distance
KNOT_STRIDE = 2  # knots, at which torques are looked at
MIN_OVERLOADED_SAMPLES = 2  # of these in a row: a torque beyond its limit for less is left to the controller


def planned_torques(robot: Robot, phases: Sequence[Phase], times: Array, q: Array, v: Array, a: Array) -> Array:
    """The torques (T, na) of the joints in a motion q (T, nq), v (T, nv), a (T, nv) at some times (T,) [N m].

    τ = S (M a + h − Σ Jᵀ w) + d v + c sign v: damping d and friction c of the joints, w the least wrenches on the feet
    of each time's phase that move the free base as planned. Where no foot stands, the base is left to itself.
    """
    model, data = robot.model, robot.model.createData()
    torques, phase = np.empty((len(times), robot.na)), phase_indices(phases, times)
    weight = np.repeat([1.0, MOMENT_ARM_M**2], 3)  # of forces and moments, inverse
    for k in range(len(times)):
        needed = pin.rnea(model, data, q[k], v[k], a[k]).copy()
        feet = [robot.point(foot) for foot in phases[int(phase[k])].feet]
        if feet:
            pin.computeJointJacobians(model, data, q[k])
            pin.updateFramePlacements(model, data)
            J = np.vstack([pin.getFrameJacobian(model, data, foot, pin.LOCAL_WORLD_ALIGNED) for foot in feet])
            base, share = J[:, :6].T, np.tile(weight, len(feet))
            needed -= J.T @ (share * (base.T @ np.linalg.solve((base * share) @ base.T, needed[:6])))
        torques[k] = needed[6:]
    return torques + robot.damping * v[:, 6:] + robot.friction * np.sign(v[:, 6:])


def overloaded_knots(robot: Robot, phases: Sequence[Phase], body_motion: Spline) -> tuple[Flags, Array]:
    """Flags (T, na) of the knots and joints of a body motion whose torque is beyond the joint's effort for long, and
    the ratios (T, na) of torque and effort."""
    count = len(body_motion.knots)
    rows = np.arange(0, count, KNOT_STRIDE)
    motion = (body_motion.knots[rows], body_motion.velocities[rows], body_motion.accelerations[rows])
    torques = planned_torques(robot, phases, body_motion.period * rows.astype(float), *to_pinocchio(*motion))
    ratio = np.abs(torques) / robot.effort
    over = np.asarray(binary_opening(ratio > 1.0, np.ones((MIN_OVERLOADED_SAMPLES, 1))), dtype=bool)
    return np.repeat(over, KNOT_STRIDE, axis=0)[:count], np.repeat(ratio, KNOT_STRIDE, axis=0)[:count]


@dataclass(frozen=True)
class Overload:
    """A joint whose planned torque is beyond its effort for long: the greatest ratio of both, and the share of time."""

    joint: str
    ratio: float
    share: float


def overloads(robot: Robot, phases: Sequence[Phase], body_motion: Spline) -> list[Overload]:
    """The joints that a body motion overloads, the greatest share of time first."""
    over, ratio = overloaded_knots(robot, phases, body_motion)
    share = over.mean(axis=0)
    return [
        Overload(robot.joints[k], float(ratio[over[:, k], k].max()), float(share[k]))
        for k in np.argsort(-share, kind="stable")
        if share[k] > 0.0
    ]


def overload_remark(found: Sequence[Overload]) -> str:
    """The sentence that names the joints that a plan overloads, one at least."""
    named = [
        f"{one.joint} {one.ratio:.2g} times in {100.0 * one.share:.2g} % of the time"
        for one in found[:MAX_NAMED_JOINTS]
    ]
    more = f" and {len(found) - MAX_NAMED_JOINTS} more" if len(found) > MAX_NAMED_JOINTS else ""
    return f"The plan asks motors for more than their effort, even where it is slower: {', '.join(named)}{more}."


def overloaded_at_rest(robot: Robot, phases: Sequence[Phase], body_motion: Spline, knots: Indices) -> Flags:
    """Flags (n, na) of the joints that some knots (n,) overload even where the body holds still."""
    q, still = to_pinocchio(*3 * (body_motion.knots[knots],))[0], np.zeros((len(knots), robot.nv))
    times: Array = body_motion.period * knots.astype(float)
    torques = planned_torques(robot, phases, times, q, still, still)
    flags: Flags = np.abs(torques) > robot.effort
    return flags
