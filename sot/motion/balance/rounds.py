"""Rounds of balance and body, each taking the other's result: over the whole clip, then where it is not settled yet."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from sot.motion.balance.balance import plan_balance
from sot.motion.balance.centroidal import Centroidal
from sot.motion.balance.grip import Grip
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
from sot.motion.feet.swing import FootPath, moving
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

TOGETHER, AGAIN = 3, 1  # rounds over the whole clip, after which much of it is settled: of a rough one, and of others
ROUNDS, ATTEMPTS = 2, 3  # rounds of a part of it, before what is left of it is parted anew, and how often that is done
AROUND = 1.2  # s before and after what is not settled, that may give way for it: four time constants of a pendulum
MARGIN = 0.01  # m, of the ZMP to the edge of what carries: nearer is too near for longer than an instant
OFF = 0.002  # m, greatest of a foot off its way
RELAXED = 0.75  # of the way from what a round was planned on to what came of it: all of it swings back and forth
SETTLED = 0.005  # m, of the ZMP off its plan, ends the rounds
HELPED = 0.5  # of what was strained: if two rounds leave more, more of them are no help
NEARLY = 0.04  # m, the same where feet step and nothing is strained


class Rounds:
    """Base, legs and chest of a motion fitted to a CoM that keeps the ZMP in the soles.

    What the ZMP depends on, the height of the CoM and the angular momentum, changes with the body: hence rounds, until
    the ZMP is where it was planned, or on feet that step until nothing is strained.

    Attributes:
        whole: the motion, as far as it has been balanced.
    """

    def __init__(
        self,
        robot: Robot,
        build: Build,
        wanted: Targets,
        feet: Mapping[str, FootPath],
        phases: Sequence[Phase],
        limits: Limits,
        whole: Spline,
    ):
        """
        Args:
            robot: whose motion it is.
            build: of the robot.
            wanted: the body's targets.
            feet: where they are to be.
            phases: which stand where, when.
            limits: of the joints.
            whole: motion to start from.
        """
        self.whole = Spline(whole.control.copy(), whole.period)
        self._robot, self._build, self._human, self._feet, self._limits = robot, build, wanted, feet, limits
        self._supports, self._steps = supports(robot, phases), moving(feet)
        self._legs = Clearance.of_legs(robot, wanted.length)
        self._lowers = self._steps and wanted.height is None
        times: Array = whole.period * np.arange(wanted.length, dtype=float)
        self._grip = Grip(robot, phases, times) if self._steps else None
        self._state = _centroidal(self.whole, robot)
        self._asked = deepcopy(self._state)
        self._strained = np.zeros(wanted.length, bool)
        self._fits: dict[int, PartFit] = {}  # by number of knots
        self._wanted_com = self._state.com[:, :2].copy()
        self._com = Spline.through(self._wanted_com, whole.period)
        self._height = Spline.through(wanted.hips[:, 2:], whole.period)
        if self._lowers:
            self._lower(self._everything)

    def everywhere(self, rough: bool = False) -> Array:
        """Balances all of the motion.

        rough: it is fresh from `retarget`: its accelerations mean nothing yet.

        Returns:
            The times (n,) at which feet that step still ask too much of it (see `strained`) [s].
        """
        if rough:
            self._asked.rate[:] = 0.0
            self._knot_by_knot()
        for _ in range(TOGETHER if rough else AGAIN):
            left = self._round(self._everything)
            if not left.any():
                break
        return self.about(left)

    def about(self, changed: Flags) -> Array:
        """Balances the motion about the knots (T,) at which it is not what has been balanced before.

        Returns:
            The times (n,) there at which feet that step still ask too much of it [s].
        """
        left = changed.copy()
        for attempt in range(ATTEMPTS):
            for part in _parts(left, round(AROUND / self.whole.period)):
                before = int(self._strained[part].sum())
                for _ in range(ROUNDS):
                    left[part] = self._round(part)
                    if not left[part].any():
                        break
                if attempt and self._strained[part].sum() > HELPED * before:
                    left[part] = False
        return self.whole.period * np.flatnonzero(self._strained).astype(float)

    @property
    def _everything(self) -> slice:
        return slice(0, self._human.length)

    def _knot_by_knot(self) -> None:
        """Fits every knot for itself: what the accelerations of a fit are from there on means something."""
        self._plan(self._everything)
        body = Body(self._robot, self._build, self._looks(), self._feet, self._com.knots)
        y = self.whole.knots
        y[:, body.columns], _ = solve_knots(body, np.arange(len(y)), y, self._limits)
        self.whole = Spline.through(y, self.whole.period)
        self.whole.control[:3] = y[0]  # at rest

    def _round(self, part: slice) -> Flags:
        """Plans and fits a part of the knots once: which of them (n,) are not settled by it."""
        robot, period = self._robot, self.whole.period
        if self._lowers:
            self._lower(part)
        zmp = self._plan(part)
        body = ClearBody(robot, self._build, self._looks(), self._feet, self._legs, self._com.knots)
        control, y = slice(part.start, part.stop + 2), self.whole.knots[part]
        if len(y) not in self._fits:
            self._fits[len(y)] = PartFit(
                body.columns, len(y), period, self._limits, rest_at_end=part == self._everything
            )
        bends = self._grip.excess(y, self._state[part], part.start) if self._grip else None
        spline = Spline(self.whole.control[control][:, body.columns], period)
        self.whole.control[control, body.columns] = (
            self._fits[len(y)].refine(body, spline, y, 1, bends, part.start).control
        )
        state = _centroidal(self.whole, robot, period * np.arange(part.start, part.stop))
        self._state[part] = state
        self._asked[part] = self._asked[part].toward(state, RELAXED)
        off = np.abs(state.zmp() - zmp).max(axis=1)
        if not self._steps:
            return off > SETTLED
        self._strained[part] = strained(robot, self._feet, self._supports, self.whole, state, part)
        return self._strained[part] | (off > NEARLY) if off.max() > SETTLED else np.zeros(len(off), bool)

    def _looks(self) -> Targets:
        """The body's, with hips as low as legs have to reach."""
        return replace(self._human, hips=np.column_stack([self._human.hips[:, :2], self._height.knots]))

    def _plan(self, part: slice) -> Array:
        """Plans the CoM over a part of the knots; the ZMP (n, 2) there."""
        wanted, period, held = self._wanted_com[part], self._com.period, self._held(self._com, part)
        plan = plan_balance(self._asked[part], wanted, self._supports, period, period * part.start, held)
        self._com.control[part.start : part.stop + 2] = plan.com.control
        return plan.zmp

    def _lower(self, part: slice) -> None:
        """Lowers the hips, in a part of the knots, to where both legs reach."""
        feet = {foot: FootPath(path.position[part], path.rotation[part]) for foot, path in self._feet.items()}
        highest = reachable_hip_height(self._robot, self.whole.knots[part], feet)
        low = smooth_height_below(self._human.hips[part, 2], highest, self.whole.period, self._held(self._height, part))
        self._height.control[part.start : part.stop + 2] = low.control

    def _held(self, spline: Spline, part: slice) -> Spline | None:
        """What holds the ends of a part of a spline: itself, unless the part is all of it."""
        if part == self._everything:
            return None
        return Spline(spline.control[part.start : part.stop + 2].copy(), spline.period)


def strained(
    robot: Robot,
    feet: Mapping[str, FootPath],
    where: Sequence[Support],
    whole: Spline,
    state: Centroidal,
    part: slice,
) -> Flags:
    """At which of a part of the knots (n,) a body cannot do what its feet are to do.

    Its ZMP leaves where the feet carry, or stays near their edge, there or half way to the next knot; or a foot is off
    its way.

    state: its own at the knots of the part.
    """
    times = whole.period * (part.start + 0.5 * np.arange(2 * len(state.com) - 1))
    zmp, margin = np.empty((len(times), 2)), np.empty(len(times))
    zmp[::2], zmp[1::2] = state.zmp(), _centroidal(whole, robot, times[1::2]).zmp()
    for support, stop in zip(where, [*(support.start for support in where[1:]), np.inf], strict=True):
        rows = (times >= support.start) & (times < stop)
        margin[rows] = support.polygon.margin(zmp[rows])
    near = np.pad(margin < MARGIN, 1)
    outside = (margin < 0.0) | (near[1:-1] & (near[:-2] | near[2:]))
    bad = outside[::2].copy()
    bad[:-1] |= outside[1::2]
    bad[1:] |= outside[1::2]
    kinematics = Kinematics(JointTree(robot), whole.knots[part])
    for foot, path in feet.items():
        away = kinematics.frame_pose(robot.point(foot))[1] - path.position[part]
        bad |= np.linalg.norm(away, axis=1) > OFF
    return bad


def _parts(flags: Flags, around: int) -> list[slice]:
    """The parts of knots (T,) that are no further than so many from flagged ones."""
    near = binary_dilation(flags, iterations=around)
    edges = np.flatnonzero(np.diff(near.astype(np.int8), prepend=0, append=0))
    return [slice(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def _centroidal(whole: Spline, robot: Robot, times: Array | None = None) -> Centroidal:
    """Of all nv coordinates at times (n,) [s], at the knots unless given."""
    if times is None:
        return Centroidal.along(robot, *to_pinocchio(whole.knots, whole.velocities, whole.accelerations))
    return Centroidal.along(robot, *to_pinocchio(*(whole(times, derivative) for derivative in range(3))))
