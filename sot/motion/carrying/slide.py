"""A box on a table that a hand slides to a place, to the side and then ahead: a motion without a human."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pinocchio as pin

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.motion.balance.feet_led import feet_led
from sot.motion.balance.held_load import HeldLoad
from sot.motion.carrying.arms import fist_places, palm_places
from sot.motion.carrying.stoop import Stoop, StoopedArms
from sot.motion.feet.footwork import Foothold
from sot.motion.objects.pose_path import PosePath, blended
from sot.motion.trajectory import Motion
from sot.motion.way import WAITING_TIME, Gait, footsteps_along
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.smooth import minimum_jerk

Array = np.ndarray

KNOT_PERIOD = 0.02  # s, between knots
GAIT = Gait(0.085)  # short steps: soles that step to the side stay apart
PALM_ASIDE, FIST_ASIDE = 0.3, 0.37  # leg lengths, of palm and hand's end from the body's middle while they push
STANDOFF = 0.16  # leg lengths, of the hand from a face before it comes on and after it has left
RAISED = (0.30, 0.50, 0.46)  # leg lengths, of the palm from the waist, ahead, aside and up, on its way over the table
HANDS_PITCH = 0.3  # rad, by which the fingers point down while the palm pushes
STRETCHED_LOWERED, STRETCHED_PITCH = 0.05, 0.5  # leg lengths and rad, of a body whose hand is at full stretch
UPRIGHT = Stoop()
MOVING_TIME, CLOSING_TIME, PUSHING_TIME = 6.0, 6.0, 12.0  # √(leg / g), of the hand from place to place
PAUSE = 1.0  # √(leg / g), before and after steps
MIN_WAY = 0.01  # leg lengths: what is less is not worth a push


@dataclass(frozen=True)
class SlidePlan:
    """A motion that slides a box.

    Attributes:
        motion: of the robot.
        hand: the operational point that pushes.
        path: of that point in the world.
    """

    motion: Motion
    hand: str
    path: PosePath


@dataclass(frozen=True)
class _Key:
    """Where the hand is to be at a time [s], how the trunk is, and where the body stands."""

    time: float
    place: pin.SE3
    stoop: Stoop
    body: Foothold


def slide(
    robot: Robot,
    size: tuple[float, float, float],
    start: Array,
    goal: Array,
    stand: float,
    rate: float = 1000.0,
) -> SlidePlan:
    """The motion of a robot that slides a box on a table with a hand, its faces square to the robot.

    First the palm pushes it to the side while the robot steps to the side; then the end of the same hand pushes it
    ahead. A push of no length is left out.

    Args:
        robot: who pushes; it has surfaces "left_palm", "left_hand_end" and those of the right hand.
        size: of the box [m].
        start, goal: of the box's middle (3,), as high, the goal not nearer; the robot starts at the origin [m].
        stand: how far ahead the robot steps up to the table [m].
        rate: samples per second of the motion [Hz].

    Raises:
        InputError: arms or legs do not reach, or there is no way to push.
    """
    planner = _Planner(robot, size, start, goal)
    planner.push_all(stand)
    return planner.plan(rate)


class _Planner:
    """Collects places of the hand and stops of the body in order of time, and makes a motion of them.

    Args:
        robot: who pushes.
        size, start, goal: see `slide`.
    """

    def __init__(self, robot: Robot, size: tuple[float, float, float], start: Array, goal: Array) -> None:
        self._robot, self._size, self._start, self._goal = robot, size, start, goal
        self._leg = leg_length(robot)
        self._unit = float(np.sqrt(self._leg / GRAVITY))
        self._sign = -1.0 if goal[1] < start[1] else 1.0  # of the way to the side; the left hand pushes to the right
        self._hand = "left_hand" if self._sign < 0.0 else "right_hand"
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, robot.rest)
        self._waist = data.oMf[robot.point("waist")].translation.copy()
        self._rest = data.oMf[robot.point(self._hand)].copy()
        self._stops: list[Foothold] = []
        self._waits: dict[int, float] = {}
        self._keys: list[_Key] = []
        self._now = self._arrived = 0.0

    def push_all(self, stand: float) -> None:
        """The whole motion, from where the robot is `stand` ahead [m]."""
        aside, ahead = float(self._goal[1] - self._start[1]), float(self._goal[0] - self._start[0])
        middle = np.array([self._start[0], self._goal[1], self._start[2]])
        beside = self._sign * (PALM_ASIDE * self._leg - 0.5 * self._size[1])
        if pushes_aside := abs(aside) > MIN_WAY * self._leg:
            self._step(Foothold(stand, float(self._start[1]) + beside, 0.0))
            self._move(self._raised(), MOVING_TIME)
            self._move(self._palm(self._start, STANDOFF * self._leg), MOVING_TIME)
            self._move(self._palm(self._start), CLOSING_TIME)
            self._step(Foothold(stand, float(self._goal[1]) + beside, 0.0), self._palm(middle))
            self._move(self._palm(middle, STANDOFF * self._leg), CLOSING_TIME)
            self._move(self._raised(), MOVING_TIME)
        if ahead > MIN_WAY * self._leg:
            self._step(Foothold(stand, float(self._goal[1]) + self._sign * FIST_ASIDE * self._leg, 0.0))
            if not pushes_aside:
                self._move(self._raised(), MOVING_TIME)
            self._move(self._fist(middle, STANDOFF * self._leg), MOVING_TIME)
            self._move(self._fist(middle), CLOSING_TIME)
            lowered = STRETCHED_LOWERED * self._leg
            self._move(self._fist(self._goal), PUSHING_TIME, Stoop(lowered, STRETCHED_PITCH))
            half = Stoop(0.5 * lowered, 0.5 * STRETCHED_PITCH)
            self._move(self._fist(self._goal, STANDOFF * self._leg), CLOSING_TIME, half)
            self._move(self._raised(), MOVING_TIME)
        if not self._stops:
            raise InputError("the box is where it is to be already")
        self._move(_beside(self._rest, self._stops[-1]), MOVING_TIME)
        self._waits[len(self._stops) - 1] = (self._now - self._arrived) / self._unit + WAITING_TIME

    def plan(self, rate: float) -> SlidePlan:
        """The motion, at a rate [Hz]."""
        robot = self._robot
        walked = footsteps_along(robot, self._stops, gait=GAIT, waits=self._waits)
        knots = KNOT_PERIOD * np.arange(np.ceil(walked.end / KNOT_PERIOD) + 1)
        postures = self._postures()
        arms, kept = robot.joint_numbers("arms"), np.setdiff1d(np.arange(robot.na), robot.joint_numbers("legs"))
        columns = np.tile(postures[0], (len(knots), 1))
        position, rotation = (
            np.tile(part, (len(knots), *(1,) * part.ndim)) for part in (self._rest.translation, self._rest.rotation)
        )
        for (first, begin), (second, end) in pairwise(zip(self._keys, postures, strict=True)):
            rows = knots >= first.time
            share = minimum_jerk((knots[rows] - first.time) / (second.time - first.time))
            columns[rows] = begin + share[:, None] * (end - begin)
            position[rows], rotation[rows] = blended([first.place] * len(share), [second.place] * len(share), share)
        upper = np.tile(robot.rest[7 + kept], (len(knots), 1))
        upper[:, np.searchsorted(kept, arms)] = columns[:, :-2]
        nothing = np.zeros(len(knots))
        load = HeldLoad(
            kept, upper, nothing, "chest", np.zeros((len(knots), 3)), lowered=columns[:, -2], pitch=columns[:, -1]
        )
        phases, paths = walked.feet_at(robot, knots)
        motion = feet_led(robot, phases, paths, KNOT_PERIOD, rate, where="its way", load=load)
        before = knots < self._keys[0].time  # the hand goes with the body until it is led
        track, rows = motion.track(self._hand), np.round(knots[before] * rate).astype(int)
        position[before], rotation[before] = track.position[rows], track.rotation[rows]
        return SlidePlan(motion, self._hand, PosePath.through(knots, position, rotation, rate))

    def _postures(self) -> Array:
        """Angles of the arms, how much the body is lowered and how far it is pitched, at the keys (n, k + 2)."""
        solver, arms = StoopedArms(self._robot), self._robot.joint_numbers("arms")
        found, q = [], self._robot.rest
        for key in self._keys:
            place = pin.SE3(key.place.rotation, key.place.translation - [key.body.x, key.body.y, 0.0])
            q = solver.reaching({self._hand: place}, key.stoop, q)
            found.append([*q[7 + arms], key.stoop.lowered, key.stoop.pitch])
        return np.array(found)

    def _move(self, place: pin.SE3, time: float, stoop: Stoop = UPRIGHT) -> None:
        """The hand goes to a place within a time [√(leg / g)]."""
        self._now += time * self._unit
        self._keys.append(_Key(self._now, place, stoop, self._stops[-1]))

    def _step(self, stop: Foothold, place: pin.SE3 | None = None) -> None:
        """The body steps to a stop; the hand goes to a place meanwhile, or along with the body."""
        if self._keys:
            last, body = self._keys[-1].place, self._stops[-1]
            place = place or _beside(last, Foothold(stop.x - body.x, stop.y - body.y, 0.0))
            self._move(last, PAUSE)
            self._waits[len(self._stops) - 1] = (self._now - self._arrived) / self._unit
        self._stops.append(stop)
        walked = footsteps_along(self._robot, self._stops, gait=GAIT, waits=self._waits)
        self._now = self._arrived = walked.arrivals[-1]
        self._keys.append(_Key(self._now, place or _beside(self._rest, stop), UPRIGHT, stop))

    def _palm(self, box: Array, gap: float = 0.0) -> pin.SE3:
        """The hand whose palm is before the side of a box at a place (3,), a gap away [m]."""
        middle = box - [0.0, self._sign * (0.5 * self._size[1] + gap), 0.0]
        return palm_places(self._robot, 0.0, HANDS_PITCH, middle)[self._hand]

    def _fist(self, box: Array, gap: float = 0.0) -> pin.SE3:
        """The hand whose end is before the front of a box at a place (3,), a gap away [m]."""
        return fist_places(self._robot, 0.0, box - [0.5 * self._size[0] + gap, 0.0, 0.0])[self._hand]

    def _raised(self) -> pin.SE3:
        """The hand above the table's edge, beside the body."""
        body, (ahead, aside, up) = self._stops[-1], RAISED
        middle = self._waist + self._leg * np.array([ahead, -self._sign * aside, up])
        return _beside(palm_places(self._robot, 0.0, HANDS_PITCH, middle)[self._hand], body)


def _beside(place: pin.SE3, body: Foothold) -> pin.SE3:
    """A place that is known from a body at the origin, from where the body is."""
    return pin.SE3(place.rotation, place.translation + np.array([body.x, body.y, 0.0]))
