"""Rounds of balance and body, each on the other's result: over the whole clip, then where it is not settled yet."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.grip import Grip
from sot.motion.balance.programme import plan_balance
from sot.motion.body.clearance import Clearance, ClearBody
from sot.motion.body.coordinates import to_pinocchio
from sot.motion.body.height import reachable_hip_height, smooth_height_below
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.limits import Limits
from sot.motion.body.parts import Body
from sot.motion.body.retarget import PartFit, solve_knots
from sot.motion.body.spline import Spline
from sot.motion.body.targets import Targets
from sot.motion.feet.contacts import Phase
from sot.motion.feet.stance import Build
from sot.motion.feet.support import Support, supports
from sot.motion.feet.swing import FootPath, any_foot_moves
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

WHOLE_CLIP_ITERATIONS_ROUGH, WHOLE_CLIP_ITERATIONS = 3, 1  # rounds over the whole clip: of a rough motion, of others
WINDOW_ITERATIONS = 2  # rounds of a window, before what is not settled is cut into windows anew
WINDOW_ATTEMPTS = 3  # times that it is cut into windows
WINDOW_OVERLAP_S = 1.2  # before and after what is not settled, that may give way: four time constants of a pendulum
MIN_ZMP_MARGIN = 0.01  # m, from the ZMP to the edge of the support, for longer than an instant
MAX_FOOT_ERROR = 0.002  # m, of a foot off its path
RELAXATION = 0.75  # of the way from what a round was planned on to what came of it: a full step oscillates
ZMP_TOLERANCE = 0.005  # m, of the ZMP off its plan: less ends the rounds
MAX_STRAINED_SHARE_LEFT = (
    0.5  # of the strained knots, that two rounds may leave: if more are left, further rounds do not help
)
ZMP_TOLERANCE_STEPPING = 0.04  # m, of the ZMP off its plan where feet step and nothing is strained


class BalanceRounds:
    """Base, legs and chest of a motion fitted to a CoM that keeps the ZMP in the soles.

    What the ZMP depends on, the height of the CoM and the angular momentum, changes with the body: hence rounds, until
    the ZMP is where it was planned, or on feet that step until nothing is strained.

    Attributes:
        body_motion: the motion, as far as it has been balanced.
    """

    def __init__(
        self,
        robot: Robot,
        build: Build,
        wanted: Targets,
        feet: Mapping[str, FootPath],
        phases: Sequence[Phase],
        limits: Limits,
        body_motion: Spline,
    ):
        """
        Args:
            robot: whose motion it is.
            build: of the robot.
            wanted: the body's targets.
            feet: where they are to be.
            phases: which stand where, when.
            limits: of the joints.
            body_motion: motion to start from.
        """
        self.body_motion = Spline(body_motion.control.copy(), body_motion.period)
        self._robot, self._build, self._human, self._feet, self._limits = robot, build, wanted, feet, limits
        self._supports, self._steps = supports(robot, phases), any_foot_moves(feet)
        self._legs = Clearance.of_legs(robot, wanted.length)
        self._lowers = self._steps and wanted.height is None
        times: Array = body_motion.period * np.arange(wanted.length, dtype=float)
        self._grip = Grip(robot, phases, times) if self._steps else None
        self._state = _centroidal_state(self.body_motion, robot)
        self._asked = deepcopy(self._state)
        self._strained = np.zeros(wanted.length, bool)
        self._fits: dict[int, PartFit] = {}  # by number of knots
        self._wanted_com = self._state.com[:, :2].copy()
        self._com = Spline.through(self._wanted_com, body_motion.period)
        self._height = Spline.through(wanted.hips[:, 2:], body_motion.period)
        if self._lowers:
            self._lower_hips(self._everything)

    def balance_all(self, rough: bool = False) -> Array:
        """Balances all of the motion.

        rough: it is fresh from `retarget`: its accelerations mean nothing yet.

        Returns:
            The times (n,) at which feet that step still ask too much of it (see `strained_knots`) [s].
        """
        if rough:
            self._asked.rate[:] = 0.0
            self._fit_each_knot()
        for _ in range(WHOLE_CLIP_ITERATIONS_ROUGH if rough else WHOLE_CLIP_ITERATIONS):
            left = self._round(self._everything)
            if not left.any():
                break
        return self.balance_about(left)

    def balance_about(self, changed: Flags) -> Array:
        """Balances the motion about the knots (T,) at which it is not what has been balanced before.

        Returns:
            The times (n,) there at which feet that step still ask too much of it [s].
        """
        left = changed.copy()
        for attempt in range(WINDOW_ATTEMPTS):
            for part in _windows(left, round(WINDOW_OVERLAP_S / self.body_motion.period)):
                before = int(self._strained[part].sum())
                for _ in range(WINDOW_ITERATIONS):
                    left[part] = self._round(part)
                    if not left[part].any():
                        break
                if attempt and self._strained[part].sum() > MAX_STRAINED_SHARE_LEFT * before:
                    left[part] = False
        return self.body_motion.period * np.flatnonzero(self._strained).astype(float)

    @property
    def _everything(self) -> slice:
        return slice(0, self._human.length)

    def _fit_each_knot(self) -> None:
        """Fits every knot for itself, after which the motion's accelerations mean something."""
        self._plan_com_and_zmp(self._everything)
        body = Body(self._robot, self._build, self._body_targets(), self._feet, self._com.knots)
        y = self.body_motion.knots
        y[:, body.columns], _ = solve_knots(body, np.arange(len(y)), y, self._limits)
        self.body_motion = Spline.through(y, self.body_motion.period)
        self.body_motion.control[:3] = y[0]  # at rest

    def _round(self, part: slice) -> Flags:
        """Plans and fits a part of the knots once; returns which of them (n,) are not settled by it."""
        robot, period = self._robot, self.body_motion.period
        if self._lowers:
            self._lower_hips(part)
        zmp = self._plan_com_and_zmp(part)
        body = ClearBody(robot, self._build, self._body_targets(), self._feet, self._legs, self._com.knots)
        control, y = slice(part.start, part.stop + 2), self.body_motion.knots[part]
        if len(y) not in self._fits:
            self._fits[len(y)] = PartFit(
                body.columns, len(y), period, self._limits, rest_at_end=part == self._everything
            )
        bends = self._grip.excess(y, self._state[part], part.start) if self._grip else None
        spline = Spline(self.body_motion.control[control][:, body.columns], period)
        self.body_motion.control[control, body.columns] = (
            self._fits[len(y)].refine(body, spline, y, 1, bends, part.start).control
        )
        state = _centroidal_state(self.body_motion, robot, period * np.arange(part.start, part.stop))
        self._state[part] = state
        self._asked[part] = self._asked[part].toward(state, RELAXATION)
        off = np.abs(state.zmp() - zmp).max(axis=1)
        if not self._steps:
            return off > ZMP_TOLERANCE
        self._strained[part] = strained_knots(robot, self._feet, self._supports, self.body_motion, state, part)
        return (
            self._strained[part] | (off > ZMP_TOLERANCE_STEPPING)
            if off.max() > ZMP_TOLERANCE
            else np.zeros(len(off), bool)
        )

    def _body_targets(self) -> Targets:
        """The body's targets, with hips as low as legs have to reach."""
        return replace(self._human, hips=np.column_stack([self._human.hips[:, :2], self._height.knots]))

    def _plan_com_and_zmp(self, part: slice) -> Array:
        """Plans the CoM over a part of the knots; the ZMP (n, 2) there."""
        wanted, period, held = self._wanted_com[part], self._com.period, self._held_ends(self._com, part)
        plan = plan_balance(self._asked[part], wanted, self._supports, period, period * part.start, held)
        self._com.control[part.start : part.stop + 2] = plan.com.control
        return plan.zmp

    def _lower_hips(self, part: slice) -> None:
        """Lowers the hips, in a part of the knots, to where both legs reach."""
        feet = {
            foot: FootPath(path.position[part], path.rotation[part], path.free[part])
            for foot, path in self._feet.items()
        }
        highest = reachable_hip_height(self._robot, self.body_motion.knots[part], feet)
        low = smooth_height_below(
            self._human.hips[part, 2], highest, self.body_motion.period, self._held_ends(self._height, part)
        )
        self._height.control[part.start : part.stop + 2] = low.control

    def _held_ends(self, spline: Spline, part: slice) -> Spline | None:
        """The spline that holds the ends of a part of it: itself, or None if the part is the whole clip."""
        if part == self._everything:
            return None
        return Spline(spline.control[part.start : part.stop + 2].copy(), spline.period)


def strained_knots(
    robot: Robot,
    feet: Mapping[str, FootPath],
    where: Sequence[Support],
    body_motion: Spline,
    state: Centroidal,
    part: slice,
) -> Flags:
    """Flags (n,) of the knots of a part at which a body cannot do what its feet are to do.

    Its ZMP leaves where the feet carry, or stays near their edge, there or half way to the next knot; or a foot is off
    its way.

    state: its own at the knots of the part.
    """
    times = body_motion.period * (part.start + 0.5 * np.arange(2 * len(state.com) - 1))
    zmp, margin = np.empty((len(times), 2)), np.empty(len(times))
    zmp[::2], zmp[1::2] = state.zmp(), _centroidal_state(body_motion, robot, times[1::2]).zmp()
    for support, stop in zip(where, [*(support.start for support in where[1:]), np.inf], strict=True):
        rows = (times >= support.start) & (times < stop)
        margin[rows] = support.polygon.margin(zmp[rows])
    near = np.pad(margin < MIN_ZMP_MARGIN, 1)
    outside = (margin < 0.0) | (near[1:-1] & (near[:-2] | near[2:]))
    bad = outside[::2].copy()
    bad[:-1] |= outside[1::2]
    bad[1:] |= outside[1::2]
    kinematics = Kinematics(JointTree(robot), body_motion.knots[part])
    for foot, path in feet.items():
        away = kinematics.frame_pose(robot.point(foot))[1] - path.position[part]
        bad |= np.linalg.norm(away, axis=1) > MAX_FOOT_ERROR
    return bad


def _windows(flags: Flags, around: int) -> list[slice]:
    """The windows of knots that are no further than `around` from flagged ones (T,)."""
    near = binary_dilation(flags, iterations=around)
    edges = np.flatnonzero(np.diff(near.astype(np.int8), prepend=0, append=0))
    return [slice(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def _centroidal_state(body_motion: Spline, robot: Robot, times: Array | None = None) -> Centroidal:
    """The centroidal quantities of a motion at times (n,) [s], by default at its knots."""
    if times is None:
        return Centroidal.along(
            robot, *to_pinocchio(body_motion.knots, body_motion.velocities, body_motion.accelerations)
        )
    return Centroidal.along(robot, *to_pinocchio(*(body_motion(times, derivative) for derivative in range(3))))
