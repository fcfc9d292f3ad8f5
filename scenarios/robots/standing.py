"""What standing asks of a robot's joints: torques on both feet and on either one, and the ranges that takes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from scenarios.robots.findings import Finding, Severity
from sot.motion.footing import REACH_TOLERANCE, footing_at
from sot.robots.limits import FOOT_FREEDOMS
from sot.robots.robot import Robot

Array = NDArray[np.float64]

NOTED_EFFORT_SHARE = 0.7  # share of its effort that standing may take of a joint without a word


@dataclass(frozen=True)
class Stance:
    """Standing still.

    Attributes:
        feet: that carry.
        q: configuration (nq,).
        torques: (na,) [N m].
        reached: whether both soles are flat on the floor with the centre of mass over what carries.
    """

    feet: Sequence[str]
    q: Array
    torques: Array
    reached: bool


def stances(robot: Robot) -> Iterator[Stance]:
    """Standing on both feet at rest and, if legs have joints enough, on either one, the other still on the floor."""
    yield Stance(robot.feet, robot.rest, _torques(robot, robot.rest, robot.feet), True)
    for foot in robot.feet:
        if len(robot.groups[foot.replace("foot", "leg")]) < FOOT_FREEDOMS:
            continue
        q, reached = _over(robot, foot)
        yield Stance((foot,), q, _torques(robot, q, (foot,)), reached)


def standing_findings(robot: Robot) -> Iterator[Finding]:
    """Joints that standing takes too much effort of, or beyond their range."""
    for stance in stances(robot):
        on = "both feet" if len(stance.feet) > 1 else f"the {stance.feet[0].replace('_', ' ')}"
        shares = np.abs(stance.torques) / robot.effort
        stops = Severity.STOPS if len(stance.feet) > 1 else Severity.WARNS
        for severity, low, high in ((stops, 1.0, np.inf), (Severity.NOTES, NOTED_EFFORT_SHARE, 1.0)):
            over = [k for k in np.argsort(-shares) if low <= shares[k] < high]
            if over:
                joints = ", ".join(
                    f"{robot.joints[k]} {abs(stance.torques[k]):.0f} of {robot.effort[k]:.0f} N m" for k in over
                )
                says = (
                    "more effort than there is"
                    if low >= 1.0
                    else f"over {100 * NOTED_EFFORT_SHARE:.0f} % of the effort"
                )
                remedy = "correct 'limits.effort' if it is not the motor's; else dance more slowly, and let arms hang"
                yield Finding(severity, f"standing on {on} takes {says}", joints, remedy)
        if not stance.reached:
            beyond = [
                f"{name} [{np.rad2deg(low):.0f}°, {np.rad2deg(high):.0f}°]"
                for name, angle, low, high in zip(robot.joints, stance.q[7:], robot.lower, robot.upper, strict=True)
                if angle <= low + REACH_TOLERANCE or angle >= high - REACH_TOLERANCE
            ]
            what = f"the weight cannot be brought over {on} while the other stays flat"
            remedy = "expect short, narrow steps; bend the knees more at rest, or bring the feet closer together"
            yield Finding(Severity.WARNS, what, ", ".join(beyond) or "legs", remedy)


def _torques(robot: Robot, q: Array, feet: Sequence[str]) -> Array:
    """Torques (na,) [N m] at rest: foot wrenches w that carry the robot, of those the ones with least torques over
    efforts. With g from gravity and J of the feet: g_b = J_bᵀ w, τ = g_a − J_aᵀ w."""
    model, data = robot.model, robot.model.createData()
    gravity = pin.computeGeneralizedGravity(model, data, q)
    pin.computeJointJacobians(model, data, q)
    frames = [robot.point(foot) for foot in feet]
    J = np.vstack([pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED) for frame in frames])
    carrying = J[:, :6].T
    w = np.linalg.lstsq(carrying, gravity[:6], rcond=None)[0]
    _, values, rows = np.linalg.svd(carrying)
    free = rows[int((values > 1e-9).sum()) :].T
    if free.size:
        J_a = J[:, 6:].T / robot.effort[:, None]
        w = w + free @ np.linalg.lstsq(J_a @ free, gravity[6:] / robot.effort - J_a @ w, rcond=None)[0]
    return gravity[6:] - J[:, 6:].T @ w


def _over(robot: Robot, foot: str) -> tuple[Array, bool]:
    """The configuration (nq,) with the centre of mass over the middle of one sole and both feet where they are at rest,
    within all ranges; and whether there is one."""
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, robot.rest)
    feet = {name: data.oMf[robot.point(name)].copy() for name in robot.feet}
    target = np.mean([feet[foot].act(corner) for corner in robot.sole(foot)], axis=0)[:2]
    q, _, reached = footing_at(robot, feet, target)
    return q, reached
