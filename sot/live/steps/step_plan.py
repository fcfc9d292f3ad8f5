"""The steps that are decided for the robot, and what supports it meanwhile."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.behaviours.stride import BUMP_CURVATURE, bump_curve
from sot.control.pose import Pose
from sot.gravity import GRAVITY
from sot.live.com_preview import COM_MARGIN_PER_SOLE, shrunk_within
from sot.live.steps.leg_momentum import ZmpShift
from sot.live.steps.person_steps import AskedStep
from sot.motion.feet.contacts import Phase
from sot.motion.feet.footholds import LegReach, body_axes
from sot.motion.feet.footwork import Foothold
from sot.motion.feet.support import FORCE_RAMP_TIME, support_over
from sot.motion.feet.swing import SWING_HEIGHT_RANGE, feet_at_rest, foot_pose
from sot.polygon import Polygon
from sot.robots.leg_range import normals
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk_curve

Array = NDArray[np.float64]

MAX_LIFT_ACCELERATION_G = 0.5
"""Bound of a foot's acceleration upward in a step, unless it has to clear the floor, in g."""
TOLERANCE = 1e-6
"""Of times [s]."""


@dataclass
class DecidedStep:
    """A step that the robot makes.

    Attributes:
        foot: which one.
        lift, land: when it leaves the floor, and when it is back [s].
        start, place: from where to where.
        asked: the person's step that it follows.
        aimed: where that was expected to end, as far as the foot has been led there.
        part: of the way to where the person's step ends in the robot's reach that it makes.
        late: by how much later than planned the foot is counted on to stand [s].
    """

    foot: str
    lift: float
    land: float
    start: Foothold
    place: Foothold
    asked: AskedStep
    aimed: Foothold
    part: float = 1.0
    late: float = 0.0

    @property
    def stands(self) -> float:
        """When the foot is counted on to stand [s]."""
        return self.land + self.late

    def put_off(self, time: float) -> None:
        """Let a step that has not begun begin later by a time [s]."""
        self.lift += time
        self.land += time


@dataclass(frozen=True, eq=False)
class Room:
    """Where the zero-moment point and the centre of mass may be, and what the former is nearest to by choice.

    Attributes:
        inside: room that a plan may use.
        centre: (2,) of the soles that carry [m].
        middle: (2,) place inside that is nearest to it [m].
        restful: where the centre of mass may be for long.
        is_single: whether one foot carries alone.
        reach: where the legs of these feet allow the centre of mass to be.
    """

    inside: Polygon
    centre: Array
    middle: Array
    restful: Polygon
    is_single: bool
    reach: Polygon


class Rooms:
    """The room of the zero-moment point over feet that stand, by where they stand: the last few are remembered.

    Args:
        robot: whose feet.
        reach: of its legs.
        hips: middle of its hips from the centre of mass at rest (2,) [m].
    """

    def __init__(self, robot: Robot, reach: LegReach, hips: Array) -> None:
        self._robot, self._rest, self._reach, self._hips = robot, feet_at_rest(robot), reach, hips
        self._sole = np.ptp(robot.sole(robot.feet[0])[:, :2], axis=0)
        self._known: dict[tuple[tuple[str, Foothold], ...], Room] = {}

    def __call__(self, stands: Mapping[str, Foothold]) -> Room:
        """The room over some feet."""
        key = tuple(stands.items())
        if key not in self._known:
            if len(self._known) > 50:
                self._known.clear()
            phase = Phase(0.0, 1.0, {foot: foot_pose(at, self._rest[foot]) for foot, at in stands.items()})
            support = support_over(self._robot, phase, 0.0, 0.0)
            soles = [pose.act(self._robot.sole(foot).mean(axis=0))[:2] for foot, pose in phase.feet.items()]
            centre = np.mean(soles, axis=0)
            middle = support.inset.nearest_point(centre)
            heading = float(np.angle(np.sum([np.exp(1j * at.heading) for at in stands.values()])))
            restful = shrunk_within(support.polygon, self._sole * COM_MARGIN_PER_SOLE, heading)
            reach = self._reach_of(stands, heading)
            self._known[key] = Room(support.inset, centre, middle, restful, len(stands) == 1, reach)
        return self._known[key]

    def _reach_of(self, stands: Mapping[str, Foothold], heading: float) -> Polygon:
        """Where the centre of mass may be so that each of some feet is in its hip's reach, the pelvis between them."""
        axes = body_axes(heading, heading)
        ways, found = normals() @ axes, []
        for foot, at in stands.items():
            hip = self._hips + np.array([0.0, (0.5 if foot == "left_foot" else -0.5) * self._reach.hip_width])
            found.append(self._reach.carrying[foot] - ways @ (np.array([at.x, at.y]) - hip @ axes))
        return Polygon(np.tile(-ways, (len(stands), 1)), np.concatenate(found))


def foothold_of(pose: pin.SE3, rest: pin.SE3) -> Foothold:
    """The foothold at which a foot's frame has a pose; rest: its pose at rest, of `feet_at_rest`."""
    at = pose * rest.inverse()
    return Foothold(
        float(at.translation[0]), float(at.translation[1]), float(np.arctan2(at.rotation[1, 0], at.rotation[0, 0]))
    )


class StandingPoses:
    """Poses of feet that stand; the last of each foot is remembered.

    Args:
        robot: whose feet.
    """

    def __init__(self, robot: Robot) -> None:
        self._rest, self._known = feet_at_rest(robot), dict[str, tuple[Foothold, Pose]]()

    def __call__(self, foot: str, at: Foothold) -> Pose:
        """The pose of a foot at a foothold, at rest."""
        known = self._known.get(foot)
        if known is None or known[0] is not at:
            place = foot_pose(at, self._rest[foot])
            known = self._known[foot] = at, Pose(place.translation.copy(), place.rotation.copy(), *np.zeros((2, 6)))
        return known[1]


def rooms_at(
    times: Array, stands: Mapping[str, Foothold], steps: Sequence[DecidedStep], rooms: Rooms
) -> tuple[list[Room], Mapping[str, Foothold]]:
    """The room at each time (n,), and where the feet stand in the end.

    A foot is not counted on to carry from FORCE_RAMP_TIME before it lifts to as long after it has landed.
    """
    found: list[Room] = []
    now, pending, known = dict(stands), list(steps), dict[tuple[int, bool], Room]()
    for t in times:
        while pending and t > pending[0].stands + FORCE_RAMP_TIME + TOLERANCE:
            done = pending.pop(0)
            now[done.foot] = done.place
        step = pending[0] if pending else None
        lifted = step.foot if step is not None and t > step.lift - FORCE_RAMP_TIME - TOLERANCE else None
        when = len(pending), lifted is not None
        if when not in known:
            known[when] = rooms({foot: at for foot, at in now.items() if foot != lifted})
        found.append(known[when])
    for step in pending:
        now[step.foot] = step.place
    return found, now


def lift_height(step: DecidedStep, leg: float, scale: float) -> float:
    """How high a foot gets in a step [m], with legs of a length [m], and lengths of a share of the person's."""
    low, high = (share * leg for share in SWING_HEIGHT_RANGE)
    high = min(high, MAX_LIFT_ACCELERATION_G * GRAVITY / BUMP_CURVATURE * (step.land - step.lift) ** 2)
    return max(min(scale * step.asked.height, high), low)


def swing_shift(step: DecidedStep, height: float, times: Array, shift: ZmpShift) -> Array:
    """How far a step, whose foot gets so high [m], moves the zero-moment point at times (n,), (n, 2) [m]."""
    span = step.land - step.lift
    share = np.clip((times - step.lift) / span, 0.0, 1.0)
    way = np.array([step.place.x - step.start.x, step.place.y - step.start.y])
    ahead = np.array([np.cos(step.start.heading), np.sin(step.start.heading)])
    along, up = minimum_jerk_curve(share)[:, None], bump_curve(share)[:, None]
    return np.asarray((shift.along * along * way + shift.ahead * up * height * ahead) / span**2)


def zmp_wishes(rooms: Sequence[Room], lean: Array, later: Array, future: Sequence[tuple[float, Array]]) -> Array:
    """Where the zero-moment point would best be in each of some rooms (n, 2) [m].

    Args:
        rooms: n of them.
        lean: where the centre of mass is wanted now, from the middle of what carries (2,) [m].
        later: when each room is, from now (n,) [s].
        future: how much later [s] it will be wanted how much farther (2,) [m], in order; the last stays.
    """
    if not future:
        wishes = {room: _wish(room, lean) for room in dict.fromkeys(rooms)}
        return np.array([wishes[room] for room in rooms])
    at, way = np.array([0.0, *(time for time, _ in future)]), np.vstack([np.zeros(2), *(way for _, way in future)])
    shift = np.column_stack([np.interp(later, at, column) for column in way.T])
    return np.array([_wish(room, lean + more) for room, more in zip(rooms, shift, strict=True)])


def _wish(room: Room, lean: Array) -> Array:
    return room.middle if room.is_single else room.restful.nearest_point(room.centre + lean)
