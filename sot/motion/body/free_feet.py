"""The ways of feet in the air: the dancer's, as far as the robot's legs can do them, from foothold to foothold."""

from collections.abc import Sequence
from itertools import zip_longest

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter1d, uniform_filter1d
from scipy.spatial.transform import Rotation

from sot.motion.body.coordinates import from_configuration
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.limits import Limits
from sot.motion.body.parts import Leg
from sot.motion.body.retarget import PartFit, solve_knots
from sot.motion.body.spline import Spline
from sot.motion.body.swing_fit import AirLimits, nearest_path
from sot.motion.body.targets import Targets
from sot.motion.feet.course import Course
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import foot_track
from sot.motion.feet.heel_rise import HeelRise, Toes
from sot.motion.feet.stance import Build
from sot.motion.feet.swing import (
    FootPath,
    Swing,
    feet_at_rest,
    foot_paths,
    freedom,
    least_height,
    sole_gap,
    swing_track,
    swings_between,
)
from sot.motion.feet.travel import Travel
from sot.robots.robot import Robot

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

AIR_SPEED_SHARE = 0.7  # of the legs' speed limit times their length, that an ankle in the air may have
AIR_ACCELERATION_SHARE = 0.33  # of the legs' acceleration limit times their length
SOLE_ROOM_LEGS = 0.02  # leg lengths between the floor and the lowest corner of a sole in the air
MAX_SINE = 0.9  # of the pitch of a foot in the air
TILTS_TRIED, TILT_WINDOW = 11, 7  # shares of a tilt; knots over which the share is made smooth
LEG_GAUSS_NEWTON_STEPS = 2  # of a leg over the whole clip
MIN_KNOTS = 3  # in the air, of which a path is made


class DancersFeet:
    """The paths of the feet's frames at a course's knots, which swing as the dancer's legs do.

    The legs of a body whose pelvis is where the dancer's is are fitted to the directions of the dancer's, within their
    ranges, speeds and accelerations. Where their ankles get is what paths come near to between the footholds.
    """

    def __init__(self, robot: Robot, build: Build, limits: Limits, course: Course, wanted: Targets):
        self._robot, self._course, self._reach = robot, course, LegReach.of(robot)
        self._rest, self._tree = feet_at_rest(robot), JointTree(robot)
        joints = list(robot.groups["legs"])
        leg, speed, acceleration = build.leg, robot.velocity[joints], robot.acceleration[joints]
        self._air = AirLimits(
            AIR_SPEED_SHARE * float(np.median(speed)) * leg,
            AIR_ACCELERATION_SHARE * float(np.median(acceleration)) * leg,
            leg,
        )
        self._legs: dict[str, tuple[Array, Array, Array]] = {}  # places of hip and ankle, rotation of the foot
        self._found: dict[tuple[int, float], tuple[Array, Array] | None] = {}  # by swing and share
        if course.travel is not None and course.travel.steps:
            self._fit_legs(course.travel, _bodies_at(robot, build, wanted), limits)

    def paths(self, shares: Sequence[float]) -> dict[str, FootPath]:
        """The paths; shares: for each step how much of its swing is the dancer's, 1 all of it, 0 nothing."""
        travel, times = self._course.travel, self._course.human.times
        if travel is None:
            return dict(self._course.feet)
        rises = self._course.rises
        paths = foot_paths(self._robot, travel.stands, travel.steps, travel.lifts, self._reach, times, rises)
        swings = swings_between(travel.stands, travel.steps, travel.lifts, self._reach)
        for number, (swing, share, rise) in enumerate(zip_longest(swings, shares, rises)):
            path, knots = paths[swing.step.foot], np.flatnonzero(swing.knots(times))
            if share > 0.0 and len(knots) >= MIN_KNOTS:
                free = share * freedom(swing.step, times[knots], self._reach.leg_length)
                if (number, share) not in self._found:
                    self._found[number, share] = self._swing(swing, knots, share, free, rise)
                found = self._found[number, share]
                if found is not None:
                    path.position[knots], path.rotation[knots] = found
                    path.free[knots] = path.yielding[knots] = free
        return paths

    def _swing(
        self, swing: Swing, knots: Indices, share: float, free: Array, rise: HeelRise | None
    ) -> tuple[Array, Array] | None:
        """Places (n, 3) and rotations (n, 3, 3) of the foot's frame in a swing; None if the ankle has no way.

        Of a foot whose heel rises, the way is that of the ankle were the foot flat.
        """
        foot, times = swing.step.foot, self._course.human.times
        over = swing.share(times[knots])
        hips, ankles, turned = self._legs[foot]
        plain = swing_track(swing, over, self._reach)
        toes = Toes.of(self._robot, foot)
        upright, heading = np.array([0.0, 0.0, toes.height]), Rotation.from_euler("z", plain[:, 3:])
        pitch = np.zeros(len(knots)) if rise is None else rise.angles(times[knots])
        shift = toes.ankle_shift(pitch)
        upright = upright + heading.apply(np.insert(shift, 1, 0.0, axis=1))
        wanted = plain[:, :3] + share * (ankles[knots] - upright - plain[:, :3])
        wanted[:, 2] = np.maximum(wanted[:, 2], plain[:, 2])  # the dancer lifts its heel before its foot
        ends = np.array([[hold.x, hold.y, 0.0] for hold in (swing.here, swing.there)])
        around = hips[knots[0] - 1 : knots[-1] + 2]
        beside, needed, across = sole_gap(swing, plain, self._reach)
        needed += free * SOLE_ROOM_LEGS * self._air.leg
        apart = np.minimum(needed, beside) + np.sum(across * [swing.anchor.x, swing.anchor.y], axis=1)
        floor, vertical = least_height(over, self._reach), np.ones((len(knots), 1))
        period = 1.0 / self._course.human.rate
        flat = nearest_path(wanted[:, :2], ends[:, :2], around[:, :2], period, self._air, across, apart)
        up = nearest_path(wanted[:, 2:], ends[:, 2:], around[:, 2:], period, self._air, vertical, floor)
        if flat is None or up is None:
            return None

        heading = heading * Rotation.from_euler("y", pitch[:, None])
        tilt = heading.inv() * Rotation.from_matrix(turned[knots] @ self._rest[foot].rotation.T)
        below = self._rest[foot].translation - [0.0, 0.0, toes.height]  # from the ankle to the foot's frame
        corners = self._robot.sole(foot) @ self._rest[foot].rotation.T + below
        room = up[:, 0] + upright[:, 2] - SOLE_ROOM_LEGS * self._air.leg * free
        tilts = share * free[:, None] * tilt.as_rotvec() * [1.0, 1.0, 0.0]
        turn = (heading * _tilt_above(room, tilts, corners, heading)).as_matrix()
        return np.hstack([flat, up]) + upright + turn @ below, turn @ self._rest[foot].rotation

    def _fit_legs(self, travel: Travel, y: Array, limits: Limits) -> None:
        """Fit both legs to the dancer's at the bodies y (T, nv)."""
        human, period, knots = self._course.human, 1.0 / self._course.human.rate, np.arange(len(y))
        pelvis = human.frames["pelvis"]
        for foot in self._robot.feet:
            side = foot.removesuffix("_foot")
            at = _dancers_times(travel, foot, human.times)
            directions = {
                segment: np.einsum(
                    "tij,tj->ti",
                    pelvis,
                    _sampled(np.einsum("tji,tj->ti", pelvis, human.segment_direction(segment)), at, period),
                )
                for segment in (f"{side}_thigh", f"{side}_shank")
            }
            track = foot_track(human, side)
            ahead = (self._robot.sole(foot) @ self._rest[foot].rotation.T + self._rest[foot].translation)[:, 0].max()
            pitch = np.arcsin(np.clip(np.interp(at, human.times, track.toe_drop) / ahead, -MAX_SINE, MAX_SINE))
            path = self._course.feet[foot]
            turned = Rotation.from_matrix(path.rotation @ self._rest[foot].rotation.T)
            turned = turned * Rotation.from_euler("y", pitch[:, None])
            leg = Leg(self._robot, side, directions, turned.as_matrix() @ self._rest[foot].rotation)
            y[:, leg.columns], _ = solve_knots(leg, knots, y, limits)
            spline = Spline.through(y[:, leg.columns], period)
            spline.control[:3], spline.control[-3:] = y[0, leg.columns], y[-1, leg.columns]
            fit = PartFit(leg.columns, len(y), period, limits)
            y[:, leg.columns] = fit.refine(leg, spline, y, LEG_GAUSS_NEWTON_STEPS).knots
            kinematics = Kinematics(self._tree, y)
            hip, ankle = (kinematics.frame_pose(self._robot.point(f"{side}_{point}"))[1] for point in ("hip", "ankle"))
            self._legs[foot] = hip, ankle, kinematics.frame_pose(self._robot.point(foot))[0]


def _bodies_at(robot: Robot, build: Build, wanted: Targets) -> Array:
    """Coordinates (T, nv) of bodies with their pelvis where the dancer's is."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    waist = data.oMf[robot.point("waist")]
    base = data.oMi[1].actInv(waist)
    turned = wanted.frames["pelvis"] @ base.rotation.T
    place = wanted.hips - wanted.frames["pelvis"] @ build.hips - turned @ base.translation
    quaternion = Rotation.from_matrix(turned).as_quat()
    q = np.hstack([place, quaternion, np.tile(robot.rest[7:], (wanted.length, 1))])
    return from_configuration(q)


def _tilt_above(room: Array, tilt: Array, corners: Array, turned: Rotation) -> Rotation:
    """A foot's tilt, as rotation vectors (n, 3) from how it is turned (n,) already, lessened smoothly where a corner
    (nc, 3) of its sole would be lower below the ankle than there is room (n,) [m]."""
    shares = np.linspace(0.0, 1.0, TILTS_TRIED)
    fits = np.empty((TILTS_TRIED, len(room)), bool)
    for k, share in enumerate(shares):
        fits[k] = ((turned * Rotation.from_rotvec(share * tilt)).as_matrix() @ corners.T)[:, 2].min(axis=1) >= -room
    share = shares[np.maximum(np.logical_and.accumulate(fits).sum(axis=0) - 1, 0)]
    share = uniform_filter1d(minimum_filter1d(share, TILT_WINDOW), TILT_WINDOW)
    return Rotation.from_rotvec(share[:, None] * tilt)


def _dancers_times(travel: Travel, foot: str, times: Array) -> Array:
    """The times (T,) at which the dancer's foot does what the robot's does at `times` (T,): it may step later."""
    theirs, ours = [times[0]], [times[0]]
    for step, move in zip(travel.steps, travel.moves, strict=True):
        if step.foot == foot:
            ours += [step.lift, step.land]
            theirs += [move.lift, move.land]
    return np.interp(times, [*ours, times[-1]], [*theirs, times[-1]])


def _sampled(directions: Array, at: Array, period: float) -> Array:
    """Unit vectors (T, 3) at times (n,) between their knots."""
    knots = period * np.arange(len(directions))
    mixed = np.column_stack([np.interp(at, knots, directions[:, axis]) for axis in range(3)])
    return mixed / np.linalg.norm(mixed, axis=1, keepdims=True)
