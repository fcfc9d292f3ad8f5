"""Inverse kinematics of one arm at one moment, on the branch that points best, kept over time."""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.stats.qmc import Halton

from solvers.compiled import compiled
from sot.motion.body.kinematics import JointTree
from sot.motion.body.limits import Limits
from sot.motion.body.parts import POSTURE_WEIGHT, SEGMENT_WEIGHT
from sot.motion.body.retarget import GAUSS_NEWTON_DAMPING, MAX_STEP
from sot.motion.human.human import SEGMENTS
from sot.robots.robot import Robot

Array = NDArray[np.float64]

CANDIDATE_COUNT = 8
"""Number of postures that are followed at once, the one in use among them."""
GAUSS_NEWTON_STEPS = 3
"""Steps of each a moment."""
SAME_POSTURE = 0.15
"""Largest difference of the joints below which two candidates are one [rad]."""
MEMORY_TIME = 0.1
"""Time constant of the mean of a candidate's error [s]: a branch is not left for one moment."""
EXPECTED_STAY = 1.5
"""Time for which a branch is expected to stay as much better as it is now [s]."""
TRAVEL_ERROR = 0.7
"""Error of the arm's directions while it changes over to another branch, expected [rad]."""
TRAVEL_ACCELERATION = 25.0
"""Acceleration with which it changes over, expected [rad/s²]."""
REACH_TIME = 0.2
"""Time within whose way at full speed the posture asked for stays [s]: no joint runs ahead of the others."""
ACCEPTED_WAY_TIME = 0.3
"""Time whose way at full speed costs as much as an accepted error [s]: a straight arm does not twist for nothing."""
MIN_AGE = 6
"""Moments that a candidate is followed before it may be used: it has to have settled."""


class ArmSolver:
    """Directions of upper arm and forearm by a few Gauss-Newton steps, from several postures at once.

    An arm that is fitted moment by moment from one posture stays on a wrong branch for good. Here others, spread over
    the joint range, follow the same directions beside it, and the arm changes over where that pays: where the error
    saved within `EXPECTED_STAY` is more than that of the way across.

    Args:
        robot: whose arm.
        side: "left" or "right".
        limits: of the coordinates y.
    """

    def __init__(self, robot: Robot, side: str, limits: Limits) -> None:
        model, tree = robot.model, JointTree(robot)
        wrist = model.frames[robot.point(f"{side}_wrist")].parentJoint
        own = {model.getJointId(robot.joints[j]) for j in robot.groups[f"{side}_arm"]}
        supports = list(model.supports[wrist])
        chain = supports[next((k for k, joint in enumerate(supports) if joint in own), len(supports)) :]
        self.columns = np.array([model.joints[j].idx_v for j in chain], dtype=int)
        if not chain:
            return
        self._base = model.parents[chain[0]]
        self._fixed = np.array([tree.fixed[j] for j in chain])
        self._shift = np.array([model.jointPlacements[j].translation for j in chain])
        self._axis = np.array([tree.axis[j] for j in chain])
        frames = [model.frames[robot.point(f"{side}_{point}")] for point in ("shoulder", "elbow", "wrist")]
        data = model.createData()
        pin.forwardKinematics(model, data, robot.rest)
        self._joint_of_point = np.array([_last_in_chain(chain, frame.parentJoint) for frame in frames])
        self._offsets = np.array([frame.placement.translation for frame in frames])
        for k, frame in enumerate(frames):
            if self._joint_of_point[k] < 0:  # before the chain: as the base sees it
                world = data.oMi[frame.parentJoint].act(frame.placement.translation)
                self._offsets[k] = data.oMi[self._base].actInv(world)
        self._segments = [f"{side}_upper_arm", f"{side}_forearm"]
        self._rest = robot.rest[1 + self.columns]
        self._lower, self._upper = limits.lower[self.columns], limits.upper[self.columns]
        self._velocity = limits.velocity[self.columns]
        spread = Halton(len(chain), scramble=False).random(64)[1:]
        self._starts = self._lower + spread * (self._upper - self._lower)
        self._next_start = 0
        self._postures = np.tile(self._rest, (CANDIDATE_COUNT, 1))
        self._errors, self._ages = np.zeros(CANDIDATE_COUNT), np.zeros(CANDIDATE_COUNT, dtype=int)
        self._in_use, self._crossing = 0, False
        self._free_weight = np.full(len(chain), POSTURE_WEIGHT**2)
        self._renew(np.arange(1, CANDIDATE_COUNT))
        assert set(self._segments) <= set(SEGMENTS)

    def solve(self, data: pin.Data, directions: dict[str, Array], elapsed: float, now: Array) -> Array:
        """The arm's coordinates (s,) that point along directions, `elapsed` [s] after the last.

        Joints here are slow beside a human's. What is asked for is the best that all of them together can do within
        `REACH_TIME` from where they are.

        data: Pinocchio's, with the joints of the trunk placed.
        now: (s,) where the arm is.
        """
        base = data.oMi[self._base]
        wanted = np.array([directions[segment] for segment in self._segments])
        if not self._crossing:
            self._postures[self._in_use] = now
        costs = self._improve(self._postures, base, wanted, self._lower, self._upper, self._rest, self._free_weight)
        share = 1.0 - np.exp(-elapsed / MEMORY_TIME)
        fresh = self._ages == 0
        self._errors = np.where(fresh, costs, self._errors + share * (costs - self._errors))
        self._ages += 1
        self._choose()
        self._renew_doubles()
        way = REACH_TIME * self._velocity
        lower, upper = np.maximum(self._lower, now - way), np.minimum(self._upper, now + way)
        chosen = self._postures[self._in_use]
        if self._crossing:
            self._crossing = bool((np.abs(chosen - now) > way).any())
            return np.clip(chosen, lower, upper)
        asked = np.clip(now, lower, upper)[None]
        weight = self._free_weight + 1.0 / (ACCEPTED_WAY_TIME * self._velocity) ** 2
        centre = now + self._free_weight / weight * (self._rest - now)
        self._improve(asked, base, wanted, lower, upper, centre, weight)
        return asked[0]

    def _improve(
        self, postures: Array, base: pin.SE3, wanted: Array, lower: Array, upper: Array, centre: Array, weight: Array
    ) -> Array:
        """`_solve_candidates` for this arm on a base."""
        return _solve_candidates(
            postures,
            base.rotation,
            base.translation,
            self._fixed,
            self._shift,
            self._axis,
            self._joint_of_point,
            self._offsets,
            wanted,
            lower,
            upper,
            centre,
            weight,
        )

    def _choose(self) -> None:
        """Change over to the candidate that pays most, if one does."""
        way = np.abs(self._postures - self._postures[self._in_use])
        time = np.maximum(way / self._velocity, 2.0 * np.sqrt(way / TRAVEL_ACCELERATION)).max(axis=1)
        price = (SEGMENT_WEIGHT * TRAVEL_ERROR) ** 2 * time
        gain = EXPECTED_STAY * (self._errors[self._in_use] - self._errors) - price
        gain[(self._ages < MIN_AGE) | (np.arange(CANDIDATE_COUNT) == self._in_use)] = -1.0
        best = int(gain.argmax())
        if gain[best] > 0.0:
            self._in_use, self._crossing = best, True

    def _renew_doubles(self) -> None:
        """Start candidates anew that have become one with another."""
        apart = np.abs(self._postures[:, None] - self._postures[None]).max(axis=2) < SAME_POSTURE
        older = self._ages[:, None] < self._ages[None]
        older |= (self._ages[:, None] == self._ages[None]) & np.tri(CANDIDATE_COUNT, k=-1, dtype=bool)
        doubles = (apart & older).any(axis=1) | apart[:, self._in_use]
        doubles[self._in_use] = False
        self._renew(np.flatnonzero(doubles & (self._ages >= MIN_AGE)))

    def _renew(self, which: NDArray[np.int_]) -> None:
        for k in which:
            self._postures[k] = self._starts[self._next_start % len(self._starts)]
            self._ages[k] = 0
            self._next_start += 1


def _last_in_chain(chain: list[int], joint: int) -> int:
    return chain.index(joint) if joint in chain else -1


@compiled
def _solve_candidates(
    postures: Array,
    base_rotation: Array,
    base_position: Array,
    fixed: Array,
    shift: Array,
    axis: Array,
    joint_of_point: Array,
    offsets: Array,
    wanted: Array,
    lower: Array,
    upper: Array,
    centre: Array,
    weight: Array,
) -> Array:
    """Improve postures (m, k) in place, and return the squared errors of their directions (m,) in accepted errors.

    centre, weight: (k,) a posture that they are drawn to, and how much.
    """
    count, size = postures.shape
    costs = np.empty(count)
    points, jacobians = np.empty((3, 3)), np.empty((3, 3, size))
    for c in range(count):
        x = postures[c]
        for step in range(GAUSS_NEWTON_STEPS + 1):
            _points(x, base_rotation, base_position, fixed, shift, axis, joint_of_point, offsets, points, jacobians)
            H, g = np.zeros((size, size)), np.zeros(size)
            for i in range(size):
                H[i, i] = weight[i] + GAUSS_NEWTON_DAMPING
                g[i] = weight[i] * (x[i] - centre[i])
            cost = 0.0
            for s in range(2):
                length = 0.0
                for a in range(3):
                    length += (points[s + 1, a] - points[s, a]) ** 2
                length = np.sqrt(length)
                J, e, unit = np.empty((3, size)), np.empty(3), np.empty(3)
                for a in range(3):
                    unit[a] = (points[s + 1, a] - points[s, a]) / length
                    e[a] = unit[a] - wanted[s, a]
                    cost += (SEGMENT_WEIGHT * e[a]) ** 2
                for i in range(size):
                    along = 0.0
                    for a in range(3):
                        J[a, i] = (jacobians[s + 1, a, i] - jacobians[s, a, i]) / length
                        along += unit[a] * J[a, i]
                    for a in range(3):
                        J[a, i] -= along * unit[a]
                for i in range(size):
                    for a in range(3):
                        g[i] += SEGMENT_WEIGHT**2 * J[a, i] * e[a]
                    for j in range(size):
                        for a in range(3):
                            H[i, j] += SEGMENT_WEIGHT**2 * J[a, i] * J[a, j]
            costs[c] = cost
            if step < GAUSS_NEWTON_STEPS:
                _bounded_move(x, H, g, lower, upper)
    return costs


@compiled
def _bounded_move(x: Array, H: Array, g: Array, lower: Array, upper: Array) -> None:
    """Move x by the step that minimises ½ sᵀH s + gᵀs within its range: primal-dual active sets, as `bounded_step`."""
    size = len(x)
    low, high = np.zeros(size, dtype=np.bool_), np.zeros(size, dtype=np.bool_)
    step = np.zeros(size)
    for _ in range(3 * size):
        A, b = np.eye(size), np.zeros(size)
        for i in range(size):
            if low[i] or high[i]:
                b[i] = (lower[i] if low[i] else upper[i]) - x[i]
        for i in range(size):
            if low[i] or high[i]:
                continue
            right = -g[i]
            for j in range(size):
                if low[j] or high[j]:
                    right -= H[i, j] * b[j]
                else:
                    A[i, j] = H[i, j]
            step[i] = right
        for i in range(size):
            if not (low[i] or high[i]):
                b[i] = step[i]
        step[:] = np.linalg.solve(A, b)
        changed = False
        for i in range(size):
            pull = -g[i]
            for j in range(size):
                pull -= H[i, j] * step[j]
            below = pull < 0.0 if low[i] else (not high[i] and x[i] + step[i] < lower[i])
            above = pull > 0.0 if high[i] else (not low[i] and x[i] + step[i] > upper[i])
            changed = changed or below != low[i] or above != high[i]
            low[i], high[i] = below, above
        if not changed:
            break
    most = 0.0
    for i in range(size):
        most = max(most, abs(step[i]))
    scale = min(1.0, MAX_STEP / max(most, MAX_STEP))
    for i in range(size):
        x[i] = min(max(x[i] + scale * step[i], lower[i]), upper[i])


@compiled
def _points(
    x: Array,
    base_rotation: Array,
    base_position: Array,
    fixed: Array,
    shift: Array,
    axis: Array,
    joint_of_point: Array,
    offsets: Array,
    points: Array,
    jacobians: Array,
) -> None:
    """Positions (3, 3) of shoulder, elbow and wrist and their Jacobians (3, 3, k) at joint angles (k,)."""
    size = len(x)
    rotation, position = base_rotation.copy(), base_position.copy()
    axes, origins = np.empty((size, 3)), np.empty((size, 3))
    jacobians[:] = 0.0
    for p in range(3):
        if joint_of_point[p] < 0:
            for a in range(3):
                points[p, a] = position[a]
                for b in range(3):
                    points[p, a] += rotation[a, b] * offsets[p, b]
    for k in range(size):
        turned, moved = np.empty((3, 3)), np.empty(3)
        s, v, u = np.sin(x[k]), 1.0 - np.cos(x[k]), axis[k]
        own = np.array(
            (
                (1.0 - v * (u[1] ** 2 + u[2] ** 2), v * u[0] * u[1] - s * u[2], v * u[0] * u[2] + s * u[1]),
                (v * u[0] * u[1] + s * u[2], 1.0 - v * (u[0] ** 2 + u[2] ** 2), v * u[1] * u[2] - s * u[0]),
                (v * u[0] * u[2] - s * u[1], v * u[1] * u[2] + s * u[0], 1.0 - v * (u[0] ** 2 + u[1] ** 2)),
            )
        )
        for a in range(3):
            moved[a] = position[a]
            for b in range(3):
                moved[a] += rotation[a, b] * shift[k, b]
        half = np.empty((3, 3))
        for a in range(3):
            for b in range(3):
                half[a, b] = 0.0
                for c in range(3):
                    half[a, b] += rotation[a, c] * fixed[k, c, b]
        for a in range(3):
            for b in range(3):
                turned[a, b] = 0.0
                for c in range(3):
                    turned[a, b] += half[a, c] * own[c, b]
        rotation, position = turned, moved
        for a in range(3):
            origins[k, a] = position[a]
            axes[k, a] = 0.0
            for b in range(3):
                axes[k, a] += rotation[a, b] * u[b]
        for p in range(3):
            if joint_of_point[p] == k:
                for a in range(3):
                    points[p, a] = position[a]
                    for b in range(3):
                        points[p, a] += rotation[a, b] * offsets[p, b]
    for p in range(3):
        for k in range(joint_of_point[p] + 1):
            d = points[p] - origins[k]
            jacobians[p, 0, k] = axes[k, 1] * d[2] - axes[k, 2] * d[1]
            jacobians[p, 1, k] = axes[k, 2] * d[0] - axes[k, 0] * d[2]
            jacobians[p, 2, k] = axes[k, 0] * d[1] - axes[k, 1] * d[0]
