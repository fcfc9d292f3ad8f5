"""Hips low enough for both legs to reach, without bouncing: a smooth height below what the legs' lengths allow."""

from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from solvers.banded import BandedQP
from sot.motion.kinematics import Chains, Kinematics
from sot.motion.spline import AT_KNOT
from sot.motion.swing import FootPath
from sot.robot import Robot

Array = NDArray[np.float64]

STRETCHED = 0.975  # of its length, how far a leg may reach: what is left is for the closed loop
LIFT = 2.5  # m/s², of the hips up or down
HEIGHT_ERROR = 0.02  # m, a deviation that costs as much as JERK_ERROR
JERK_ERROR = 20.0  # m/s³
HELD = 1e9  # weight that holds both ends at rest


def reachable(robot: Robot, y: Array, feet: Mapping[str, FootPath]) -> Array:
    """The greatest height (T,) of the waist frame [m] from which both legs reach their feet.

    Args:
        y: (T, nv) coordinates, of which the base's place and orientation count.
        feet: where the feet are to be.
    """
    kinematics = Kinematics(Chains(robot), y)
    waist = y[:, 2]
    highest = np.full(len(y), np.inf)
    for foot, path in feet.items():
        side = foot.removesuffix("_foot")
        rotation, at = kinematics.frame(robot.point(foot))
        hip, knee, ankle = (kinematics.frame(robot.point(f"{side}_{point}"))[1] for point in ("hip", "knee", "ankle"))
        leg = np.linalg.norm(knee - hip, axis=1) + np.linalg.norm(ankle - knee, axis=1)
        own = np.einsum("tji,tj->ti", rotation, ankle - at)
        target = path.position + np.einsum("tij,tj->ti", path.rotation, own)
        flat = np.sum((hip - target)[:, :2] ** 2, axis=1)
        above = np.sqrt(np.maximum((STRETCHED * leg) ** 2 - flat, 0.0))
        highest = np.minimum(highest, target[:, 2] + above - (hip[:, 2] - waist))
    return highest


def lowered(wanted: Array, highest: Array, period: float) -> Array:
    """The smooth height (T,) nearest to the wanted one (T,) that stays below the highest one (T,) [m]."""
    length = len(wanted)
    n = length + 2

    def rows(stencil: Array) -> sp.dia_array:
        return sp.diags_array(
            [value * np.ones(n) for value in stencil],
            offsets=list(range(len(stencil))),
            shape=(n - len(stencil) + 1, n),
        )

    A = sp.vstack([rows(AT_KNOT), rows(np.array([1.0, -2.0, 1.0]) / period**2)], format="csr")
    bend = np.full(length, LIFT)
    ends = np.minimum(wanted, highest)[[0, -1]]
    qp = BandedQP(
        A, np.concatenate([np.full(length, -np.inf), -bend]), np.concatenate([np.maximum(highest, ends.min()), bend]), 3
    )
    value = rows(AT_KNOT / HEIGHT_ERROR)
    jerk = rows(np.array([-1.0, 3.0, -3.0, 1.0]) / (period**3 * JERK_ERROR))
    hold = sp.diags_array(HELD * np.isin(np.arange(n), [0, 1, 2, n - 3, n - 2, n - 1]))
    H = (value.T @ value + jerk.T @ jerk + hold).todia()
    banded = np.zeros((n, 4))
    for apart in range(4):
        banded[: n - apart, apart] = H.diagonal(-apart)
    around = np.concatenate([ends[:1], wanted, ends[1:]])
    around[:3], around[-3:] = ends[0], ends[1]
    g = value.T @ (value @ around - wanted / HEIGHT_ERROR) + jerk.T @ (jerk @ around)
    control = qp.solve(banded, g, around).x
    return AT_KNOT[0] * control[:-2] + AT_KNOT[1] * control[1:-1] + AT_KNOT[2] * control[2:]
