"""Rounds of balance and body, each on the other's result: over the whole clip, then where it is not settled yet."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from sot.motion.balance.com_reach import ComReach
from sot.motion.balance.grip import Grip
from sot.motion.balance.long_stance import centred_on_long_stances
from sot.motion.balance.programme import plan_balance
from sot.motion.balance.relief import RelievedBody
from sot.motion.balance.strain import centroidal_state, feet_strain, strain
from sot.motion.body.clearance import Clearance, ClearBody
from sot.motion.body.height import reachable_hip_height, smooth_height_below
from sot.motion.body.limits import Limits
from sot.motion.body.parts import Body, Part
from sot.motion.body.retarget import PartFit, solve_knots
from sot.motion.body.spline import Spline
from sot.motion.body.targets import Targets
from sot.motion.feet.contacts import Phase
from sot.motion.feet.stance import Build
from sot.motion.feet.support import supports
from sot.motion.feet.swing import FootPath, any_foot_moves, mean_ground
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

WHOLE_CLIP_ITERATIONS_ROUGH, WHOLE_CLIP_ITERATIONS = 3, 1  # rounds over the whole clip: of a rough motion, of others
WINDOW_ITERATIONS = 2  # rounds of a window, before what is not settled is cut into windows anew
WINDOW_ATTEMPTS = 3  # times that it is cut into windows
WINDOW_OVERLAP_S = 1.2  # before and after what is not settled, that may give way: four time constants of a pendulum
RELAXATION = 0.75  # of the way from what a round was planned on to what came of it: a full step oscillates
ZMP_TOLERANCE = 0.0083  # leg lengths, of the ZMP off its plan: less ends the rounds
MAX_STRAINED_SHARE_LEFT = (
    0.5  # of the strained knots, that two rounds may leave: if more are left, further rounds do not help
)
ZMP_TOLERANCE_STEPPING = 0.0666  # leg lengths, of the ZMP off its plan where feet step and nothing is strained


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
        relieved: bool = False,
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
            relieved: whether its posture is to relieve the motors of a leg that stands alone.
        """
        self.body_motion = Spline(body_motion.control.copy(), body_motion.period)
        self._robot, self._build, self._human, self._feet, self._limits = robot, build, wanted, feet, limits
        self._supports, self._steps = supports(robot, phases), any_foot_moves(feet)
        self._legs = Clearance.of_legs(robot, wanted.length)
        self._lowers = self._steps and wanted.height is None
        times: Array = body_motion.period * np.arange(wanted.length, dtype=float)
        self._com_reach = ComReach(robot, build, feet)
        self._relieved_phases = phases if relieved else None
        self._grip = Grip(robot, phases, times) if self._steps else None
        self._ground = mean_ground(feet)
        self._state = centroidal_state(self.body_motion, robot, None, self._ground)
        self._asked = deepcopy(self._state)
        self._strain = np.zeros(wanted.length)
        self._rated = np.zeros(wanted.length, bool)  # knots of which the strain is known
        self._fits: dict[int, PartFit] = {}  # by number of knots
        self._wanted_com = centred_on_long_stances(robot, phases, feet, self._state.com[:, :2], body_motion.period)
        self._com = Spline.through(self._wanted_com, body_motion.period)
        self._height = Spline.through(wanted.hips[:, 2:], body_motion.period)
        if self._lowers:
            self._lower_hips(self._everything)

    def balance_all(self, rough: bool = False) -> Array:
        """Balances all of the motion.

        rough: it is fresh from `retarget`: its accelerations mean nothing yet.

        Returns:
            The times (n,) at which feet that step still ask too much of it (see `strain.strain`) [s].
        """
        if rough:
            self._asked.rate[:] = 0.0
            self._plan_com_and_zmp(self._everything)
            self._fit_each_knot(np.arange(self._human.length))
        count = WHOLE_CLIP_ITERATIONS_ROUGH if rough else WHOLE_CLIP_ITERATIONS
        left, _ = self._improve(self._everything, np.ones(self._human.length, bool), count)
        return self.balance_about(left)

    def approach(self, changed: Flags) -> None:
        """Brings the motion near what its feet are to do about the knots (T,) at which they do something else now."""
        self._fit_each_knot(np.flatnonzero(changed))
        for part in self._windows_about(changed):
            self._improve(part, changed[part], WINDOW_ITERATIONS)

    def balance_about(self, changed: Flags, rough: bool = False) -> Array:
        """Balances the motion about the knots (T,) at which it is not what has been balanced before.

        rough: it is not even near what its feet are to do there.

        Returns:
            The times (n,) there at which feet that step still ask too much of it [s].
        """
        if rough:
            self._fit_each_knot(np.flatnonzero(changed))
        left = changed.copy()
        for attempt in range(WINDOW_ATTEMPTS):
            for part in self._windows_about(left):
                before = self._count_strained(part)
                left[part], worse = self._improve(part, left[part], WINDOW_ITERATIONS)
                if worse or (attempt and self._count_strained(part) > MAX_STRAINED_SHARE_LEFT * before):
                    left[part] = False
        return self.body_motion.period * np.flatnonzero(self._steps & (self._strain > 0.0)).astype(float)

    @property
    def _everything(self) -> slice:
        return slice(0, self._human.length)

    def _windows_about(self, flags: Flags) -> list[slice]:
        return _windows(flags, round(WINDOW_OVERLAP_S / self.body_motion.period))

    def _count_strained(self, part: slice) -> int:
        return int(self._steps and (self._strain[part] > 0.0).sum())

    def _improve(self, part: slice, left: Flags, count: int) -> tuple[Flags, bool]:
        """Makes at most `count` rounds over a part of the knots, until it is settled or a round is worse than the last.

        The worse round is undone. left: (n,) which knots were not settled before. Returns which are not afterwards, and
        whether a round was worse.
        """
        for _ in range(count):
            kept = [array[rows].copy() for array, rows in self._changed_by_round(part)]
            before = self._strain[part].sum() if self._rated[part].all() else np.finfo(float).max
            try:
                now = self._round(part)
                worse = not self._strain[part].sum() <= before
            except np.linalg.LinAlgError:  # a motion that left all bounds makes programmes without a minimum
                worse = True
            if worse:
                for (array, rows), values in zip(self._changed_by_round(part), kept, strict=True):
                    array[rows] = values
                return left, True
            left, self._rated[part] = now, True
            if not left.any():
                break
        return left, False

    def _changed_by_round(self, part: slice) -> list[tuple[Array, slice]]:
        """The arrays, and their rows, that a round over a part of the knots changes."""
        splines, control = (self.body_motion, self._com, self._height), slice(part.start, part.stop + 2)
        states = [array for state in (self._state, self._asked) for array in (state.com, state.momentum, state.rate)]
        return [
            *((spline.control, control) for spline in splines),
            *((array, part) for array in (*states, self._strain)),
        ]

    def _fit_each_knot(self, knots: NDArray[np.int_]) -> None:
        """Fits some knots each for itself, after which the motion's accelerations there mean something."""
        self._asked.rate[knots] = 0.0
        body = Body(self._robot, self._build, self._body_targets(), self._feet, self._com.knots)
        y = self.body_motion.knots
        y[knots[:, None], body.columns], _ = solve_knots(body, knots, y[knots], self._limits)
        self.body_motion = Spline.through(y, self.body_motion.period)
        self.body_motion.control[:3], self.body_motion.control[-3:] = y[0], y[-1]  # at rest

    def _round(self, part: slice) -> Flags:
        """Plans and fits a part of the knots once; returns which of them (n,) are not settled by it."""
        robot, period, leg = self._robot, self.body_motion.period, self._build.leg
        if self._lowers:
            self._lower_hips(part)
        zmp = self._plan_com_and_zmp(part)
        body: Part = ClearBody(robot, self._build, self._body_targets(), self._feet, self._legs, self._com.knots)
        if self._relieved_phases:
            body = RelievedBody(body, robot, self._relieved_phases, period)
        control, y = slice(part.start, part.stop + 2), self.body_motion.knots[part]
        if len(y) not in self._fits:
            self._fits[len(y)] = PartFit(
                body.columns, len(y), period, self._limits, rest_at_end=part == self._everything
            )
        in_world = self._state[part].above(-self._ground[part])
        bends = self._grip.excess(y, in_world, part.start) if self._grip else None
        spline = Spline(self.body_motion.control[control][:, body.columns], period)
        self.body_motion.control[control, body.columns] = (
            self._fits[len(y)].refine(body, spline, y, 1, bends, part.start).control
        )
        state = centroidal_state(self.body_motion, robot, period * np.arange(part.start, part.stop), self._ground)
        self._state[part] = state
        self._asked[part] = self._asked[part].toward(state, RELAXATION)
        off = np.abs(state.zmp() - zmp).max(axis=1)
        if not self._steps:
            beyond = np.maximum(off - leg * ZMP_TOLERANCE, feet_strain(robot, self._feet, self.body_motion, part))
            self._strain[part] = np.maximum(beyond, 0.0)
            return beyond > 0.0
        self._strain[part] = strain(robot, self._feet, self._supports, self.body_motion, state, part)
        if off.max() <= leg * ZMP_TOLERANCE:
            return np.zeros(len(off), bool)
        return (self._strain[part] > 0.0) | (off > leg * ZMP_TOLERANCE_STEPPING)

    def _body_targets(self) -> Targets:
        """The body's targets, with hips as low as legs have to reach."""
        return replace(self._human, hips=np.column_stack([self._human.hips[:, :2], self._height.knots]))

    def _plan_com_and_zmp(self, part: slice) -> Array:
        """Plans the CoM over a part of the knots; the ZMP (n, 2) there."""
        y, com = self.body_motion.knots[part], self._state.com[part, :2]
        wanted = self._com_reach.nearest(self._wanted_com[part], com, y, part.start)
        period, held = self._com.period, self._held_ends(self._com, part)
        plan = plan_balance(self._asked[part], wanted, self._supports, period, period * part.start, held)
        self._com.control[part.start : part.stop + 2] = plan.com.control
        return plan.zmp

    def _lower_hips(self, part: slice) -> None:
        """Lowers the hips, in a part of the knots, to where both legs reach."""
        feet = {
            foot: FootPath(path.position[part], path.rotation[part], path.free[part], path.yielding[part])
            for foot, path in self._feet.items()
        }
        extension = {foot: own[part] for foot, own in self._human.extension.items()}
        highest = reachable_hip_height(self._robot, self.body_motion.knots[part], feet, extension)
        low = smooth_height_below(
            self._human.hips[part, 2], highest, self.body_motion.period, self._held_ends(self._height, part)
        )
        self._height.control[part.start : part.stop + 2] = low.control

    def _held_ends(self, spline: Spline, part: slice) -> Spline | None:
        """The spline that holds the ends of a part of it: itself, or None if the part is the whole clip."""
        if part == self._everything:
            return None
        return Spline(spline.control[part.start : part.stop + 2].copy(), spline.period)


def _windows(flags: Flags, around: int) -> list[slice]:
    """The windows of knots that are no further than `around` from flagged ones (T,)."""
    near = binary_dilation(flags, iterations=around)
    edges = np.flatnonzero(np.diff(near.astype(np.int8), prepend=0, append=0))
    return [slice(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]
