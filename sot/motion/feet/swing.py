"""The paths of a robot's feet: still where they stand, and through the air from foothold to foothold."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.motion.feet.contacts import Phase
from sot.motion.feet.footholds import LegReach, min_ankle_separation
from sot.motion.feet.footwork import Foothold, Step
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

SWING_HEIGHT_RANGE = 0.07, 0.30  # leg lengths, least and greatest height of a swing
MAX_LIFT_ACCELERATION = 12.0  # m/s², up or down, unless the foot has to clear the floor
HEIGHT_PROFILE_CURVATURE = 28.9  # greatest second derivative of `_height_profile`


@dataclass(frozen=True)
class FootPath:
    """Where a foot's frame is to be at T knots.

    Attributes:
        position: (T, 3) [m].
        rotation: (T, 3, 3).
        free: (T,) by how much the foot may tilt: 1 in the middle of a swing, 0 where it stands or slides.
    """

    position: Array
    rotation: Array
    free: Array


def standing_paths(phase: Phase, length: int) -> dict[str, FootPath]:
    """The paths of feet that stay, for a number of knots, where they stand in a phase."""
    return {
        foot: FootPath(
            np.broadcast_to(pose.translation, (length, 3)).copy(),
            np.broadcast_to(pose.rotation, (length, 3, 3)).copy(),
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


def contact_phases(
    robot: Robot, stands: Mapping[str, Sequence[Foothold]], steps: Sequence[Step], duration: float
) -> tuple[Phase, ...]:
    """The contact phases of steps: double supports, and single supports while a foot swings."""
    rest = _feet_at_rest(robot)
    now = dict.fromkeys(stands, 0)

    def poses(*feet: str) -> dict[str, pin.SE3]:
        return {foot: _foot_pose(stands[foot][now[foot]], rest[foot]) for foot in feet}

    phases, start = [], 0.0
    for step in steps:
        phases.append(Phase(start, step.lift, poses(*stands)))
        phases.append(Phase(step.lift, step.land, poses(*(foot for foot in stands if foot != step.foot))))
        now[step.foot] += 1
        start = step.land
    return (*phases, Phase(start, duration, poses(*stands)))


def foot_paths(
    robot: Robot,
    stands: Mapping[str, Sequence[Foothold]],
    steps: Sequence[Step],
    lifts: Sequence[float],
    reach: LegReach,
    times: Array,
) -> dict[str, FootPath]:
    """The paths of the feet's frames at times (T,): a swing starts and ends at rest and without acceleration.

    lifts: how high the dancer's foot gets in each step, in the robot's size [m].
    """
    rest = _feet_at_rest(robot)
    now = dict.fromkeys(stands, 0)
    ankles = {foot: np.tile([own[0].x, own[0].y, 0.0, own[0].heading], (len(times), 1)) for foot, own in stands.items()}
    free = {foot: np.zeros(len(times)) for foot in stands}
    other = dict(zip(robot.feet, robot.feet[::-1], strict=True))
    for step, lift in zip(steps, lifts, strict=True):
        here, there = stands[step.foot][now[step.foot] : now[step.foot] + 2]
        anchor = stands[other[step.foot]][now[other[step.foot]]]
        now[step.foot] += 1
        track = ankles[step.foot]
        track[times >= step.land] = (there.x, there.y, 0.0, there.heading)
        inside = (times > step.lift) & (times < step.land)
        share = (times[inside] - step.lift) / (step.land - step.lift)
        most = min(
            SWING_HEIGHT_RANGE[1] * reach.leg_length,
            MAX_LIFT_ACCELERATION / HEIGHT_PROFILE_CURVATURE * (step.land - step.lift) ** 2,
        )
        track[inside] = _swing_track(here, there, share, max(min(lift, most), SWING_HEIGHT_RANGE[0] * reach.leg_length))
        free[step.foot][inside] = _height_profile(share)
        track[inside, :2] += _detour(track[inside], anchor, share, step.foot, reach)
    return {
        foot: FootPath(
            track[:, :3] + Rotation.from_euler("z", track[:, 3:]).apply(rest[foot].translation),
            Rotation.from_euler("z", track[:, 3:]).as_matrix() @ rest[foot].rotation,
            free[foot],
        )
        for foot, track in ankles.items()
    }


def _swing_track(here: Foothold, there: Foothold, share: Array, lift: float) -> Array:
    """x, y, height and heading (n, 4) of a swing, at shares (n,) of its time."""
    begin = np.array([here.x, here.y, 0.0, here.heading])
    end = np.array([there.x, there.y, 0.0, there.heading])
    track = begin + minimum_jerk(share)[:, None] * (end - begin)
    track[:, 2] = lift * _height_profile(share)
    return track


def _detour(track: Array, anchor: Foothold, share: Array, foot: str, reach: LegReach) -> Array:
    """How far a swinging foot has to go aside to keep clear of the standing one, (n, 2) [m]."""
    sign = 1.0 if foot == "left_foot" else -1.0
    middle = 0.5 * (track[:, 3] + anchor.heading)
    across = sign * np.column_stack([-np.sin(middle), np.cos(middle)])
    beside = np.sum((track[:, :2] - [anchor.x, anchor.y]) * across, axis=1)
    needed = np.empty(len(track))
    for k in range(len(track)):
        yaws = (track[k, 3], anchor.heading) if sign > 0.0 else (anchor.heading, track[k, 3])
        needed[k] = min_ankle_separation(yaws, reach, sign * across[k])
    window = _height_profile(share)
    lacking = np.maximum(needed - beside, 0.0)
    wide = float((lacking / np.maximum(window, 0.1)).max(initial=0.0))
    return wide * window[:, None] * across


def _height_profile(share: Array) -> Array:
    """The height of a swing over its greatest, from 0 to 1 and back, at rest and without acceleration at both ends.

    It comes down more gently than it goes up: a foot that meets the floor a little before its time meets it softly.
    """
    return (7.0 / 3.0 * share) ** 3 * (7.0 / 4.0 * (1.0 - share)) ** 4


def _feet_at_rest(robot: Robot) -> dict[str, pin.SE3]:
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


def _foot_pose(stand: Foothold, rest: pin.SE3) -> pin.SE3:
    return pin.SE3(pin.utils.rotate("z", stand.heading), np.array([stand.x, stand.y, 0.0])) * rest
