"""The way of a robot's feet over time: still where they stand, and from stand to stand through the air."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.motion.feet.contacts import Phase
from sot.motion.feet.footholds import Reach, separation
from sot.motion.feet.footwork import Stand, Step
from sot.robots.robot import Robot
from sot.smooth import minimum_jerk

Array = NDArray[np.float64]

CLEAR = 0.07, 0.30  # leg lengths, the least and the greatest height of a swing
PULL = 12.0  # m/s², greatest that a foot is lifted or lowered with, unless it has to clear the floor
BEND = 28.9  # greatest of `_bump`, over the share of a step's time squared


@dataclass(frozen=True)
class FootPath:
    """Where a foot's frame is to be at T knots: `position` (T, 3) [m] and `rotation` (T, 3, 3)."""

    position: Array
    rotation: Array


def standing(phase: Phase, length: int) -> dict[str, FootPath]:
    """Feet that stay, for a number of knots, where they are in a phase."""
    return {
        foot: FootPath(
            np.broadcast_to(pose.translation, (length, 3)).copy(), np.broadcast_to(pose.rotation, (length, 3, 3)).copy()
        )
        for foot, pose in phase.feet.items()
    }


def moving(feet: Mapping[str, FootPath]) -> bool:
    """Whether any foot ever leaves its place."""
    return any(bool(np.ptp(path.position, axis=0).any()) for path in feet.values())


def facing(feet: Mapping[str, FootPath]) -> Array:
    """Heading between the feet (T,), unwrapped, zero where they stand as at rest [rad]."""
    forward = np.sum([path.rotation[:, :2, 0] for path in feet.values()], axis=0)
    return np.unwrap(np.arctan2(forward[:, 1], forward[:, 0]))


def middle(feet: Mapping[str, FootPath]) -> Array:
    """Between the feet, on the floor (T, 2) [m]."""
    at: Array = np.mean([path.position[:, :2] for path in feet.values()], axis=0)
    return at


def phases_of(
    robot: Robot, stands: Mapping[str, Sequence[Stand]], steps: Sequence[Step], duration: float
) -> tuple[Phase, ...]:
    """Which feet stand where, when: double supports, and the steps between them."""
    rest = _rest_feet(robot)
    now = dict.fromkeys(stands, 0)

    def poses(*feet: str) -> dict[str, pin.SE3]:
        return {foot: _pose(stands[foot][now[foot]], rest[foot]) for foot in feet}

    phases, start = [], 0.0
    for step in steps:
        phases.append(Phase(start, step.lift, poses(*stands)))
        phases.append(Phase(step.lift, step.land, poses(*(foot for foot in stands if foot != step.foot))))
        now[step.foot] += 1
        start = step.land
    return (*phases, Phase(start, duration, poses(*stands)))


def foot_paths(
    robot: Robot,
    stands: Mapping[str, Sequence[Stand]],
    steps: Sequence[Step],
    lifts: Sequence[float],
    reach: Reach,
    times: Array,
) -> dict[str, FootPath]:
    """Paths of the feet's frames at times (T,): a step leaves and reaches its stands at rest and without acceleration.

    lifts: how high the dancer's foot gets in each step, in the robot's size [m].
    """
    rest = _rest_feet(robot)
    now = dict.fromkeys(stands, 0)
    ankles = {foot: np.tile([own[0].x, own[0].y, 0.0, own[0].heading], (len(times), 1)) for foot, own in stands.items()}
    other = dict(zip(robot.feet, robot.feet[::-1], strict=True))
    for step, lift in zip(steps, lifts, strict=True):
        here, there = stands[step.foot][now[step.foot] : now[step.foot] + 2]
        anchor = stands[other[step.foot]][now[other[step.foot]]]
        now[step.foot] += 1
        track = ankles[step.foot]
        track[times >= step.land] = (there.x, there.y, 0.0, there.heading)
        inside = (times > step.lift) & (times < step.land)
        share = (times[inside] - step.lift) / (step.land - step.lift)
        most = min(CLEAR[1] * reach.leg, PULL / BEND * (step.land - step.lift) ** 2)
        track[inside] = _swing(here, there, share, max(min(lift, most), CLEAR[0] * reach.leg))
        track[inside, :2] += _around(track[inside], anchor, share, step.foot, reach)
    return {
        foot: FootPath(
            track[:, :3] + Rotation.from_euler("z", track[:, 3:]).apply(rest[foot].translation),
            Rotation.from_euler("z", track[:, 3:]).as_matrix() @ rest[foot].rotation,
        )
        for foot, track in ankles.items()
    }


def _swing(here: Stand, there: Stand, share: Array, lift: float) -> Array:
    """x, y, height and heading (n, 4) of a step, over the share of its time."""
    begin = np.array([here.x, here.y, 0.0, here.heading])
    end = np.array([there.x, there.y, 0.0, there.heading])
    track = begin + minimum_jerk(share)[:, None] * (end - begin)
    track[:, 2] = lift * _bump(share)
    return track


def _around(track: Array, anchor: Stand, share: Array, foot: str, reach: Reach) -> Array:
    """How far (n, 2) a swinging foot has to go round the standing one to keep clear of it."""
    sign = 1.0 if foot == "left_foot" else -1.0
    middle = 0.5 * (track[:, 3] + anchor.heading)
    across = sign * np.column_stack([-np.sin(middle), np.cos(middle)])
    beside = np.sum((track[:, :2] - [anchor.x, anchor.y]) * across, axis=1)
    needed = np.empty(len(track))
    for k in range(len(track)):
        yaws = (track[k, 3], anchor.heading) if sign > 0.0 else (anchor.heading, track[k, 3])
        needed[k] = separation(yaws, reach, sign * across[k])
    window = _bump(share)
    lacking = np.maximum(needed - beside, 0.0)
    wide = float((lacking / np.maximum(window, 0.1)).max(initial=0.0))
    return wide * window[:, None] * across


def _bump(share: Array) -> Array:
    """From 0 to 1 and back, at rest and without acceleration at both ends.

    It comes down more gently than it goes up: a foot that meets the floor a little before its time meets it softly.
    """
    return (7.0 / 3.0 * share) ** 3 * (7.0 / 4.0 * (1.0 - share)) ** 4


def _rest_feet(robot: Robot) -> dict[str, pin.SE3]:
    """Foot frames at rest, relative to the point on the floor below their ankle."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    feet = {}
    for foot in robot.feet:
        ankle = data.oMf[robot.point(foot.replace("foot", "ankle"))].translation.copy()
        ankle[2] = 0.0
        pose = data.oMf[robot.point(foot)]
        feet[foot] = pin.SE3(pose.rotation, pose.translation - ankle)
    return feet


def _pose(stand: Stand, rest: pin.SE3) -> pin.SE3:
    return pin.SE3(pin.utils.rotate("z", stand.heading), np.array([stand.x, stand.y, 0.0])) * rest
