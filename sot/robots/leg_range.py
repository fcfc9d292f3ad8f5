"""How far from its hip a flat foot can stand, direction by direction, until a joint of the leg meets its range."""

from functools import lru_cache

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.robots.robot import Robot

Array = NDArray[np.float64]

DIRECTION_COUNT = 12  # directions that are tried
HIP_HEIGHTS_LEGS = (
    0.75,
    0.83,
    0.90,
)  # leg lengths, of the hip over the ankle: the last one for strides, all to shift weight
MAX_EXTENSION = 0.97  # leg lengths, from hip to ankle
RANGE_MARGIN = 0.05  # rad, kept free at either end of a joint's range, for the closed loop and for a tilted pelvis
DISTANCE_RESOLUTION_LEGS = 0.006  # leg lengths, of the distances
NEWTON_STEPS = 5  # of inverse kinematics from one place to the next
DAMPING = 1e-8
IK_TOLERANCE = 2e-3  # rad and leg lengths: a greater error of the foot is out of range
UNTURNED = np.eye(3)


@lru_cache
def directions() -> Array:
    """The unit vectors (DIRECTION_COUNT, 2) of the directions, the first one along X."""
    angles = 2.0 * np.pi * np.arange(DIRECTION_COUNT) / DIRECTION_COUNT
    return np.column_stack([np.cos(angles), np.sin(angles)])


@lru_cache
def normals() -> Array:
    """The unit vectors (2 DIRECTION_COUNT, 2) of the directions and of those half-way between, the first along X."""
    angles = np.pi * np.arange(2 * DIRECTION_COUNT) / DIRECTION_COUNT
    return np.column_stack([np.cos(angles), np.sin(angles)])


@lru_cache
def flat_foot_distances(robot: Robot, side: str) -> Array:
    """The farthest horizontal distances (heights, DIRECTION_COUNT) [m] of a flat foot's ankle from its hip.

    The pelvis is upright and heads where the foot does. Distance zero of a height is straight below the hip; where not
    even that place is in range, the distance is zero as well. Of each of HIP_HEIGHTS_LEGS, along each of `directions`.
    """
    leg = Leg(robot, side)
    found = np.zeros((len(HIP_HEIGHTS_LEGS), DIRECTION_COUNT))
    below = leg.rest
    for row in reversed(range(len(HIP_HEIGHTS_LEGS))):
        height = HIP_HEIGHTS_LEGS[row] * leg.length
        start = leg.solved(below, np.array([0.0, 0.0, -height]))
        if start is None:
            continue
        below = start
        most = np.sqrt(MAX_EXTENSION**2 - HIP_HEIGHTS_LEGS[row] ** 2) * leg.length
        for column, way in enumerate(directions()):
            found[row, column] = leg.farthest(start, height, way, most)
    return found


def support_values(distances: Array) -> Array:
    """How far a polygon with corners at distances (DIRECTION_COUNT,) goes along `normals`, (2 DIRECTION_COUNT,)."""
    corners = distances[:, None] * directions()
    return np.max(normals() @ corners.T, axis=1)


class Leg:
    """The inverse kinematics of a leg below the pelvis.

    Attributes:
        joints: its joints' numbers (6,).
        hip, ankle: their places at rest (3,) [m].
        length: from hip over knee to ankle [m].
        rest: its joints' angles at rest (6,).
    """

    def __init__(self, robot: Robot, side: str) -> None:
        self._robot, self._data, self._q = robot, robot.model.createData(), robot.rest.copy()
        self.joints = np.array(robot.groups[f"{side}_leg"], dtype=int)
        points = [robot.point(f"{side}_{point}") for point in ("hip", "knee", "ankle", "foot")]
        pin.framesForwardKinematics(robot.model, self._data, robot.rest)
        hip, knee, ankle = (self._data.oMf[point].translation.copy() for point in points[:3])
        self.hip, self.ankle, self._ankle_frame = hip, ankle, points[2]
        self._rotation = self._data.oMf[self._ankle_frame].rotation.copy()
        self.length = float(np.linalg.norm(hip - knee) + np.linalg.norm(knee - ankle))
        self._scale = np.repeat([1.0 / self.length, 1.0], 3)[:, None]
        angles = robot.rest[7:][self.joints]
        self._lower = np.minimum(robot.lower[self.joints] + RANGE_MARGIN, angles)
        self._upper = np.maximum(robot.upper[self.joints] - RANGE_MARGIN, angles)
        self.rest = angles

    def solved(self, angles: Array, place: Array) -> Array | None:
        """The joint angles that put the ankle at a place (3,) from the hip [m], the foot as at rest; None if out of
        range. They are looked for from others."""
        found = self.posture(angles, place)
        return found if found is not None and self.in_range(found) else None

    def posture(self, angles: Array, place: Array, turn: Array = UNTURNED) -> Array | None:
        """The joint angles, in range or not, that put the ankle at a place (3,) from the hip [m], the foot turned from
        how it is at rest by a rotation (3, 3), both seen from the pelvis; None if there are none. They are looked for
        from others."""
        for _ in range(NEWTON_STEPS):
            error, J = self._error(angles, place, turn)
            if np.abs(error).max() < IK_TOLERANCE:
                return angles
            angles = angles - J.T @ np.linalg.solve(J @ J.T + DAMPING * np.eye(6), error)
        return None

    def in_range(self, angles: Array) -> bool:
        """Whether joint angles are within their ranges."""
        return bool(np.all((angles >= self._lower) & (angles <= self._upper)))

    def farthest(self, angles: Array, height: float, way: Array, most: float) -> float:
        """The farthest distance along a way (2,) that is in range, at most `most`; angles: of no distance [m]."""
        reached, step = 0.0, 0.5 * most
        while reached < most and step > DISTANCE_RESOLUTION_LEGS * self.length:
            ahead = min(reached + step, most)
            found = self.solved(angles, np.array([*(ahead * way), -height]))
            if found is None:
                step *= 0.5
            else:
                reached, angles = ahead, found
        return reached

    def _error(self, angles: Array, place: Array, turn: Array) -> tuple[Array, Array]:
        """The error (6,) of the ankle's place, in leg lengths, and of the foot's rotation, and its Jacobian."""
        robot, data = self._robot, self._data
        self._q[7 + self.joints] = angles
        J = pin.computeFrameJacobian(robot.model, data, self._q, self._ankle_frame, pin.LOCAL_WORLD_ALIGNED)
        pose = pin.updateFramePlacement(robot.model, data, self._ankle_frame)
        off = (pose.translation - self.hip - place) / self.length
        turned = pin.log3(pose.rotation @ (turn @ self._rotation).T)
        return np.concatenate([off, turned]), self._scale * J[:, 6 + self.joints]
