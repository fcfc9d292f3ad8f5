"""Where the robot's feet stand: the dancer's places, changed by the least that its legs need."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
import scipy.sparse as sp
from numpy.typing import NDArray

from solvers.banded import sparse_qp
from sot.motion.feet.footwork import Stand, Step
from sot.motion.human.human import SIDES
from sot.proximity import NEIGHBOUR_DISTANCE as NEXT
from sot.robots.robot import Robot

Array = NDArray[np.float64]

LOWERED = 0.90  # of a stretched leg's length, the lowest hips that a stride may ask for
EXTENDED = 0.97  # of its length, how far a stride may stretch a leg
CLEARANCE = 0.02  # m between the soles
ROOM = 0.8  # of the range in which a foot can turn against the pelvis, for both feet at once
HURRY = 0.5  # mean speed of a swinging leg's joints over their limit: a swing starts and ends at rest
SPINNING = 0.75  # mean speed of a turning foot over its hip's limit: the pelvis turns as well
SHORTEST = 0.25  # of the dancer's path in the robot's size, least that a piece of it is scaled to
OFF = 0.13  # m that a foothold may be off its place
DEARER, DEAREST = 4.0, 64.0  # what a foothold's distance gets dearer by where it is farther off, and up to
LEFT = 0.05  # price where that does not help
EDGES = 12  # of the polygon inside the circle of strides
MOVED, TURNED = 0.01, 0.05  # m and rad, changes that one is ready to accept
EXACT = 1e-6  # tolerance of the programmes
NOTHING = 1e-12


@dataclass(frozen=True)
class Reach:
    """What a robot's legs can do with its feet flat.

    Attributes:
        leg: its length, stretched [m].
        hips: distance of the legs' roots [m].
        stride: farthest of one ankle from the other beyond that distance [m].
        turn: least and most that the left foot may be turned out from the right one, together [rad]; toes are turned in
            no further than until knees meet.
        speed, turning: mean of a foot in a step [m/s, rad/s].
        soles: foot -> (nc, 2) corners about the point below the ankle [m].
    """

    leg: float
    hips: float
    stride: float
    turn: tuple[float, float]
    speed: float
    turning: float
    soles: Mapping[str, Array]

    @staticmethod
    def of(robot: Robot) -> "Reach":
        data = robot.model.createData()
        pin.computeJointJacobians(robot.model, data, robot.rest)
        pin.updateFramePlacements(robot.model, data)

        def place(point: str) -> Array:
            return data.oMf[robot.point(point)].translation

        def length(side: str) -> float:
            hip, knee, ankle = (place(f"{side}_{point}") for point in ("hip", "knee", "ankle"))
            return float(np.linalg.norm(hip - knee) + np.linalg.norm(knee - ankle))

        def yaw(side: str) -> int:
            return max(robot.groups[f"{side}_leg"], key=lambda joint: abs(data.J[5, 6 + joint]))

        leg = float(np.mean([length(side) for side in SIDES]))
        lower, upper = [], []
        for side, outward in zip(SIDES, (1.0, -1.0), strict=True):
            joint = yaw(side)
            ends = np.sort(outward * np.sign(data.J[5, 6 + joint]) * np.array([robot.lower[joint], robot.upper[joint]]))
            lower.append(ends[0])
            upper.append(ends[1])
        rates = robot.velocity[list(robot.groups["legs"])]
        soles = {}
        for foot, side in zip(robot.feet, SIDES, strict=True):
            pose = data.oMf[robot.point(foot)]
            soles[foot] = np.array([(pose.act(corner) - place(f"{side}_ankle"))[:2] for corner in robot.sole(foot)])
        reach = Reach(
            leg=leg,
            hips=float(abs(place("left_hip")[1] - place("right_hip")[1])),
            stride=float(2.0 * leg * np.sqrt(EXTENDED**2 - LOWERED**2)),
            turn=(ROOM * sum(lower), ROOM * sum(upper)),
            speed=HURRY * float(np.median(rates)) * leg,
            turning=SPINNING * min(float(robot.velocity[yaw(side)]) for side in SIDES),
            soles=soles,
        )
        knees = float(abs(place("left_knee")[1] - place("right_knee")[1]))
        return replace(reach, turn=(max(reach.turn[0], -_turned_in(reach, knees - _legs_apart(robot))), reach.turn[1]))


def _turned_in(reach: Reach, thick: float) -> float:
    """How far toes can be turned in, both feet together, until knees meet that are so thick [rad].

    Feet are as near as soles allow, hips as high as they can be over them: the lower, the farther knees stand out.
    """
    ahead = 0.5 * reach.leg * float(np.sqrt(1.0 - EXTENDED**2))
    angles = np.arange(0.0, 0.25 * np.pi, np.deg2rad(1.0))
    wide = [max(separation((-angle, angle), reach, np.array([0.0, 1.0])), reach.hips) for angle in angles]
    meet = 0.5 * (reach.hips + np.array(wide)) - 2.0 * ahead * np.sin(angles) < thick
    return 2.0 * float(angles[meet.argmax()] if meet.any() else angles[-1])


def _legs_apart(robot: Robot) -> float:
    """Distance of one leg from the other at rest, without feet and what is next to each other by design [m]; infinite
    if there are no shapes."""
    feet = {robot.model.frames[robot.point(foot)].parentJoint for foot in robot.feet}
    left, right = ({2 + joint for joint in robot.groups[f"{side}_leg"]} - feet for side in SIDES)
    shapes = list(enumerate(robot.shapes.geometryObjects))
    geometry = robot.shapes.copy()
    geometry.removeAllCollisionPairs()
    for first in [k for k, shape in shapes if shape.parentJoint in left]:
        for second in [k for k, shape in shapes if shape.parentJoint in right]:
            geometry.addCollisionPair(pin.CollisionPair(first, second))
    results = geometry.createData()
    pin.computeDistances(robot.model, robot.model.createData(), geometry, results, robot.rest)
    distances = [result.min_distance for result in results.distanceResults]
    return min((apart for apart in distances if apart >= NEXT), default=np.inf)


def together(steps: Sequence[Step]) -> Iterator[tuple[int, int]]:
    """Which stand of the left foot and of the right one are on the floor together, before and after each step."""
    left = right = 0
    yield left, right
    for step in steps:
        left, right = (left + 1, right) if step.foot == "left_foot" else (left, right + 1)
        yield left, right


def headings(wanted: Mapping[str, Sequence[Stand]], steps: Sequence[Step], reach: Reach) -> dict[str, Array]:
    """Headings of the stands (n,) a foot, nearest to the wanted ones within what hips can turn and how fast."""
    index = _Index(wanted)
    pairs, least, most = [], [], []
    for left, right in together(steps):
        pairs.append((index.number("left_foot", left), index.number("right_foot", right)))
        least.append(reach.turn[0])
        most.append(reach.turn[1])
    for before, after, step in index.moves(steps):
        pairs.append((index.number(step.foot, after), index.number(step.foot, before)))
        most.append(reach.turning * (step.land - step.lift))
        least.append(-most[-1])
    target = index.gather({foot: np.array([stand.heading for stand in stands]) for foot, stands in wanted.items()})
    count = len(pairs)
    differences = sp.csr_array(
        (np.tile([1.0, -1.0], count), (np.repeat(np.arange(count), 2), np.ravel(pairs))), shape=(count, index.count)
    )
    now = differences @ target
    change = sparse_qp(sp.eye_array(index.count) / TURNED**2, differences, least - now, most - now, EXACT)
    return index.split(target + change.x)


def places(
    wanted: Mapping[str, Sequence[Stand]],
    turned: Mapping[str, Array],
    steps: Sequence[Step],
    reach: Reach,
    carried: Mapping[str, Array],
    stiffness: Array,
) -> tuple[dict[str, list[Stand]], Array]:
    """The stands that the legs reach from one another, without crossing or touching, nearest to the wanted ones along
    a path that is scaled by as little as that needs.

    A convex programme: each pair of stands that are on the floor together keeps, in the axes between their headings,
    its left foot to the left by what both soles need, and no farther than a stride. With C, by which the scales s of
    the pieces of the path carry the wanted places w along, it minimises over places p and scales s

        Σ v ‖p − w − C (s − 1)‖² + (s − 1)ᵀ K (s − 1).

    Legs that cross want two feet where each other's is: rather than that both miss their place by half of that, one
    after the other of those that do by more than OFF is given up, v = LEFT instead of 1, until none is left.

    Args:
        wanted: stands of both feet along the path as it is.
        turned: their headings.
        steps: in order of time.
        reach: of the robot.
        carried: foot -> (n, 2, K), C [m].
        stiffness: (K, K) of the scales [m²].

    Returns:
        The stands, and the scales (K,), SHORTEST to 1.
    """
    index = _Index(wanted)
    rows, least = _reachable(index, turned, steps, reach)
    target = index.gather({foot: np.array([(stand.x, stand.y) for stand in wanted[foot]]) for foot in wanted}).ravel()
    C = index.gather(carried).reshape(len(target), -1)
    # In the changes, p − w − C (s − 1) and s − 1, each limit and each price is about a few neighbours in time.
    spots, count = len(target), C.shape[1]
    along = rows @ C
    along[np.abs(along) < NOTHING] = 0.0
    limits = sp.block_array([[rows, sp.csr_array(along)], [None, sp.eye_array(count)]], format="csr")
    lower = np.concatenate([least - rows @ target, np.full(count, SHORTEST - 1.0)])
    upper = np.concatenate([np.full(len(least), np.inf), np.full(count, NOTHING)])
    value = np.ones(index.count)
    while True:
        H = sp.block_diag([sp.diags_array(np.repeat(value, 2)), stiffness], format="csr") / MOVED**2
        change, scale = np.split(sparse_qp(H, limits, lower, upper, EXACT).x, [spots])
        off = np.linalg.norm(change.reshape(-1, 2), axis=1)
        far = (off > OFF) & (value > LEFT)
        if not far.any():
            break
        if value[far].max() < DEAREST:
            value[far] *= DEARER
        else:
            value[np.flatnonzero(far)[(off * (value >= DEAREST))[far].argmax()]] = LEFT
    found = index.split((target + C @ scale + change).reshape(-1, 2))
    return {
        foot: [Stand(float(x), float(y), float(yaw)) for (x, y), yaw in zip(found[foot], turned[foot], strict=True)]
        for foot in wanted
    }, np.clip(1.0 + scale, SHORTEST, 1.0)


def _reachable(
    index: "_Index", turned: Mapping[str, Array], steps: Sequence[Step], reach: Reach
) -> tuple[sp.csr_array, Array]:
    """Rows (m, 2n) over all places, and what each is to be at least (m,), for pairs of stands and for steps."""
    parts: list[tuple[int, int, Array, Array]] = []  # two stands, ways from the second one, least along each
    circle = 2.0 * np.pi * np.arange(EDGES) / EDGES
    for left, right in together(steps):
        yaws = turned["left_foot"][left], turned["right_foot"][right]
        middle = 0.5 * (yaws[0] + yaws[1])
        across = np.array([-np.sin(middle), np.cos(middle)])
        angles = middle + circle + np.pi / EDGES
        ways = np.column_stack([np.cos(angles), np.sin(angles)])
        pair = index.number("left_foot", left), index.number("right_foot", right)
        far = -reach.stride * np.cos(np.pi / EDGES) - reach.hips * ways @ across
        parts.append((*pair, across[None], np.array([separation(yaws, reach, across)])))
        parts.append((*pair, -ways, far))
    ways = np.column_stack([np.cos(circle), np.sin(circle)])
    for before, after, step in index.moves(steps):
        far = np.full(EDGES, -reach.speed * (step.land - step.lift))
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


def separation(yaws: tuple[float, float], reach: Reach, across: Array) -> float:
    """Least distance of the ankles along a direction from right to left (2,) that keeps the soles apart [m]."""
    extents = []
    for foot, yaw, way in zip(("left_foot", "right_foot"), yaws, (-across, across), strict=True):
        cosine, sine = np.cos(yaw), np.sin(yaw)
        corners = reach.soles[foot] @ np.array([[cosine, sine], [-sine, cosine]])
        extents.append(float((corners @ way).max()))
    return sum(extents) + CLEARANCE


class _Index:
    """Numbers the stands of both feet in one vector."""

    def __init__(self, stands: Mapping[str, Sequence[Stand]]):
        self._first: dict[str, int] = {}
        self.count = 0
        self._counts = {foot: len(own) for foot, own in stands.items()}
        for foot, own in self._counts.items():
            self._first[foot] = self.count
            self.count += own

    def number(self, foot: str, stand: int) -> int:
        return self._first[foot] + stand

    def moves(self, steps: Sequence[Step]) -> Iterator[tuple[int, int, Step]]:
        """The stands that each step leaves and reaches."""
        now = dict.fromkeys(self._counts, 0)
        for step in steps:
            now[step.foot] += 1
            yield now[step.foot] - 1, now[step.foot], step

    def gather(self, values: Mapping[str, Array]) -> Array:
        return np.concatenate([values[foot] for foot in self._counts])

    def split(self, values: Array) -> dict[str, Array]:
        return {foot: values[first : first + self._counts[foot]] for foot, first in self._first.items()}
