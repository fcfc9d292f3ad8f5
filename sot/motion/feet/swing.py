"""The paths of a robot's feet: still where they stand, and through the air from foothold to foothold."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.gravity import GRAVITY
from sot.motion.feet.climbing.edge_swing import CLEARANCE, edge_swing
from sot.motion.feet.contacts import Phase
from sot.motion.feet.footholds import LegReach, min_ankle_separation
from sot.motion.feet.footwork import Foothold, Step
from sot.motion.feet.heel_rise import HeelRise, Toes
from sot.robots.robot import Robot
from sot.robots.surface import FLOOR, Surface
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

SWING_HEIGHT_RANGE = 0.07, 0.30  # leg lengths, least and greatest height of a swing
MAX_LIFT_ACCELERATION = 12.0  # m/s², up or down, unless the foot has to clear the floor
HELD_TIME, EASING_TIME = 0.16, 0.57  # √(leg / g), in which a foot keeps to its path at either end, and grows free
HEIGHT_PROFILE_CURVATURE = 28.9  # greatest second derivative of `_height_profile`


@dataclass(frozen=True)
class FootPath:
    """Where a foot's frame is to be at T knots.

    Attributes:
        position: (T, 3) [m].
        rotation: (T, 3, 3).
        free: (T,) by how much the foot may tilt: 1 in the middle of a swing, 0 where it stands or slides.
        yielding: (T,) by how much it may be off its path in all ways; nothing in a swing that is an arc.
        ground: (T,) height of what it stands on, from the last one to the next one in a swing [m].
    """

    position: Array
    rotation: Array
    free: Array
    yielding: Array
    ground: Array | float = 0.0


def standing_paths(phase: Phase, length: int) -> dict[str, FootPath]:
    """The paths of feet that stay, for a number of knots, where they stand in a phase."""
    return {
        foot: FootPath(
            np.broadcast_to(pose.translation, (length, 3)).copy(),
            np.broadcast_to(pose.rotation, (length, 3, 3)).copy(),
            np.zeros(length),
            np.zeros(length),
        )
        for foot, pose in phase.feet.items()
    }


def any_foot_moves(feet: Mapping[str, FootPath]) -> bool:
    """Whether any foot ever leaves its place."""
    return any(bool(np.ptp(path.position, axis=0).any()) for path in feet.values())


def feet_heading(feet: Mapping[str, FootPath]) -> Array:
    """The mean heading of the feet (T,), unwrapped, zero as at rest [rad]."""
    forward = np.sum([path.rotation[:, :2, 0] for path in feet.values()], axis=0)
    return np.unwrap(np.arctan2(forward[:, 1], forward[:, 0]))


def feet_middle(feet: Mapping[str, FootPath]) -> Array:
    """The middle between the feet, on the floor (T, 2) [m]."""
    at: Array = np.mean([path.position[:, :2] for path in feet.values()], axis=0)
    return at


def mean_ground(feet: Mapping[str, FootPath]) -> Array:
    """The mean height (T,) of what the feet stand on [m]."""
    heights = [np.broadcast_to(path.ground, len(path.position)) for path in feet.values()]
    ground: Array = np.mean(heights, axis=0)
    return ground


def contact_phases(
    robot: Robot,
    stands: Mapping[str, Sequence[Foothold]],
    steps: Sequence[Step],
    duration: float,
    rises: Sequence[HeelRise | None] = (),
) -> tuple[Phase, ...]:
    """The contact phases of steps: double supports, in which heels may rise, and single supports while a foot swings.

    rises: the heel rise of each step; none unless given.
    """
    rest = feet_at_rest(robot)
    now = dict.fromkeys(stands, 0)

    def poses(*feet: str) -> dict[str, pin.SE3]:
        return {foot: foot_pose(stands[foot][now[foot]], rest[foot]) for foot in feet}

    def surfaces(*feet: str) -> dict[str, Surface]:
        return {foot: stands[foot][now[foot]].surface for foot in feet} if climbs else {}

    climbs = any(stand.surface is not FLOOR for own in stands.values() for stand in own)
    phases, start = [], 0.0
    for step, rise in zip_longest(steps, rises):
        others = [foot for foot in stands if foot != step.foot]
        if rise is not None:
            phases.append(Phase(start, rise.start, poses(*stands), surfaces=surfaces(*stands)))
            start = rise.start
        up = (step.foot,) if rise is not None else ()
        phases.append(Phase(start, step.lift, poses(*stands), surfaces=surfaces(*stands), rising=up))
        phases.append(Phase(step.lift, step.land, poses(*others), surfaces=surfaces(*others)))
        now[step.foot] += 1
        start = step.land
    return (*phases, Phase(start, duration, poses(*stands), surfaces=surfaces(*stands)))


@dataclass(frozen=True)
class Swing:
    """A swing of a foot from one foothold to the next, past where the other foot stands, and how high it gets [m]."""

    step: Step
    here: Foothold
    there: Foothold
    anchor: Foothold
    height: float

    def knots(self, times: Array) -> Flags:
        """Flags of the times (T,) at which the foot is in the air."""
        return (times > self.step.lift) & (times < self.step.land)

    def share(self, times: Array) -> Array:
        """The share of the swing that is over at times (n,)."""
        return (times - self.step.lift) / (self.step.land - self.step.lift)


def swings_between(
    stands: Mapping[str, Sequence[Foothold]], steps: Sequence[Step], lifts: Sequence[float], reach: LegReach
) -> list[Swing]:
    """The swings of steps; lifts: how high the dancer's foot gets in each, in the robot's size [m]."""
    now, found = dict.fromkeys(stands, 0), []
    for step, lift in zip(steps, lifts, strict=True):
        here, there = stands[step.foot][now[step.foot] : now[step.foot] + 2]
        other = next(foot for foot in stands if foot != step.foot)
        most = min(
            SWING_HEIGHT_RANGE[1] * reach.leg_length,
            MAX_LIFT_ACCELERATION / HEIGHT_PROFILE_CURVATURE * (step.land - step.lift) ** 2,
        )
        height = max(min(lift, most), SWING_HEIGHT_RANGE[0] * reach.leg_length)
        found.append(Swing(step, here, there, stands[other][now[other]], height))
        now[step.foot] += 1
    return found


def foot_paths(
    robot: Robot,
    stands: Mapping[str, Sequence[Foothold]],
    steps: Sequence[Step],
    lifts: Sequence[float],
    reach: LegReach,
    times: Array,
    rises: Sequence[HeelRise | None] = (),
) -> dict[str, FootPath]:
    """The paths of the feet's frames at times (T,): a swing starts and ends at rest and without acceleration.

    A foot whose heel rises turns about its toes, which go the way that the flat foot's would.

    lifts: how high the dancer's foot gets in each step, in the robot's size [m].
    rises: the heel rise of each step; none unless given.
    """
    rest = feet_at_rest(robot)
    ankles = {foot: np.tile(_at(own[0]), (len(times), 1)) for foot, own in stands.items()}
    ground = {foot: np.full(len(times), own[0].height) for foot, own in stands.items()}
    free, pitch = ({foot: np.zeros(len(times)) for foot in stands} for _ in range(2))
    tilt = {foot: np.tile(own[0].surface.tilt, (len(times), 1)) for foot, own in stands.items()}
    for step, rise in zip(steps, rises, strict=False):
        if rise is not None:
            pitch[step.foot] += rise.angles(times)
    for swing in swings_between(stands, steps, lifts, reach):
        foot, there, inside = swing.step.foot, swing.there, swing.knots(times)
        track = ankles[foot]
        track[times >= swing.step.land] = _at(there)
        over = minimum_jerk(swing.share(times))
        ground[foot] += (there.height - swing.here.height) * over
        tilt[foot] += np.outer(over, there.surface.tilt - swing.here.surface.tilt)
        share = swing.share(times[inside])
        track[inside], free[foot][inside] = swing_track(swing, share, reach), _height_profile(share)
    paths = {}
    for foot, track in ankles.items():
        flat, toes = Rotation.from_euler("z", track[:, 3:]), np.array([Toes.of(robot, foot).ahead, 0.0, 0.0])
        if tilt[foot].any():
            flat = Rotation.from_rotvec(tilt[foot]) * flat
        turned = flat * Rotation.from_euler("y", pitch[foot][:, None])
        paths[foot] = FootPath(
            track[:, :3] + flat.apply(toes) + turned.apply(rest[foot].translation - toes),
            turned.as_matrix() @ rest[foot].rotation,
            free[foot],
            np.zeros(len(times)),
            ground[foot],
        )
    return paths


def freedom(step: Step, times: Array, leg: float) -> Array:
    """By how much a foot may be off its path at times (n,) in the air: not at once when it has left the floor, nor up
    to its landing, and all in between."""
    held, eased = HELD_TIME * np.sqrt(leg / GRAVITY), EASING_TIME * np.sqrt(leg / GRAVITY)
    return minimum_jerk((np.minimum(times - step.lift, step.land - times) - held) / eased)


def swing_track(swing: Swing, share: Array, reach: LegReach) -> Array:
    """x, y, height and heading (n, 4) of a swing at shares (n,) of its time, clear of the standing foot."""
    track = _swing_track(swing.here, swing.there, share, swing.height, CLEARANCE * reach.leg_length)
    beside, needed, across = sole_gap(swing, track, reach)
    window = _height_profile(share)
    wide = float((np.maximum(needed - beside, 0.0) / np.maximum(window, 0.1)).max(initial=0.0))
    track[:, :2] += wide * window[:, None] * across
    return track


def sole_gap(swing: Swing, track: Array, reach: LegReach) -> tuple[Array, Array, Array]:
    """How far beside the standing foot a swinging one is, how far it has to be to keep clear of it (n,) [m], and the
    way (n, 2) from the one to the other, along a track (n, 4)."""
    sign = 1.0 if swing.step.foot == "left_foot" else -1.0
    anchor = swing.anchor
    middle = 0.5 * (track[:, 3] + anchor.heading)
    across = sign * np.column_stack([-np.sin(middle), np.cos(middle)])
    beside = np.sum((track[:, :2] - [anchor.x, anchor.y]) * across, axis=1)
    needed = np.empty(len(track))
    for k in range(len(track)):
        yaws = (track[k, 3], anchor.heading) if sign > 0.0 else (anchor.heading, track[k, 3])
        needed[k] = min_ankle_separation(yaws, reach, sign * across[k])
    return beside, needed, across


def least_height(share: Array, reach: LegReach) -> Array:
    """The least height (n,) of a foot at shares (n,) of its swing [m]."""
    return SWING_HEIGHT_RANGE[0] * reach.leg_length * _height_profile(share)


def _at(stand: Foothold) -> Array:
    """x, y, height and heading (4,) of a foothold."""
    return np.array([stand.x, stand.y, stand.height, stand.heading])


def _swing_track(here: Foothold, there: Foothold, share: Array, lift: float, clearance: float) -> Array:
    """x, y, height and heading (n, 4) of a swing, at shares (n,) of its time; over an edge with a clearance [m]."""
    begin, end = _at(here), _at(there)
    if here.height == there.height and there.passed <= there.height:
        ahead, height = minimum_jerk(share), here.height + lift * _height_profile(share)
    else:
        ahead, height = edge_swing(share, here.height, there.height, clearance, there.passed)
    track: Array = begin + ahead[:, None] * (end - begin)
    track[:, 2] = height
    return track


def _height_profile(share: Array) -> Array:
    """The height of a swing over its greatest, from 0 to 1 and back, at rest and without acceleration at both ends.

    It comes down more gently than it goes up: a foot that meets the floor a little before its time meets it softly.
    """
    return (7.0 / 3.0 * share) ** 3 * (7.0 / 4.0 * (1.0 - share)) ** 4


def feet_at_rest(robot: Robot) -> dict[str, pin.SE3]:
    """The poses of the feet's frames at rest, relative to the point on the floor below their ankle."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    feet = {}
    for foot in robot.feet:
        ankle = data.oMf[robot.point(foot.replace("foot", "ankle"))].translation.copy()
        ankle[2] = 0.0
        pose = data.oMf[robot.point(foot)]
        feet[foot] = pin.SE3(pose.rotation, pose.translation - ankle)
    return feet


def foot_pose(stand: Foothold, rest: pin.SE3) -> pin.SE3:
    """The pose of a foot's frame at a foothold, flat on its surface; rest: its pose at rest, of `feet_at_rest`."""
    turn = pin.utils.rotate("z", stand.heading)
    if stand.surface.tilt.any():
        turn = pin.exp3(stand.surface.tilt) @ turn
    return pin.SE3(turn, np.array([stand.x, stand.y, stand.height])) * rest
