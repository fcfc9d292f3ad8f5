"""The robot's footholds: the dancer's, changed by the least that the robot's legs need."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import pinocchio as pin
import scipy.sparse as sp
from numpy.typing import NDArray

from solvers.banded import sparse_qp
from sot.gravity import GRAVITY
from sot.motion.feet.footwork import Foothold, Step
from sot.motion.feet.support import ZMP_INSET
from sot.motion.human.human import SIDES
from sot.robots.leg_range import (
    DIRECTION_COUNT,
    HIP_HEIGHTS_LEGS,
    MAX_EXTENSION,
    directions,
    flat_foot_distances,
    normals,
    support_values,
)
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.stance_range import Stance

Array = NDArray[np.float64]

MAX_SHIFT = 0.1  # leg lengths, from a foot to the body that it carries alone, where a step begins and ends
SOLE_CLEARANCE = 0.0333  # leg lengths between the soles
TOE_OUT_SHARE = 0.8  # of the range of both hips' yaw that the feet may use
SWING_SPEED_SHARE = 0.5  # of the joints' speed limit, in the mean of a swing, which starts and ends at rest
SWING_ACCELERATION_SHARE = 0.6  # of the joints' acceleration limit, where a swing has most of it
MAX_LIGHT_ACCELERATION_G = 0.9  # bound of a foot's acceleration in a step that nobody has planned balance for, in g
LEAST_JERK_PEAK = 5.77  # of a swing's acceleration, over its length and the square of its time: see `smooth.ease`
TURN_SPEED_SHARE = 0.75  # of the hip's speed limit, in the mean of a turn: the pelvis turns as well
MIN_PATH_SCALE = 0.25  # of the dancer's path in the robot's size: the shortest that a piece is scaled to
MAX_FOOTHOLD_OFFSET = 0.216  # leg lengths, from the dancer's to the robot's: farther, its price changes
FOOTHOLD_PRICE_FACTOR = 4.0  # by which the price of a foothold that is too far off rises at a time
MAX_FOOTHOLD_PRICE = 64.0  # to which it rises
GIVEN_UP_FOOTHOLD_PRICE = 0.05  # of a foothold that stays too far off at MAX_FOOTHOLD_PRICE
TOE_ANGLE_RESOLUTION = np.deg2rad(1.0)  # of the greatest angle of a foot over which legs stay apart
UNIT_COST_MOVE, UNIT_COST_TURN = 0.01, 0.05  # m and rad, that cost one unit
QP_TOLERANCE = 1e-6  # of the programmes' multipliers and residuals
ROUNDING_ERROR = 1e-12  # m: less is taken for zero


@dataclass(frozen=True)
class LegReach:
    """What a robot's legs reach with flat feet.

    Attributes:
        leg_length: of the stretched leg, hip to ankle [m].
        hip_width: distance between the hips [m].
        max_stride: farthest that one ankle may be from where it is hip_width beside the other, were no joint's range
            met [m].
        standing, carrying: foot -> (2 DIRECTION_COUNT,) how far its ankle may be from below its hip, along
            `leg_range.normals` seen from the pelvis, in a stride and with hips as low as need be [m].
        toe_out_range: least and greatest angle from the right foot's heading to the left one's [rad]; feet are turned
            no further than until legs meet.
        swing_speed, turn_speed: greatest mean speed of a foot in a step [m/s, rad/s].
        swing_acceleration: greatest of a foot in a step [m/s²].
        carried_beside: how far beside a foot's ankle, toward the other foot, it can carry the body alone [m].
        soles: foot -> (nc, 2) corners about the point below the ankle [m].
    """

    leg_length: float
    hip_width: float
    max_stride: float
    standing: Mapping[str, Array]
    carrying: Mapping[str, Array]
    carried_beside: float
    toe_out_range: tuple[float, float]
    swing_speed: float
    swing_acceleration: float
    turn_speed: float
    soles: Mapping[str, Array]

    def swing_length(self, time: float, max_acceleration: float = np.inf) -> float:
        """How far a foot gets in a step of some time [s] within its speed and acceleration, and another bound [m]."""
        acceleration = min(self.swing_acceleration, max_acceleration)
        return min(self.swing_speed * time, acceleration / LEAST_JERK_PEAK * time**2)

    def light_swing_length(self, time: float) -> float:
        """The same with an acceleration that the zero-moment point bears, which goes with it [m]."""
        return self.swing_length(time, MAX_LIGHT_ACCELERATION_G * GRAVITY)

    def swing_time(self, length: float) -> float:
        """The least time of a step of some length [m] within its speed and acceleration [s]."""
        return max(length / self.swing_speed, float(np.sqrt(LEAST_JERK_PEAK / self.swing_acceleration * length)))

    @staticmethod
    @lru_cache
    def of(robot: Robot) -> "LegReach":
        data = robot.model.createData()
        pin.computeJointJacobians(robot.model, data, robot.rest)
        pin.updateFramePlacements(robot.model, data)

        def place(point: str) -> Array:
            return data.oMf[robot.point(point)].translation

        def yaw(side: str) -> int:
            return max(robot.groups[f"{side}_leg"], key=lambda joint: abs(data.J[5, 6 + joint]))

        leg = leg_length(robot)
        lower, upper = [], []
        for side, outward in zip(SIDES, (1.0, -1.0), strict=True):
            joint = yaw(side)
            ends = np.sort(outward * np.sign(data.J[5, 6 + joint]) * np.array([robot.lower[joint], robot.upper[joint]]))
            lower.append(ends[0])
            upper.append(ends[1])
        legs = list(robot.groups["legs"])
        soles = {}
        for foot, side in zip(robot.feet, SIDES, strict=True):
            pose = data.oMf[robot.point(foot)]
            soles[foot] = np.array([(pose.act(corner) - place(f"{side}_ankle"))[:2] for corner in robot.sole(foot)])
        distances = {foot: flat_foot_distances(robot, side) for foot, side in zip(robot.feet, SIDES, strict=True)}
        left, right = soles.values()
        reach = LegReach(
            leg_length=leg,
            hip_width=float(abs(place("left_hip")[1] - place("right_hip")[1])),
            max_stride=float(2.0 * leg * np.sqrt(MAX_EXTENSION**2 - HIP_HEIGHTS_LEGS[-1] ** 2)),
            standing={foot: support_values(rows[-1]) for foot, rows in distances.items()},
            carrying={foot: support_values(rows.max(axis=0)) for foot, rows in distances.items()},
            carried_beside=max(0.0, min(-left[:, 1].min(), right[:, 1].max()) - ZMP_INSET[1] * leg),
            toe_out_range=(TOE_OUT_SHARE * sum(lower), TOE_OUT_SHARE * sum(upper)),
            swing_speed=SWING_SPEED_SHARE * float(np.median(robot.velocity[legs])) * leg,
            swing_acceleration=SWING_ACCELERATION_SHARE * float(np.median(robot.acceleration[legs])) * leg,
            turn_speed=TURN_SPEED_SHARE * min(float(robot.velocity[yaw(side)]) for side in SIDES),
            soles=soles,
        )
        apart = float(np.ptp([place(f"{side}_ankle")[1] for side in SIDES]))
        return replace(reach, toe_out_range=toe_out_with_legs_apart(reach, robot, MAX_EXTENSION, apart))


def toe_out_with_legs_apart(
    reach: LegReach, robot: Robot, extension: float, least_separation: float = 0.0
) -> tuple[float, float]:
    """The part of the range of angles from the right foot's heading to the left one's over which legs stay apart [rad].

    Feet are turned alike, beside each other as near as their soles allow, or farther; the lower the hips are, the
    farther knees stand out.

    Args:
        reach: of the robot.
        robot: whose legs.
        extension: distance from hip to ankle [leg lengths].
        least_separation: of the ankles [m].
    """
    stance, ends = Stance(robot), []
    for end in reach.toe_out_range:
        posture, turned, before = [leg.rest for leg in stance.legs], end, 0.0
        for angle in (np.sign(end) * np.arange(0.0, 0.5 * abs(end), TOE_ANGLE_RESOLUTION)).tolist():
            yaws = angle, -angle
            apart = max(min_ankle_separation(yaws, reach, np.array([0.0, 1.0])), least_separation)
            out = 0.5 * (apart - reach.hip_width)
            down = np.sqrt((extension * reach.leg_length) ** 2 - out**2)
            ankles = [np.array([0.0, out, -down]), np.array([0.0, -out, -down])]
            found = stance.postures(posture, ankles, [pin.utils.rotate("z", yaw) for yaw in yaws])
            if found is None or not stance.are_apart(found):
                turned = before
                break
            posture, before = found, 2.0 * angle
        ends.append(turned)
    return ends[0], ends[1]


def standing_pairs(steps: Sequence[Step]) -> Iterator[tuple[int, int]]:
    """The left and the right foothold, by number, that are on the floor together before and after each step."""
    left = right = 0
    yield left, right
    for step in steps:
        left, right = (left + 1, right) if step.foot == "left_foot" else (left, right + 1)
        yield left, right


def reachable_headings(
    wanted: Mapping[str, Sequence[Foothold]], steps: Sequence[Step], reach: LegReach
) -> dict[str, Array]:
    """The headings of the footholds, (n,) a foot, nearest to the wanted ones within the hips' range and speed."""
    index = _FootholdIndex(wanted)
    pairs, least, most = [], [], []
    for left, right in standing_pairs(steps):
        pairs.append((index.number("left_foot", left), index.number("right_foot", right)))
        least.append(reach.toe_out_range[0])
        most.append(reach.toe_out_range[1])
    for before, after, step in index.moves(steps):
        pairs.append((index.number(step.foot, after), index.number(step.foot, before)))
        most.append(reach.turn_speed * (step.land - step.lift))
        least.append(-most[-1])
    target = index.gather({foot: np.array([stand.heading for stand in stands]) for foot, stands in wanted.items()})
    count = len(pairs)
    differences = sp.csr_array(
        (np.tile([1.0, -1.0], count), (np.repeat(np.arange(count), 2), np.ravel(pairs))), shape=(count, index.count)
    )
    now = differences @ target
    change = sparse_qp(
        sp.eye_array(index.count) / UNIT_COST_TURN**2, differences, least - now, most - now, QP_TOLERANCE
    )
    return index.split(target + change.x)


def reachable_footholds(
    wanted: Mapping[str, Sequence[Foothold]],
    turned: Mapping[str, Array],
    steps: Sequence[Step],
    reach: LegReach,
    carried: Mapping[str, Array],
    stiffness: Array,
    body: Array,
    min_scale: float = MIN_PATH_SCALE,
    body_travel: Array | None = None,
) -> tuple[dict[str, list[Foothold]], Array]:
    """The footholds that the legs reach from one another, without crossing or touching, nearest to the wanted ones
    along a path that is scaled by as little as that needs.

    A convex programme: each pair of footholds that are on the floor together keeps, in the axes between their headings,
    its left foot to the left by what both soles need, and no farther than a stride. With C, by which the scales s of
    the pieces of the path carry the wanted places w along, it minimises over places p and scales s

        Σ v ‖p − w − C (s − 1)‖² + (s − 1)ᵀ K (s − 1).

    Legs that cross want two feet where each other's is: rather than that both miss their place by half of that, one
    after the other of those that do by more than MAX_FOOTHOLD_OFFSET is given up, v = GIVEN_UP_FOOTHOLD_PRICE
    instead of 1, until none is left.

    Args:
        wanted: footholds of both feet along the path as it is.
        turned: their headings.
        steps: in order of time.
        reach: of the robot.
        carried: foot -> (n, 2, K), C [m].
        stiffness: (K, K) of the scales [m²].
        body: (steps, 2, 2) its place when each foot lifts and when it lands [m].
        min_scale: least that a piece of the path is scaled to.
        body_travel: (steps, 2, K) how far each piece at scale 1 brings the body while each foot is in the air: a foot's
            speed counts from there [m]; nowhere unless given.

    Returns:
        The footholds, and the scales (K,), `min_scale` to 1.
    """
    index = _FootholdIndex(wanted)
    shifts = _body_shifts(body, wanted, turned, steps, reach)
    rows, least = _reach_rows(index, turned, steps, reach, shifts)
    target = index.gather({foot: np.array([(stand.x, stand.y) for stand in wanted[foot]]) for foot in wanted}).ravel()
    C = index.gather(carried).reshape(len(target), -1)
    # In the changes, p − w − C (s − 1) and s − 1, each limit and each price is about a few neighbours in time.
    spots, count = len(target), C.shape[1]
    along = rows @ C
    if body_travel is not None and len(steps):
        travelled = (directions() @ body_travel).reshape(-1, count)
        along[-len(travelled) :] += travelled
        least[-len(travelled) :] -= travelled.sum(axis=1)
    along[np.abs(along) < ROUNDING_ERROR] = 0.0
    limits = sp.block_array([[rows, sp.csr_array(along)], [None, sp.eye_array(count)]], format="csr")
    lower = np.concatenate([least - rows @ target, np.full(count, min_scale - 1.0)])
    upper = np.concatenate([np.full(len(least), np.inf), np.full(count, ROUNDING_ERROR)])
    value = np.ones(index.count)
    while True:
        H = sp.block_diag([sp.diags_array(np.repeat(value, 2)), stiffness], format="csr") / UNIT_COST_MOVE**2
        change, scale = np.split(sparse_qp(H, limits, lower, upper, QP_TOLERANCE).x, [spots])
        off = np.linalg.norm(change.reshape(-1, 2), axis=1)
        far = (off > MAX_FOOTHOLD_OFFSET * reach.leg_length) & (value > GIVEN_UP_FOOTHOLD_PRICE)
        if not far.any():
            break
        if value[far].max() < MAX_FOOTHOLD_PRICE:
            value[far] *= FOOTHOLD_PRICE_FACTOR
        else:
            value[np.flatnonzero(far)[(off * (value >= MAX_FOOTHOLD_PRICE))[far].argmax()]] = GIVEN_UP_FOOTHOLD_PRICE
    found = index.split((target + C @ scale + change).reshape(-1, 2))
    return {
        foot: [Foothold(float(x), float(y), float(yaw)) for (x, y), yaw in zip(found[foot], turned[foot], strict=True)]
        for foot in wanted
    }, np.clip(1.0 + scale, min_scale, 1.0)


def _body_shifts(
    body: Array,
    wanted: Mapping[str, Sequence[Foothold]],
    turned: Mapping[str, Array],
    steps: Sequence[Step],
    reach: LegReach,
) -> Array:
    """How far a body is from the standing foot toward the other one where steps begin and end, (steps, 2, 2) [m].

    Ahead of the foot, half of the way to the other one at most. Beside it, MAX_SHIFT at most: from farther, a robot
    falls faster than it comes back.
    """
    shifts = np.empty((len(steps), 2, 2))
    for k, (pairs, step) in enumerate(zip(pairwise(standing_pairs(steps)), steps, strict=True)):
        for end, (left, right) in enumerate(pairs):
            stands = wanted["left_foot"][left], wanted["right_foot"][right]
            axes = body_axes(turned["left_foot"][left], turned["right_foot"][right])
            there, here = ((stand.x, stand.y) for stand in (stands if step.foot == "left_foot" else stands[::-1]))
            off, between = axes @ (body[k, end] - here), axes @ np.subtract(there, here)
            most = np.array([0.5 * abs(between[0]), MAX_SHIFT * reach.leg_length])
            shifts[k, end] = np.sign(between) * np.clip(np.sign(between) * off, 0.0, most)
    return shifts


def body_axes(left: float, right: float) -> Array:
    """The axes ahead and to the left (2, 2) of a body over two feet of some headings [rad]."""
    middle = 0.5 * (left + right)
    return np.array([[np.cos(middle), np.sin(middle)], [-np.sin(middle), np.cos(middle)]])


def _reach_rows(
    index: "_FootholdIndex", turned: Mapping[str, Array], steps: Sequence[Step], reach: LegReach, shifts: Array
) -> tuple[sp.csr_array, Array]:
    """The constraints `rows @ places >= least` for footholds that stand together and for steps: (m, 2n) and (m,)."""
    parts: list[tuple[int, int, Array, Array]] = []  # two footholds, ways from the second one, least along each
    for k, (left, right) in enumerate(standing_pairs(steps)):
        yaws = turned["left_foot"][left], turned["right_foot"][right]
        axes = body_axes(*yaws)
        across, ways = axes[1], normals() @ axes
        pair = index.number("left_foot", left), index.number("right_foot", right)
        apart = min_ankle_separation(yaws, reach, across)
        parts.append((*pair, across[None], np.array([apart])))
        stride = reach.standing["left_foot"] + np.roll(reach.standing["right_foot"], DIRECTION_COUNT)
        far = np.maximum(stride + reach.hip_width * ways @ across, apart * ways @ across)
        parts.append((*pair, -ways, -far))
        for number, end in ((k - 1, 1), (k, 0)):
            if 0 <= number < len(steps):
                foot = steps[number].foot
                aside, two = (across, pair) if foot == "left_foot" else (-across, pair[::-1])
                body = (0.5 * reach.hip_width + reach.carried_beside) * aside + shifts[number, end] @ axes
                far = reach.carrying[foot] + ways @ body
                parts.append((*two, -ways, -np.maximum(far, apart * ways @ aside)))
    ways = directions()
    for before, after, step in index.moves(steps):
        far = np.full(DIRECTION_COUNT, -reach.swing_length(step.land - step.lift))
        parts.append((index.number(step.foot, before), index.number(step.foot, after), ways, far))
    least = np.concatenate([np.empty(0), *(far for *_, far in parts)])
    values = np.vstack([np.empty((0, 4)), *(np.hstack([ways, -ways]) for *_, ways, _ in parts)])
    columns = np.repeat(
        np.array([(2 * a, 2 * a + 1, 2 * b, 2 * b + 1) for a, b, *_ in parts], dtype=int).reshape(-1, 4),
        [len(far) for *_, far in parts],
        axis=0,
    )
    ends = 4 * np.arange(len(least) + 1)
    return sp.csr_array((values.ravel(), columns.ravel(), ends), shape=(len(least), 2 * index.count)), least


def min_ankle_separation(yaws: tuple[float, float], reach: LegReach, across: Array) -> float:
    """The least distance of the ankles along `across` (2,), from right to left, that keeps the soles apart [m]."""
    extents = []
    for foot, yaw, way in zip(("left_foot", "right_foot"), yaws, (-across, across), strict=True):
        cosine, sine = np.cos(yaw), np.sin(yaw)
        corners = reach.soles[foot] @ np.array([[cosine, sine], [-sine, cosine]])
        extents.append(float((corners @ way).max()))
    return sum(extents) + SOLE_CLEARANCE * reach.leg_length


class _FootholdIndex:
    """The numbering of both feet's footholds in one vector."""

    def __init__(self, stands: Mapping[str, Sequence[Foothold]]):
        self._first: dict[str, int] = {}
        self.count = 0
        self._counts = {foot: len(own) for foot, own in stands.items()}
        for foot, own in self._counts.items():
            self._first[foot] = self.count
            self.count += own

    def number(self, foot: str, stand: int) -> int:
        return self._first[foot] + stand

    def moves(self, steps: Sequence[Step]) -> Iterator[tuple[int, int, Step]]:
        """The numbers of the footholds that each step leaves and reaches, and the step."""
        now = dict.fromkeys(self._counts, 0)
        for step in steps:
            now[step.foot] += 1
            yield now[step.foot] - 1, now[step.foot], step

    def gather(self, values: Mapping[str, Array]) -> Array:
        return np.concatenate([values[foot] for foot in self._counts])

    def split(self, values: Array) -> dict[str, Array]:
        return {foot: values[first : first + self._counts[foot]] for foot, first in self._first.items()}
