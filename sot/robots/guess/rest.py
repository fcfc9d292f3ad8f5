"""The posture that a robot starts from: bent knees over flat soles, arms hanging down, the trunk upright."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.feet import FLAT_SHARE, MAX_FEET_HEIGHT_DIFFERENCE, sole
from sot.robots.guess.groups import Body
from sot.robots.guess.heading import turned
from sot.robots.guess.points import Point, Points
from sot.robots.guess.posed_model import PosedModel

Array = NDArray[np.float64]

EXTENSION = 0.94  # distance of hip and ankle as a share of thigh and shank: knees bent by 0.7 rad
EXTENSION_MAX = 0.97  # of a key frame: a straighter leg cannot push
START_KNEE_ANGLE = 0.7  # rad, where the search for it starts
FOREARM_FORWARD_ANGLE = 0.5  # rad, of the forearms
UPPER_ARM_OUTWARD_ANGLES = np.deg2rad(
    (8.0, 12.0, 16.0, 20.0, 25.0, 30.0, 35.0)
)  # of the upper arms: the first that keeps them clear
CLEARANCE_SEARCH_DISTANCE = 0.1  # m, beyond which distances do not matter
MIN_ARM_CLEARANCE = 0.03  # m, of forearms and hands from the rest of the body
MIN_UPPER_ARM_DOWNWARD_PART = 0.7  # least downward part of an upper arm's direction
RANGE_MARGIN = 0.05  # rad, that joints keep from their ends
SIDES, LEG = ("left", "right"), ("hip", "knee", "ankle")
MAX_LEAN_LEGS = 0.1  # share of the leg: the ankles are no farther before or behind the hips
MAX_ARM_SEARCH_STARTS = 24  # of an arm's search, at most
ARM_RESIDUAL_TOLERANCE = 0.1  # residual with which the search is over
STEPS, DAMPING = 60, 1e-6
POSTURE_WEIGHT = 0.05  # weight of a joint's own angle against the limb's direction
POSTURE_TOLERANCE = 1e-3  # residual of a posture that is reached


@dataclass(frozen=True)
class Rest:
    """A rest configuration.

    Attributes:
        qpos: (nq,), the base turned to look along x.
        key: name of the key frame that it is; empty if it is none.
        flat: whether both soles lie flat.
    """

    qpos: Array
    key: str
    flat: bool


def stands_flat(posed: PosedModel, feet: Sequence[int], height: float) -> bool:
    """Whether both soles lie flat at one height in the configuration in which the tree is."""
    soles = [sole(posed, foot) for foot in feet]
    level = abs(soles[0][0][0, 2] - soles[1][0][0, 2]) < MAX_FEET_HEIGHT_DIFFERENCE * height
    return level and all(share > FLAT_SHARE for _, share in soles)


def find_rest(posed: PosedModel, body: Body, points: Points, start: Array) -> tuple[Rest, list[Evidence]]:
    """A rest posture.

    Args:
        posed: the model.
        body, points: what was found of it, at `start`.
        start: configuration (nq,) in which the soles are flat and the toes ahead.
    """
    posed.place(start)
    named = _key_frame(posed, body, points, start)
    if named is not None:
        return named
    posture = _Posture(posed, body, points, start)
    posture.bend_legs()
    arms = posture.hang_arms()
    legs, knee = posture.bend_legs()  # under the centre of mass with the arms where they are now
    posed.place(posture.qpos)
    flat = stands_flat(posed, list(body.feet.values()), body.height)
    said = [
        Evidence(
            "rest, legs",
            f"knees bent by {knee:.2f} rad, ankles under the centre of mass",
            "solved for soles as flat as in the model" if flat else f"the soles do not come flat: {legs:.3f} off",
            Sureness.SURE if flat and legs < POSTURE_TOLERANCE else Sureness.UNSURE,
        ),
        arms,
    ]
    return Rest(posture.qpos.copy(), "", flat), said


def _key_frame(posed: PosedModel, body: Body, points: Points, start: Array) -> tuple[Rest, list[Evidence]] | None:
    """A key frame with flat soles, bent knees and hanging arms, if the model has one."""
    for k in range(posed.model.nkey):
        key = posed.model.key(k)
        qpos = turned(posed, _yaw(posed, start) - _yaw(posed, posed.model.qpos0), np.array(key.qpos))
        places = {name: _carried(posed, point, start) for name, point in points.places.items()}
        posed.place(qpos)
        bent = max(_extension(*(places[f"{side}_{name}"] for name in LEG)) for side in SIDES)
        hanging = all(
            _direction(places[f"{side}_shoulder"](), places[f"{side}_elbow"]())[2] < -MIN_UPPER_ARM_DOWNWARD_PART
            for side in SIDES
        )
        if stands_flat(posed, list(body.feet.values()), body.height) and bent < EXTENSION_MAX and hanging:
            found = Evidence(
                "rest", f"key frame {key.name}", "its soles are flat, its knees bent, its arms hang", Sureness.SURE
            )
            return Rest(qpos, str(key.name), True), [found]
    posed.place(start)
    return None


def _yaw(posed: PosedModel, qpos: Array) -> float:
    first = int(posed.model.jnt_qposadr[posed.model.body_jntadr[posed.base]])
    w, x, y, z = qpos[first + 3 : first + 7]
    return float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))


def _carried(posed: PosedModel, point: Point, start: Array) -> Callable[[], Array]:
    """Where a point is in the configuration in which the tree is, asked anew each time."""
    posed.place(start)
    turn, at = posed.data.xmat[point.link].reshape(3, 3).copy(), posed.data.xpos[point.link].copy()
    offset = turn.T @ (point.at - at)

    def place() -> Array:
        return posed.data.xpos[point.link] + posed.data.xmat[point.link].reshape(3, 3) @ offset

    return place


def _extension(hip: Callable[[], Array], knee: Callable[[], Array], ankle: Callable[[], Array]) -> float:
    """How far a leg is stretched, 1 at most."""
    reach, thigh, shank = ankle() - hip(), knee() - hip(), ankle() - knee()
    return float(np.linalg.norm(reach) / (np.linalg.norm(thigh) + np.linalg.norm(shank)))


def _direction(near: Array, far: Array) -> Array:
    return (far - near) / max(float(np.linalg.norm(far - near)), 1e-12)


class _Posture:
    """A configuration that is solved limb by limb."""

    def __init__(self, posed: PosedModel, body: Body, points: Points, start: Array) -> None:
        self._posed, self._body, self._points, self._start = posed, body, points, start
        self._place = {name: _carried(posed, point, start) for name, point in points.places.items()}
        self._base = start.copy()
        for joint in posed.joints:
            low, high = posed.range(joint)
            k = posed.model.jnt_qposadr[joint]
            room = min(RANGE_MARGIN, 0.25 * (high - low))
            self._base[k] = (
                np.clip(start[k], low + room, high - room) if start[k] <= low or start[k] >= high else start[k]
            )
        self.qpos = self._base.copy()

    def _columns(self, joints: Sequence[int]) -> NDArray[np.int_]:
        return np.array([self._posed.model.jnt_qposadr[j] for j in joints], dtype=int)

    def _solve(self, joints: Sequence[int], residual: Callable[[], Array], first: Array) -> tuple[Array, float]:
        """Angles (n,) of joints within their ranges that make a residual least, and its norm: Gauss-Newton with a
        numerical Jacobian."""
        posed, columns = self._posed, self._columns(joints)
        ranges = np.array([posed.range(j) for j in joints])
        room = np.minimum(RANGE_MARGIN, 0.25 * (ranges[:, 1] - ranges[:, 0]))
        low, high = ranges[:, 0] + room, ranges[:, 1] - room

        def at(angles: Array) -> Array:
            self.qpos[columns] = angles
            posed.place(self.qpos)
            return residual()

        angles = np.clip(first, low, high)
        now, damping = at(angles), DAMPING
        for _ in range(STEPS):
            J = np.column_stack([(at(angles + step) - now) / 1e-6 for step in 1e-6 * np.eye(len(angles))])
            free = np.ones(len(angles), dtype=bool)
            step = np.zeros(len(angles))
            for _ in range(len(angles)):  # joints that would leave their range stay at its end
                H = J[:, free].T @ J[:, free] + damping * np.eye(int(free.sum()))
                step[:] = 0.0
                step[free] = -np.linalg.solve(H, J[:, free].T @ now)
                out = free & ((angles + step < low) & (angles <= low) | (angles + step > high) & (angles >= high))
                if not out.any() or out.sum() == free.sum():
                    break
                free &= ~out
            tried = np.clip(angles + step, low, high)
            then = at(tried)
            if then @ then < now @ now:
                done = np.abs(tried - angles).max() < 1e-9
                angles, now, damping = tried, then, max(0.1 * damping, 1e-9)
                if done:
                    break
            else:
                damping *= 10.0
                if damping > 1e3:
                    break
        return angles, float(np.linalg.norm(at(angles)))

    def bend_legs(self) -> tuple[float, float]:
        """Bend both knees; the residual that is left, and the knees' angle [rad]."""
        posed, worst, bent = self._posed, 0.0, 0.0
        posed.place(self._start)
        feet = {s: posed.data.xmat[f].reshape(3, 3).copy() for s, f in self._body.feet.items()}
        across = {s: float(self._place[f"{s}_ankle"]()[1]) for s in feet}
        ahead = {}
        for side, foot in self._body.feet.items():
            corners, _ = sole(posed, foot)
            ahead[side] = float(corners[:, 0].mean() - self._place[f"{side}_ankle"]()[0])
        for _ in range(3):  # the centre of mass moves a little with the legs
            posed.place(self.qpos)
            com = float(posed.data.subtree_com[posed.base][0])
            for side in feet:
                off, bent = self._bend(side, feet[side], across[side], com - ahead[side])
                worst = max(off, 0.0) if side == "left" else max(worst, off)
        return worst, bent

    def _bend(self, side: str, flat: Array, across: float, under: float) -> tuple[float, float]:
        posed, joints = self._posed, list(self._body.groups[f"{side}_leg"])
        knee, foot = self._points.bends[f"{side}_leg"], self._body.feet[side]
        hip, at_knee, ankle = (self._place[f"{side}_{name}"] for name in ("hip", "knee", "ankle"))
        posed.place(self._start)
        length = float(np.linalg.norm(ankle() - at_knee()) + np.linalg.norm(at_knee() - hip()))
        at, axis = posed.axis(knee)
        way = -float(np.sign(np.cross(axis, ankle() - at)[0])) or 1.0
        column = int(posed.model.jnt_qposadr[knee])

        def residual() -> Array:
            turn = posed.data.xmat[foot].reshape(3, 3) @ flat.T
            place = float(np.clip(under, hip()[0] - MAX_LEAN_LEGS * length, hip()[0] + MAX_LEAN_LEGS * length))
            off = np.array([ankle()[0] - place, ankle()[1] - across]) / length
            stretched = _extension(hip, at_knee, ankle) - EXTENSION
            return np.concatenate([Rotation.from_matrix(turn).as_rotvec(), off, [stretched]])

        first = self._base[self._columns(joints)].copy()
        first[joints.index(knee)] += way * START_KNEE_ANGLE
        angles, off = self._solve(joints, residual, first)
        self.qpos[self._columns(joints)] = angles
        return off, abs(float(self.qpos[column]))

    def hang_arms(self) -> Evidence:
        """Let both arms hang, as far outward as keeps them clear of the body."""
        for outward in UPPER_ARM_OUTWARD_ANGLES:
            left, off = self._hang("left", float(outward))
            mirrored = self._mirrored(left)
            _, other = self._hang("right", float(outward), mirrored)
            apart = self._clearance()
            if apart > MIN_ARM_CLEARANCE:
                break
        degrees = np.rad2deg(outward)
        found = f"upper arms down, {degrees:.0f}° outward, forearms {np.rad2deg(FOREARM_FORWARD_ANGLE):.0f}° forward"
        worst = max(off, other)
        why = (
            f"solved for directions, {np.rad2deg(worst):.0f}° off at most; hands {1e3 * apart:.0f} mm clear of the body"
        )
        sure = worst < 0.2 and apart > MIN_ARM_CLEARANCE
        return Evidence("rest, arms", found, why, Sureness.SURE if sure else Sureness.UNSURE)

    def _hang(self, side: str, outward: float, first: Array | None = None) -> tuple[Array, float]:
        posed, arm = self._posed, list(self._body.groups[f"{side}_arm"])
        joints = arm[: 1 + arm.index(self._points.bends[f"{side}_arm"])]
        shoulder, elbow, wrist = (self._place[f"{side}_{name}"] for name in ("shoulder", "elbow", "wrist"))
        across = np.sin(outward) * (1.0 if side == "left" else -1.0)
        upper = np.array([0.0, across, -np.cos(outward)])
        lower = np.array([np.sin(FOREARM_FORWARD_ANGLE), 0.0, -np.cos(FOREARM_FORWARD_ANGLE)])
        columns = self._columns(joints)
        own = self._base[columns]

        def directions() -> Array:
            near = _direction(shoulder(), elbow()) - upper
            far = _direction(elbow(), wrist()) - lower
            return np.concatenate([near, far])

        def residual() -> Array:
            return np.concatenate([directions(), POSTURE_WEIGHT * (self.qpos[columns] - own)])

        if first is not None:
            angles, _ = self._solve(joints, residual, first)
        else:
            random = np.random.default_rng(0)
            ranges = np.clip([posed.range(j) for j in joints], -np.pi, np.pi)
            starts = [own, *(random.uniform(ranges[:, 0], ranges[:, 1]) for _ in range(MAX_ARM_SEARCH_STARTS))]
            found: list[tuple[float, Array]] = []
            for start in starts:
                angles, off = self._solve(joints, residual, start)
                found.append((off, angles))
                if off < ARM_RESIDUAL_TOLERANCE:
                    break
            angles = min(found, key=lambda each: each[0])[1]
        self.qpos[columns] = angles
        posed.place(self.qpos)
        left_over = directions()
        return angles, float(max(np.linalg.norm(left_over[:3]), np.linalg.norm(left_over[3:])))

    def _mirrored(self, left: Array) -> Array | None:
        """The left arm's angles as the right arm's, if their joints mirror each other."""
        posed = self._posed
        posed.place(self._base)
        if len(self._body.groups["left_arm"]) != len(self._body.groups["right_arm"]):
            return None
        pairs = list(zip(self._body.groups["left_arm"], self._body.groups["right_arm"], strict=True))[: len(left)]
        signs = [float(np.dot(posed.axis(a)[1] * (-1, 1, -1), posed.axis(b)[1])) for a, b in pairs]
        return np.sign(signs) * left if min(abs(s) for s in signs) > 0.9 else None

    def _clearance(self) -> float:
        """Distance of forearms and hands from trunk, pelvis and legs [m]."""
        posed = self._posed
        posed.place(self.qpos)
        arms = {s: posed.subtree(posed.link_of(self._body.groups[f"{s}_arm"][0])) for s in ("left", "right")}
        body = [link for link in posed.links if link not in {*arms["left"], *arms["right"]}]
        ends = [posed.subtree(posed.link_of(self._points.bends[f"{side}_arm"])) for side in SIDES]
        return min(posed.distance(end, body, CLEARANCE_SEARCH_DISTANCE) for end in ends)


def angles_by_name(posed: PosedModel, rest: Rest, joints: Sequence[int]) -> Mapping[str, float]:
    """Angles of joints that are not zero [rad], rounded."""
    values = {posed.joint_name(j): round(float(rest.qpos[posed.model.jnt_qposadr[j]]), 4) for j in joints}
    return {name: value for name, value in values.items() if abs(value) > 1e-3}
