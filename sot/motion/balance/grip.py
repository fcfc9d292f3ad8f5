"""What a motion asks of the floor beyond what it gives: load, and friction about the vertical axis.

A ZMP in the sole is not all. A foot that stands alone takes a moment about the vertical axis by friction only, the less
of it the nearer the ZMP is to an edge and the less the body weighs on it; a swinging leg asks for more. Hips and chest
can turn against it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.motion.balance.centroidal import Centroidal, momentum_maps
from sot.motion.feet.contacts import Phase
from sot.motion.feet.support import FORCE_RAMP_TIME
from sot.robots.robot import Robot
from sot.robots.size import leg_length

Array = NDArray[np.float64]

RELIED_FRICTION = 0.5 / np.sqrt(2.0)  # coefficient of the pyramid inside the friction cone that a plan relies upon
SOLE_EDGE = 0.0067  # leg lengths, of a sole's edge that a plan does not rely upon
USED_FRICTION_SHARE = 0.9  # of the friction moment that a plan may use
LOAD_RANGE = 0.6, 1.5  # of the weight, least and greatest load on the floor
ACCEPTED_MOMENT = 0.0088  # weights times leg lengths, beyond friction
ACCEPTED_LOAD = 0.044  # weights, beyond the range


class Grip:
    """What a motion asks beyond what the floor gives, as errors of a fit.

    An error counts at every knot where it ever was there: one that went with its cause would come back with it.

    Args:
        robot: who moves.
        phases: which foot stands where, when.
        times: (T,) of the knots [s].

    Attributes:
        weights: (2,) of a moment [1/(N m)] and of a load [1/N] that is too much.
    """

    def __init__(self, robot: Robot, phases: Sequence[Phase], times: Array):
        self._robot = robot
        self._alone = []
        for phase in phases:
            if len(phase.feet) == 1:
                ((foot, pose),) = phase.feet.items()
                corners = robot.sole(foot)
                half = 0.5 * np.ptp(corners, axis=0)[:2] - SOLE_EDGE * leg_length(robot)
                knots = np.flatnonzero((times > phase.start - FORCE_RAMP_TIME) & (times < phase.end + FORCE_RAMP_TIME))
                self._alone.append((knots, pose.rotation, pose.act(corners.mean(axis=0)), half))
        weight = robot.mass * GRAVITY
        self.weights = 1.0 / (weight * np.array([ACCEPTED_MOMENT * leg_length(robot), ACCEPTED_LOAD]))
        self._asked = np.zeros((len(times), 2), bool)

    def excess(self, y: Array, state: Centroidal, first: int = 0) -> tuple[Array, Array]:
        """Weighted errors (n, 2) of moment and load beyond their ranges, and their Jacobians (n, 2, nv) by the second
        derivatives of the coordinates y (n, nv), at n knots from the first on."""
        mass = self._robot.mass
        force = state.rate[:, :3] + [0.0, 0.0, mass * GRAVITY]
        turning = np.zeros(len(y))
        for alone, rotation, centre, half in self._alone:
            knots = alone[(alone >= first) & (alone < first + len(y))] - first
            lever = np.cross(state.com[knots] - centre, force[knots])
            moment = state.rate[knots, 3:] + lever
            least, most = yaw_moment_range(force[knots] @ rotation, moment @ rotation, half)
            turning[knots] = moment[:, 2] - np.clip(
                moment[:, 2], USED_FRICTION_SHARE * least, USED_FRICTION_SHARE * most
            )
        load = force[:, 2] - np.clip(force[:, 2], LOAD_RANGE[0] * mass * GRAVITY, LOAD_RANGE[1] * mass * GRAVITY)
        errors = self.weights * np.column_stack([turning, load])
        asked = self._asked[first : first + len(y)]
        asked |= errors != 0.0
        J = np.zeros((*errors.shape, y.shape[1]))
        used = np.flatnonzero(asked.any(axis=1))
        if len(used):
            maps = momentum_maps(self._robot, y[used])[:, [5, 2]] * self.weights[:, None]
            J[used] = maps * asked[used, :, None]
        return errors, J


def yaw_moment_range(force: Array, moment: Array, half: Array) -> tuple[Array, Array]:
    """The least and greatest moment (T,) about the vertical axis through a sole's centre that friction gives [N m].

    Caron, Pham and Nakamura 2015, (22), (23): of a rectangle with half-lengths (2,) [m], forces and moments about its
    centre (T, 3) in its axes. Where friction gives nothing, both are the middle of what is asked too much.
    """
    (x, y), mu = half, RELIED_FRICTION
    fx, fy, fz = force.T
    tx, ty = moment[:, 0], moment[:, 1]
    room = mu * (x + y) * fz
    least = -room + np.abs(y * fx - mu * tx) + np.abs(x * fy - mu * ty)
    most = room - np.abs(y * fx + mu * tx) - np.abs(x * fy + mu * ty)
    middle = 0.5 * (least + most)
    return np.minimum(least, middle), np.maximum(most, middle)
