"""Refit a limb's motion to the edited path of the point that it carries."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sot.control.pose import PoseReference
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.limits import Limits
from sot.motion.body.spline import LimitedFit, Spline
from sot.motion.trajectory import Motion

Array = NDArray[np.float64]

KNOT_RATE = 50.0  # Hz
POINT_WEIGHT = 1.0 / 0.01  # 1/m and 1/rad, of the point's error
PLANNED_WEIGHT = 1.0 / 0.5  # 1/rad, of the joints' deviation from the plan
ACCEPTED_JERK = 2000.0  # rad/s³, the jerk that costs as much as an acceptable error
GAUSS_NEWTON_DAMPING = 20.0  # in the units of squared residuals: a stretched limb is far from linear
GAUSS_NEWTON_STEPS = 40  # number of Gauss-Newton steps


def refit_limb(
    motion: Motion, joints: Sequence[str], point: str, wanted: Sequence[tuple[int, float, float]], path: PoseReference
) -> Motion:
    """Motion whose limb takes its point to the wanted path, as far as its joint limits let it.

    At other times, and in its null space, the limb does what was planned; the other joints do so throughout.
    Centre of mass, zero-moment point and momentum are left as they are.

    Args:
        motion: as it was planned.
        joints: names of the limb's joints.
        point: that the limb carries.
        wanted: which of `sot.control.task.AXIS_NAMES`, by number, is wanted from when to when [s].
        path: where the point is wanted.
    """
    times = np.arange(round(motion.duration * KNOT_RATE) + 1) / KNOT_RATE
    y = from_configuration(np.array([motion.sample(t).q for t in times.tolist()]))
    limits, columns = Limits.of(motion.robot), 6 + motion.robot.joint_numbers(joints)
    chains, frame = JointTree(motion.robot), motion.robot.point(point)
    poses = [path(t) for t in times.tolist()]
    position, rotation = (np.array(values) for values in list(zip(*poses, strict=True))[:2])
    weights = np.zeros((len(times), 6))
    for row, start, end in wanted:
        weights[(times >= start) & (times <= end), row] = POINT_WEIGHT
    planned = y[:, columns]
    stays = np.broadcast_to(PLANNED_WEIGHT * np.eye(len(columns)), (len(times), len(columns), len(columns)))
    fit = LimitedFit(
        len(times),
        1.0 / KNOT_RATE,
        limits.lower[columns],
        limits.upper[columns],
        limits.velocity[columns],
        limits.acceleration[columns],
        np.full(len(columns), ACCEPTED_JERK),
        GAUSS_NEWTON_DAMPING,
    )
    limb = Spline.through(planned, 1.0 / KNOT_RATE)
    for _ in range(GAUSS_NEWTON_STEPS):
        y[:, columns] = limb.knots
        kinematics = Kinematics(chains, y, columns)
        off, J = (
            np.concatenate(parts, axis=1)
            for parts in zip(
                kinematics.position_residual(frame, position),
                kinematics.orientation_residual(frame, rotation),
                strict=True,
            )
        )
        residuals = np.hstack([weights * off, PLANNED_WEIGHT * (y[:, columns] - planned)])
        limb, _ = fit.step(limb, np.concatenate([weights[:, :, None] * J, stays], axis=1), residuals)
    q, v, a = motion.q.copy(), motion.v.copy(), motion.a.copy()
    q[:, 1 + columns], v[:, columns], a[:, columns] = (limb(motion.times, derivative) for derivative in range(3))
    return replace(motion, q=q, v=v, a=a)
