"""What a planned body motion falls short of: feet off their paths, and a zero moment point off the support."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing

from sot.motion.balance.centroidal import Centroidal
from sot.motion.body.coordinates import to_pinocchio
from sot.motion.body.kinematics import JointTree, Kinematics
from sot.motion.body.spline import Spline
from sot.motion.feet.support import Support
from sot.motion.feet.swing import FootPath, mean_ground
from sot.robots.robot import Robot
from sot.robots.size import leg_length

Array = NDArray[np.float64]

MIN_ZMP_MARGIN_LEGS = 0.0166  # leg lengths, from the ZMP to the edge of the support, for longer than an instant
MAX_FOOT_ERROR_LEGS = 0.0033  # leg lengths, of a foot off its path
MAX_YIELD_LEGS = 0.05  # leg lengths more, of a foot that yields
MAX_NAMED_STRETCHES = 4  # stretches in a sentence
MERGED_GAP_S = 0.5  # s: what falls short twice within that time does so once


@dataclass(frozen=True)
class Shortfall:
    """A stretch of a motion that falls short of what its feet are to do.

    Attributes:
        start, end: in motion time [s].
        foot: greatest distance of a foot from its path [m].
        zmp: greatest distance of the ZMP from the support [m].
    """

    start: float
    end: float
    foot: float
    zmp: float


def shortfall_remark(found: Sequence[Shortfall], clip_time: Callable[[float], float]) -> str:
    """The sentence that says where a plan falls short, and by how much: some stretches, one at least.

    clip_time: from the motion's time to the clip's [s].
    """
    where = [f"{clip_time(short.start):.1f} to {clip_time(short.end):.1f} s" for short in found[:MAX_NAMED_STRETCHES]]
    more = f" and {len(found) - MAX_NAMED_STRETCHES} times more" if len(found) > MAX_NAMED_STRETCHES else ""
    foot, zmp = (1e3 * max(values) for values in ([s.foot for s in found], [s.zmp for s in found]))
    off = [f"its feet are up to {foot:.0f} mm off their places"] if foot >= 1.0 else []
    outside = [f"its balance is up to {zmp:.0f} mm outside the soles"] if zmp > 0.0 else []
    return (
        f"The robot cannot do all of the clip from {', '.join(where)}{more}: {' and '.join(off + outside)} in the plan."
    )


def strain(
    robot: Robot,
    feet: Mapping[str, FootPath],
    where: Sequence[Support],
    body_motion: Spline,
    state: Centroidal,
    part: slice,
) -> Array:
    """How far a body is from what its feet are to do, at the knots of a part (n,), 0 where it does it [m].

    The way of its ZMP back from outside the support, or from near its edge for longer than an instant, there or half
    way to the next knot; or that of a foot back to its path, whichever is farther.

    state: its own at the knots of the part, its height over what the feet stand on.
    """
    margin = _zmp_margins(robot, where, body_motion, state, part, mean_ground(feet))
    least = MIN_ZMP_MARGIN_LEGS * leg_length(robot)
    near = np.pad(margin < least, 1)
    outside = (margin < 0.0) | (near[1:-1] & (near[:-2] | near[2:]))
    beyond = _of_knots(np.where(outside, least - margin, 0.0))
    return np.maximum(beyond, feet_strain(robot, feet, body_motion, part))


def feet_strain(robot: Robot, feet: Mapping[str, FootPath], body_motion: Spline, part: slice) -> Array:
    """The way of the foot that is farthest off its path back to near it, at the knots of a part (n,) [m]; negative if
    it is near."""
    return _foot_errors(robot, feet, body_motion, part) - MAX_FOOT_ERROR_LEGS * leg_length(robot)


def shortfalls(
    robot: Robot, feet: Mapping[str, FootPath], where: Sequence[Support], body_motion: Spline
) -> list[Shortfall]:
    """The stretches of a motion in which a foot is off its path, or the ZMP outside the support."""
    period, everything = body_motion.period, slice(0, len(body_motion.knots))
    ground = mean_ground(feet)
    state = centroidal_state(body_motion, robot, None, ground)
    outside = np.maximum(_of_knots(-_zmp_margins(robot, where, body_motion, state, everything, ground)), 0.0)
    off = _foot_errors(robot, feet, body_motion, everything)
    short = np.pad((off > MAX_FOOT_ERROR_LEGS * leg_length(robot)) | (outside > 0.0), 1)
    joined = binary_closing(short, iterations=round(0.5 * MERGED_GAP_S / period)) | short
    edges = np.flatnonzero(np.diff(joined.astype(np.int8))).reshape(-1, 2).tolist()
    return [
        Shortfall(period * start, period * (end - 1), float(off[start:end].max()), float(outside[start:end].max()))
        for start, end in edges
    ]


def centroidal_state(
    body_motion: Spline, robot: Robot, times: Array | None = None, ground: Array | None = None
) -> Centroidal:
    """The centroidal quantities of a motion at times (n,) [s], by default at its knots.

    ground: (T,) heights at its knots, from which the centre of mass counts [m].
    """
    if times is None:
        at_knots = body_motion.knots, body_motion.velocities, body_motion.accelerations
        state = Centroidal.along(robot, *to_pinocchio(*at_knots))
        times = body_motion.period * np.arange(len(state.com), dtype=float)
    else:
        state = Centroidal.along(robot, *to_pinocchio(*(body_motion(times, derivative) for derivative in range(3))))
    if ground is None:
        return state
    return state.above(np.interp(times, body_motion.period * np.arange(len(ground)), ground))


def _zmp_margins(
    robot: Robot, where: Sequence[Support], body_motion: Spline, state: Centroidal, part: slice, ground: Array
) -> Array:
    """The distance of the ZMP to the edge of the support, negative outside, at the knots of a part and half-way between
    them (2 n - 1,) [m]."""
    times = body_motion.period * (part.start + 0.5 * np.arange(2 * len(state.com) - 1))
    zmp, margin = np.empty((len(times), 2)), np.empty(len(times))
    zmp[::2], zmp[1::2] = state.zmp(), centroidal_state(body_motion, robot, times[1::2], ground).zmp()
    for support, stop in zip(where, [*(support.start for support in where[1:]), np.inf], strict=True):
        rows = (times >= support.start) & (times < stop)
        margin[rows] = support.polygon.margin(zmp[rows])
    return margin


def _foot_errors(robot: Robot, feet: Mapping[str, FootPath], body_motion: Spline, part: slice) -> Array:
    """The distance of the foot that is farthest off its path, at the knots of a part (n,), beyond what it may
    yield [m]."""
    kinematics, leg, worst = Kinematics(JointTree(robot), body_motion.knots[part]), leg_length(robot), []
    for foot, path in feet.items():
        away = np.linalg.norm(kinematics.frame_pose(robot.point(foot))[1] - path.position[part], axis=1)
        worst.append(np.maximum(away - MAX_YIELD_LEGS * leg * path.yielding[part], 0.0))
    return np.max(worst, axis=0)


def _of_knots(values: Array) -> Array:
    """The greatest of values (2 n - 1,) at and about each of n knots."""
    worst = values[::2].copy()
    worst[:-1] = np.maximum(worst[:-1], values[1::2])
    worst[1:] = np.maximum(worst[1:], values[1::2])
    return worst
