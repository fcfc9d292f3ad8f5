"""A smooth height of the hips from which both legs reach their feet."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from solvers.banded import BandedQP
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.spline import VALUE_STENCIL, Spline
from sot.motion.feet.swing import FootPath
from sot.motion.human.human import SIDES
from sot.robots.robot import Robot

Array = NDArray[np.float64]

LEG_EXTENSION_RANGE = 0.975, 0.988  # share of its length that a leg may reach, the dancer's between; the closed loop
# needs the rest
END_ACCELERATION_SHARE = 0.5  # of the acceleration, with which hips may come down from the ends
MAX_HIP_ACCELERATION = 2.5  # m/s², of the hips, up and down
ACCEPTED_HEIGHT_ERROR = 0.02  # m, deviation that costs as much as a jerk of ACCEPTED_JERK
ACCEPTED_JERK = 20.0  # m/s³
HELD_END_WEIGHT = 1e9  # weight that holds the control points at both ends
HELD_HEIGHT_ROOM = 1e-4  # m, added to the bound where a height is held
UNKNOWN: Mapping[str, Array] = MappingProxyType({})


def reachable_hip_height(
    robot: Robot, y: Array, feet: Mapping[str, FootPath], extension: Mapping[str, Array] = UNKNOWN
) -> Array:
    """Greatest height (T,) of the middle of the hips [m] from which both legs reach their feet.

    Args:
        y: (T, nv) coordinates, of which the base's place and orientation count.
        feet: where the feet are to be.
        extension: foot -> (T,) share of its length to which the dancer's leg is extended, if there is one.
    """
    kinematics = Kinematics(JointTree(robot), y)
    middle = np.mean([kinematics.frame_pose(robot.point(f"{side}_hip"))[1][:, 2] for side in SIDES], axis=0)
    highest = np.full(len(y), np.inf)
    for foot, path in feet.items():
        side = foot.removesuffix("_foot")
        rotation, at = kinematics.frame_pose(robot.point(foot))
        hip, knee, ankle = (
            kinematics.frame_pose(robot.point(f"{side}_{point}"))[1] for point in ("hip", "knee", "ankle")
        )
        leg = np.linalg.norm(knee - hip, axis=1) + np.linalg.norm(ankle - knee, axis=1)
        own = np.einsum("tji,tj->ti", rotation, ankle - at)
        target = path.position + np.einsum("tij,tj->ti", path.rotation, own)
        flat = np.sum((hip - target)[:, :2] ** 2, axis=1)
        most = np.clip(extension.get(foot, LEG_EXTENSION_RANGE[0]), *LEG_EXTENSION_RANGE)
        above = np.sqrt(np.maximum((most * leg) ** 2 - flat, 0.0))
        beyond = path.yielding * leg  # a foot that yields comes along with the hips
        highest = np.minimum(highest, target[:, 2] + above + beyond - (hip[:, 2] - middle))
    return highest


def smooth_height_below(wanted: Array, highest: Array, period: float, held: Spline | None = None) -> Spline:
    """Smooth height nearest to the wanted one (T,) that stays below the highest one (T,) [m], as a spline.

    held: keep its first and last three control points; both ends are at rest without it.
    """
    length = len(wanted)
    n = length + 2
    if held is None:
        ends = np.minimum(wanted, highest)[[0, -1]]
        start, stop = ends[:1], ends[1:]
        fallen = 0.5 * END_ACCELERATION_SHARE * MAX_HIP_ACCELERATION * (period * np.arange(length)) ** 2
        highest = np.maximum(highest, np.maximum(start - fallen, stop - fallen[::-1]))
    else:
        start, stop, highest = held.control[:3, 0], held.control[-3:, 0], highest.copy()
        edge = [0, 1, -2, -1]
        highest[edge] = np.maximum(highest[edge], held.knots[edge, 0] + HELD_HEIGHT_ROOM)

    def rows(stencil: Array) -> sp.dia_array:
        return sp.diags_array(
            [value * np.ones(n) for value in stencil],
            offsets=list(range(len(stencil))),
            shape=(n - len(stencil) + 1, n),
        )

    A = sp.vstack([rows(VALUE_STENCIL), rows(np.array([1.0, -2.0, 1.0]) / period**2)], format="csr")
    bend = np.full(length, MAX_HIP_ACCELERATION)
    qp = BandedQP(A, np.concatenate([np.full(length, -np.inf), -bend]), np.concatenate([highest, bend]), 3)
    value = rows(VALUE_STENCIL / ACCEPTED_HEIGHT_ERROR)
    jerk = rows(np.array([-1.0, 3.0, -3.0, 1.0]) / (period**3 * ACCEPTED_JERK))
    hold = sp.diags_array(HELD_END_WEIGHT * np.isin(np.arange(n), [0, 1, 2, n - 3, n - 2, n - 1]))
    H = (value.T @ value + jerk.T @ jerk + hold).todia()
    banded = np.zeros((n, 4))
    for apart in range(4):
        banded[: n - apart, apart] = H.diagonal(-apart)
    around = np.concatenate([wanted[:1], wanted, wanted[-1:]])
    around[:3], around[-3:] = start, stop
    g = value.T @ (value @ around - wanted / ACCEPTED_HEIGHT_ERROR) + jerk.T @ (jerk @ around)
    return Spline(qp.solve(banded, g, around).x[:, None], period)
